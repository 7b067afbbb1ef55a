#include "verification/performance/benchmarks/own_search.hpp"

#include "contact/base/mpi.hpp"
#include "contact/base/to_device.hpp"

#include <algorithm>
#include <unordered_set>

namespace brickwall::peers {
namespace {

// Appends (node, face) for each corner of the face that is_owned accepts; the repeated corner of a
// triangle counts once.
template <class IsOwned>
void addCorners(const global_id (&corners)[4], global_id face, const IsOwned& is_owned,
                std::vector<IdPair>& pairs) {
  for (int c = 0; c < 4; ++c)
    if (std::find(corners, corners + c, corners[c]) == corners + c && is_owned(corners[c]))
      pairs.emplace_back(corners[c], face);
}

} // namespace

void OwnSearch::search(const exec_space& space, const contact::Surface& surface) {
  _global.findGhosts(space, surface);
  _local.findCandidatePairs(space, surface);
  space.fence();
}

std::vector<IdPair> OwnSearch::pairsWithOwnFaces(const contact::Surface& surface) const {
  const auto& ghosts = _global.ghosts();
  const auto node_ids = toHost(surface.node_ids), face_ids = toHost(surface.face_ids);
  const auto owned = toHost(surface.node_is_owned);
  const auto face_nodes = toHost(surface.face_to_nodes);
  const auto ghost_ids = toHost(ghosts.face_ids);
  const auto ghost_corners = toHost(ghosts.corner_ids);

  const contact::CandidatePairs& rows = candidates();
  const auto row_nodes = toHost(rows.row_nodes), row_begin = toHost(rows.row_begin);
  const auto block_begin = toHost(rows.block_begin);
  const auto faces = toHost(rows.faces);
  std::vector<IdPair> pairs;
  pairs.reserve(static_cast<std::size_t>(rows.count + 4 * std::int64_t(surface.num_faces)));
  constexpr int per_block = contact::CandidatePairs::rows_per_block;
  for (int row = 0; row < rows.num_rows; ++row) {
    const int block = row / per_block;
    const std::int64_t first = block_begin(block);
    for (std::int64_t i = first + row_begin(row + block); i < first + row_begin(row + block + 1);
         ++i)
      pairs.emplace_back(node_ids(row_nodes(row)), faces(i) < surface.num_faces
                                                       ? face_ids(faces(i))
                                                       : ghost_ids(faces(i) - surface.num_faces));
  }

  std::unordered_set<global_id> owned_ids; // read for ghosts only
  if (ghosts.count > 0)
    for (int node = 0; node < surface.num_nodes; ++node)
      if (owned(node))
        owned_ids.insert(node_ids(node));
  for (int face = 0; face < surface.num_faces; ++face) {
    global_id corners[4];
    for (int c = 0; c < 4; ++c)
      corners[c] = face_nodes(face, c);
    const std::size_t first = pairs.size();
    addCorners(
        corners, face_ids(face), [&](const global_id node) { return owned(node) != 0; }, pairs);
    for (std::size_t i = first; i < pairs.size(); ++i)
      pairs[i].first = node_ids(pairs[i].first);
  }
  for (int ghost = 0; ghost < ghosts.count; ++ghost) {
    global_id corners[4];
    for (int c = 0; c < 4; ++c)
      corners[c] = ghost_corners(ghost, c);
    addCorners(
        corners, ghost_ids(ghost), [&](const global_id id) { return owned_ids.count(id) > 0; },
        pairs);
  }
  return pairs;
}

PairDifference comparePairs(MPI_Comm comm, std::vector<IdPair>& expected,
                            std::vector<IdPair>& found) {
  std::sort(expected.begin(), expected.end());
  std::sort(found.begin(), found.end());
  std::int64_t counts[3] = {0, 0, 0}; // missing, extra, repeated
  auto want = expected.begin();
  for (auto it = found.begin(); it != found.end(); ++it) {
    if (it != found.begin() && *it == *(it - 1)) {
      ++counts[2];
      continue;
    }
    for (; want != expected.end() && *want < *it; ++want)
      ++counts[0];
    if (want != expected.end() && *want == *it)
      ++want;
    else
      ++counts[1];
  }
  counts[0] += expected.end() - want;
  allReduce(comm, counts, 3, MPI_SUM);
  return {counts[0], counts[1], counts[2]};
}

} // namespace brickwall::peers
