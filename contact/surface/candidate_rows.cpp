#include "contact/surface/candidate_rows.hpp"

namespace brickwall::contact {

void layOutRowsByNode(const exec_space& space, int num_nodes,
                      const View<const std::int64_t*>& offsets, CandidatePairs& pairs) {
  constexpr int width = CandidatePairs::rows_per_block;
  const std::int64_t num_blocks = dividedUp<std::int64_t>(num_nodes, width);
  growTo(space, pairs.row_nodes, num_nodes);
  growTo(space, pairs.block_begin, num_blocks);
  growTo(space, pairs.row_begin, num_blocks * (width + 1));
  const auto row_nodes = pairs.row_nodes, row_begin = pairs.row_begin;
  const auto block_begin = pairs.block_begin;
  Kokkos::parallel_for(
      "contact::layOutRowsByNode", rangePolicy(space, num_blocks),
      KOKKOS_LAMBDA(const std::int64_t block) {
        const std::int64_t first = offsets(block * width);
        block_begin(block) = first;
        for (int i = 0; i <= width; ++i) {
          const std::int64_t row = minOf<std::int64_t>(block * width + i, num_nodes);
          row_begin(block * (width + 1) + i) = static_cast<int>(offsets(row) - first);
          if (i < width && row < num_nodes)
            row_nodes(row) = static_cast<int>(row);
        }
      });
  std::int64_t count = 0;
  if (num_nodes > 0)
    Kokkos::deep_copy(space, count, Kokkos::subview(offsets, static_cast<std::size_t>(num_nodes)));
  space.fence();
  pairs.count = count;
  pairs.num_rows = num_nodes;
}

} // namespace brickwall::contact
