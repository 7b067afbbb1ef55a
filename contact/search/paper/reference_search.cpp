#include "contact/search/paper/reference_search.hpp"

#include "contact/base/to_device.hpp"
#include "contact/surface/candidate_rules.hpp"

namespace brickwall::contact {
namespace {} // namespace

void referenceCandidates(const exec_space& space, const View<const Box*>& boxes, int num_rows,
                         const std::vector<Box>& rank_boxes, PartnerLists& lists) {
  const auto host_boxes = toHost(boxes);
  std::vector<int> rows;
  for (std::size_t p = 0; p < rank_boxes.size(); ++p) {
    for (int row = 0; row < num_rows; ++row)
      if (host_boxes(row).overlaps(rank_boxes[p]))
        rows.push_back(row);
    lists.offsets[p + 1] = static_cast<std::int64_t>(rows.size());
  }
  copyToDevice(space, rows, lists.rows);
}

std::int64_t referenceFaceGhosts(const exec_space& space, const View<const Box*>& face_boxes,
                                 const PartnerLists& faces_to_test, const RemoteNodeBoxes& remote,
                                 PartnerLists& faces_to_send) {
  const auto faces = toHost(faces_to_test.rows);
  const auto boxes = toHost(face_boxes);
  const auto nodes = toHost(remote.boxes);
  std::vector<int> kept;
  for (std::size_t p = 0; p < faces_to_test.ranks.size(); ++p) {
    for (std::int64_t i = faces_to_test.offsets[p]; i < faces_to_test.offsets[p + 1]; ++i) {
      const Box& box = boxes(faces(i));
      bool overlaps = false;
      for (std::int64_t n = remote.offsets[p]; n < remote.offsets[p + 1] && !overlaps; ++n)
        overlaps = box.overlaps(nodes(n));
      if (overlaps)
        kept.push_back(faces(i));
    }
    faces_to_send.offsets[p + 1] = static_cast<std::int64_t>(kept.size());
  }
  copyToDevice(space, kept, faces_to_send.rows);
  return faces_to_send.size();
}

void referencePairs(const exec_space& space, const Surface& surface, const GhostFaces& ghosts,
                    const View<const Box*>& node_boxes, const View<const Box*>& face_boxes,
                    bool drop_same_body, View<std::int64_t*>& row_offsets, CandidatePairs& pairs) {
  const auto nodes = toHost(node_boxes), faces = toHost(face_boxes);
  const auto owned = toHost(surface.node_is_owned);
  const PairRules<Kokkos::HostSpace> rules(surface, ghosts, drop_same_body);
  const int num_faces = surface.num_faces + ghosts.count;
  std::vector<std::int64_t> offsets(1, 0);
  std::vector<int> found;
  for (int node = 0; node < surface.num_nodes; ++node) {
    for (int face = 0; face < num_faces && owned(node); ++face)
      if (nodes(node).overlaps(faces(face)) && rules.allow(node, face))
        found.push_back(face);
    offsets.push_back(static_cast<std::int64_t>(found.size()));
  }
  copyToDevice(space, offsets, row_offsets);
  copyToDevice(space, found, pairs.faces);
}

} // namespace brickwall::contact
