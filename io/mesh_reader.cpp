#include "io/mesh_reader.hpp"
