#include "io/partition.hpp"
