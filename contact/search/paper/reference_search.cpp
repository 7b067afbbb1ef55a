#include "contact/search/paper/reference_search.hpp"

#include "contact/base/to_device.hpp"
#include "contact/surface/candidate_rows.hpp"

namespace brickwall::contact {

void ReferenceSearch::findCandidates(const exec_space& space, const View<const Box*>& boxes,
                                     int num_rows, const std::vector<Box>& rank_boxes,
                                     RankBoxSearch&, PartnerLists& lists) {
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

std::int64_t ReferenceSearch::findFaces(const exec_space& space) {
  const PartnerLists& faces_to_test = _faces_to_test;
  const RemoteNodeBoxes& remote = _remote_nodes;
  const auto faces = toHost(faces_to_test.rows);
  const auto boxes = toHost(_boxes.face_boxes);
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
    _faces_to_send.offsets[p + 1] = static_cast<std::int64_t>(kept.size());
  }
  copyToDevice(space, kept, _faces_to_send.rows);
  return _faces_to_send.size();
}

void ReferenceSearch::findRows(const exec_space& space, const SweptBoxes& surface,
                               const GhostFaces& ghosts, const View<const Box*>& face_boxes,
                               const Box&, bool drop_same_body) {
  const auto nodes = toHost(View<const Box*>(_boxes.node_boxes)), faces = toHost(face_boxes);
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
  copyToDevice(space, offsets, _offsets);
  copyToDevice(space, found, _pairs.faces);
}

} // namespace brickwall::contact
