#include "io/wall_generator.hpp"
