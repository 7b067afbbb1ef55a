#include "io/exodus_file.hpp"
