#include "io/mesh_writer.hpp"
