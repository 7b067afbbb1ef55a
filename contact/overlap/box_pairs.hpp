// Boxes that overlap those of others, found by the search. For set-up.
#pragma once

#include "contact/base/box.hpp"
#include "contact/surface/surface.hpp"

#include <mpi.h>

#include <vector>

namespace brickwall::contact {

// Boxes [box] as input of CandidateSearch: node i and face i have the extent of box i, its id, and
// its group as body; the face has row i of `attributes`.
SweptBoxes sweptBoxes(const exec_space& space, const View<const Box*>& boxes,
                      const View<const global_id*>& ids, const View<const global_id*>& groups,
                      const ConstAttributeWords& attributes);

// `box` shrunk by `least`, but never below a point: two boxes shrunk so overlap if the boxes
// themselves overlap by `least` or more.
KOKKOS_INLINE_FUNCTION Box shrunk(Box box, double least) {
  const Vec3 centre = box.centroid();
  box.inflate(-0.5 * least);
  for (int d = 0; d < 3; ++d) {
    box.lower[d] = minOf(box.lower[d], centre[d]);
    box.upper[d] = maxOf(box.upper[d], centre[d]);
  }
  return box;
}

// The bodies of this rank's nodes whose boxes, over all ranks and at coordinates_new, overlap the
// box of another body by `least` or more; ascending. Collective.
std::vector<global_id> bodiesThatMeet(const exec_space& space, MPI_Comm comm,
                                      const Surface& surface, double least);

} // namespace brickwall::contact
