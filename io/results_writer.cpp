#include "io/results_writer.hpp"
