// The skin faces around each owned surface node, those of other ranks included: static lists, and
// per step the mean planes of the faces. The area A_i of a contact and the opposed-normal
// rule come from them.
#pragma once

#include "contact/base/exchange_plan.hpp"
#include "contact/surface/projection.hpp"
#include "contact/surface/surface.hpp"

namespace brickwall::contact {

// Faces around nodes, compressed rows: rows(offsets(node)) .. rows(offsets(node + 1) - 1), by
// ascending global face id. A row below num_faces is an own face, else remote face row - num_faces.
// Empty for nodes not owned here.
struct NodeFaceLists {
  View<int*> offsets; // [num_nodes + 1]
  View<int*> rows; // [offsets(num_nodes)]
  View<double*> surface_mass; // mu = rho h_n/2, mass/area [num_faces + num_remote]
  // Part of the face's area that is a corner's: 1/4, 1/3 on triangles [num_faces + num_remote].
  View<double*> corner_share;
};

// Which records of own faces are to be made. Empty Views: no face is still, all are wanted.
struct RecordsWanted {
  View<const unsigned char*> still; // [own face] has not moved since the last step
  View<const unsigned char*> is_wanted; // [own face]
  View<unsigned char*>
      is_current; // [own face] the record is that of the last step, then of this one

  KOKKOS_INLINE_FUNCTION bool take(std::int64_t face) const {
    const bool has_it = still.extent(0) > 0 && still(face) && is_current(face);
    const bool takes = !has_it && (is_wanted.extent(0) == 0 || is_wanted(face));
    is_current(face) = has_it || takes;
    return takes;
  }
};

class NodeFaces {
public:
  NodeFaces() = default;
  // Collective. Uses ids, ownership, connectivity and the attribute mu of `surface`. Throws (on all
  // ranks) when a node is owned by no rank that has it on its surface, since its contact would then
  // be missed.
  NodeFaces(const exec_space& space, const Communicator& comm, const Surface& surface);

  const NodeFaceLists& lists() const { return _lists; }
  int numRemote() const { return _num_remote; }

  // Collective. Fills records(0 .. num_faces + num_remote - 1) at coordinates_new; of remote faces
  // only the normal and the area. The bits are those of the face's own rank. Own faces that are not wanted are left out.
  void updateRecords(const exec_space& space, const SweptBoxes& surface,
                     const RecordsWanted& wanted, const View<FaceRecord*>& records);
  // Collective: other ranks are in updateRecords(), this one has no surface for it.
  void exchangeNothing(const exec_space& space) {
    _plan.forward(space, _border_areas, _remote_areas);
  }

private:
  NodeFaceLists _lists;
  int _num_faces = 0, _num_remote = 0;
  View<int*> _border_faces; // own faces that other ranks ask for
  View<double* [3]> _border_areas; // their area vectors
  View<double* [3]> _remote_areas; // area vectors of remote faces
  ExchangePlan _plan;
};

} // namespace brickwall::contact
