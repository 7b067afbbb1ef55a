// Rows of numbers that belong to entities by global id, wherever they are: how values find the
// ranks of another partition.
#pragma once

#include "contact/base/backend.hpp"

#include <mpi.h>

#include <cstdint>
#include <vector>

namespace brickwall::io {

// Row i, of `width` words, belongs to ids[i]; an id may have several rows. Words are integers, or
// the bits of doubles.
struct RowsById {
  std::vector<global_id> ids;
  int width = 1;
  std::vector<std::int64_t> words; // [row][width]

  const std::int64_t* row(std::size_t i) const {
    return words.data() + i * static_cast<std::size_t>(width);
  }
};

// The rows of the ids `wanted` among the rows that all ranks hold, in the order of `wanted`; those
// of one id follow each other. An id that no rank holds has none. `held.width` is the same on all
// ranks. Collective. No rank gets more than its share of the ids and the rows that it wants.
RowsById fetchRows(MPI_Comm comm, const RowsById& held, const std::vector<global_id>& wanted);

} // namespace brickwall::io
