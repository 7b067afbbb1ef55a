#include "contact/overlap/box_pairs.hpp"

#include "contact/base/mpi.hpp"
#include "contact/base/region.hpp"
#include "contact/base/to_device.hpp"
#include "contact/search/candidate_search.hpp"
#include "contact/surface/check_surface.hpp"

#include <algorithm>
#include <map>

namespace brickwall::contact {
namespace {

struct BodyBox {
  global_id body;
  Box box;
};

// The boxes of the bodies of this rank's nodes.
std::map<global_id, Box> boxesOfBodies(const Surface& surface) {
  const auto x = toHost(surface.coordinates_new);
  const auto bodies = toHost(surface.node_body);
  std::map<global_id, Box> boxes;
  for (int node = 0; node < surface.num_nodes;) {
    const global_id body = bodies(node);
    Box& box = boxes[body];
    for (; node < surface.num_nodes && bodies(node) == body; ++node)
      box.include(rowOf(x, node));
  }
  return boxes;
}

// [box] whether it overlaps another box of any rank.
std::vector<char> findMeeting(const exec_space& space, MPI_Comm comm,
                              const std::map<global_id, Box>& of_bodies, double least) {
  const std::size_t count = of_bodies.size();
  const auto boxes = allocate<View<Box*>>(space, "contact::bodiesThatMeet::boxes", count);
  const auto ids = allocate<View<global_id*>>(space, "contact::bodiesThatMeet::ids", count);
  const auto host_boxes = Kokkos::create_mirror_view(boxes);
  const auto host_ids = Kokkos::create_mirror_view(ids);
  std::size_t next = 0;
  for (const auto& [body, box] : of_bodies) {
    host_boxes(next) = shrunk(box, least);
    host_ids(next++) = body;
  }
  Kokkos::deep_copy(space, boxes, host_boxes);
  Kokkos::deep_copy(space, ids, host_ids);
  SearchConfig config;
  config.drop_same_body = true;
  CandidateSearch search(comm, config);
  search.update(space, sweptBoxes(space, boxes, ids, ids, ConstAttributeWords()));
  const CandidatePairs pairs = search.pairs();
  const View<char*> meets("contact::bodiesThatMeet::meets", count);
  Kokkos::parallel_for(
      "contact::bodiesThatMeet", rangePolicy(space, pairs.num_rows),
      KOKKOS_LAMBDA(const std::int64_t row) {
        meets(pairs.node(row)) = pairs.end(row) > pairs.begin(row);
      });
  std::vector<char> result(count);
  Kokkos::deep_copy(
      space, Kokkos::View<char*, Kokkos::HostSpace, Kokkos::MemoryUnmanaged>(result.data(), count),
      meets);
  space.fence();
  return result;
}

} // namespace

SweptBoxes sweptBoxes(const exec_space& space, const View<const Box*>& boxes,
                      const View<const global_id*>& ids, const View<const global_id*>& groups,
                      const ConstAttributeWords& attributes) {
  const int count = checkedInt(static_cast<std::int64_t>(boxes.extent(0)), "boxes of a search");
  const auto low = allocate<View<double* [3]>>(space, "contact::sweptBoxes::low", count);
  const auto high = allocate<View<double* [3]>>(space, "contact::sweptBoxes::high", count);
  const auto nodes = allocate<View<int* [4]>>(space, "contact::sweptBoxes::nodes", count);
  const auto owned = allocate<View<unsigned char*>>(space, "contact::sweptBoxes::owned", count);
  Kokkos::parallel_for(
      "contact::sweptBoxes", rangePolicy(space, count), KOKKOS_LAMBDA(const std::int64_t i) {
        for (int d = 0; d < 3; ++d) {
          low(i, d) = boxes(i).lower[d];
          high(i, d) = boxes(i).upper[d];
        }
        for (int j = 0; j < 4; ++j)
          nodes(i, j) = static_cast<int>(i);
        owned(i) = 1;
      });
  SweptBoxes swept;
  swept.num_nodes = swept.num_faces = count;
  swept.coordinates_old = low;
  swept.coordinates_new = high;
  swept.face_to_nodes = nodes;
  swept.node_ids = swept.face_ids = ids;
  swept.node_is_owned = owned;
  swept.node_body = swept.face_body = groups;
  swept.face_attributes = attributes;
  return swept;
}

std::vector<global_id> bodiesThatMeet(const exec_space& space, MPI_Comm comm,
                                      const Surface& surface, double least) {
  const Region region("contact::bodiesThatMeet");
  checkSurface(space, comm, "bodiesThatMeet", surface);
  // A rank chosen by the number of the body joins its parts.
  const int num_ranks = sizeOf(comm);
  std::vector<std::vector<BodyBox>> parts(num_ranks);
  for (const auto& [body, box] : boxesOfBodies(surface))
    parts[body % num_ranks].push_back({body, box});
  const auto received = exchangeByRank(comm, parts);
  std::map<global_id, Box> bodies;
  for (const auto& of_rank : received)
    for (const BodyBox& part : of_rank)
      bodies[part.body].include(part.box);
  const std::vector<char> meets = findMeeting(space, comm, bodies, least);
  std::vector<global_id> meeting;
  std::size_t next = 0;
  for (const auto& body : bodies)
    if (meets[next++])
      meeting.push_back(body.first);
  std::vector<std::vector<global_id>> replies(num_ranks);
  for (int q = 0; q < num_ranks; ++q)
    for (const BodyBox& part : received[q])
      if (std::binary_search(meeting.begin(), meeting.end(), part.body))
        replies[q].push_back(part.body);
  std::vector<global_id> own;
  for (const auto& of_rank : exchangeByRank(comm, replies))
    own.insert(own.end(), of_rank.begin(), of_rank.end());
  std::sort(own.begin(), own.end());
  return own;
}

} // namespace brickwall::contact
