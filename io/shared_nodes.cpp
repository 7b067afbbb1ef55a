#include "io/shared_nodes.hpp"
