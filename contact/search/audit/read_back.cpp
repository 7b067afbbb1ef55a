#include "contact/search/audit/read_back.hpp"

#include "contact/base/to_device.hpp"

namespace brickwall::contact {

std::vector<IdPair> candidateIds(const exec_space& space, const SweptBoxes& surface,
                                 const GhostFaces& ghosts, const CandidatePairs& pairs) {
  space.fence();
  const auto row_nodes = toHost(pairs.row_nodes), row_begin = toHost(pairs.row_begin);
  const auto faces = toHost(pairs.faces);
  const auto block_begin = toHost(pairs.block_begin);
  const auto node_ids = toHost(surface.node_ids), face_ids = toHost(surface.face_ids);
  const auto ghost_ids = toHost(ghosts.face_ids);
  std::vector<IdPair> ids;
  ids.reserve(static_cast<std::size_t>(pairs.count));
  for (int row = 0; row < pairs.num_rows; ++row) {
    const std::int64_t block = row / CandidatePairs::rows_per_block;
    for (int i = row_begin(row + block); i < row_begin(row + block + 1); ++i) {
      const int face = faces(block_begin(block) + i);
      ids.push_back({node_ids(row_nodes(row)), face < surface.num_faces
                                                   ? face_ids(face)
                                                   : ghost_ids(face - surface.num_faces)});
    }
  }
  return ids;
}

} // namespace brickwall::contact
