#include "io/connected_components.hpp"
