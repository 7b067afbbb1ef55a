#include "io/wall_layout.hpp"
