#include "mechanics/mesh/element_failure.hpp"

#include "contact/base/mpi.hpp"
#include "mechanics/element/hex8_geometry.hpp"
#include "mechanics/mesh/host_mesh.hpp"

#include <cstdio>

namespace brickwall::mechanics {

namespace {

Vec3 centreOf(const HostMesh& host, int elem) {
  Vec3 centre;
  for (int c = 0; c < 8; ++c)
    for (int j = 0; j < 3; ++j)
      centre[j] += 0.125 * host.reference_coordinates(host.elem_to_nodes(elem, c), j);
  return centre;
}

const char* textOf(int reason) {
  switch (reason) {
  case inverted_element:
    return "inverted (J <= 0)";
  case not_a_number:
    return "force is not a number";
  case force_overflow:
    return "force beyond the fixed-point range";
  case mass_out_of_range:
    return "mass beyond the range of numbers";
  default:
    return "no failure";
  }
}

} // namespace

GlobalFailure agreeOnFailure(const exec_space& space, MPI_Comm comm, const HexMesh& mesh,
                             const ElementFailure& local) {
  GlobalFailure result;
  result.count = allReduce(comm, local.count, MPI_SUM);
  const global_id none = INT64_MAX;
  const global_id first = allReduce(comm, local.count > 0 ? local.first_elem : none, MPI_MIN);
  if (first == none)
    return result;
  result.first_elem = first;
  result.reason = allReduce(comm, local.first_elem == first ? local.reason : 0, MPI_MAX);
  // Only the rank that holds the element knows its position.
  double position[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
  if (local.first_elem == first) {
    const HostMesh host = copyToHost(space, mesh);
    for (int elem = 0; elem < mesh.num_elems; ++elem)
      if (host.elem_ids(elem) == first) {
        const Vec3 centre = centreOf(host, elem);
        for (int j = 0; j < 3; ++j)
          position[j] = centre[j];
      }
  }
  allReduce(comm, position, 3, MPI_MAX);
  result.position = {position[0], position[1], position[2]};
  return result;
}

std::string describe(const GlobalFailure& failure) {
  char text[256];
  std::snprintf(text, sizeof text, "at (%.9g, %.9g, %.9g): %s; failed elements: %lld",
                failure.position.x, failure.position.y, failure.position.z, textOf(failure.reason),
                static_cast<long long>(failure.count));
  return text;
}

} // namespace brickwall::mechanics
