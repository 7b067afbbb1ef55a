// The faces around each owned surface node, including those of other ranks: static lists, and the
// mean planes of the faces per step. The tributary area A_i and the opposed-normal rule use them.
#pragma once

#include "contact/base/messages/exchange_plan.hpp"
#include "contact/surface/projection.hpp"
#include "contact/surface/surface.hpp"

namespace brickwall::contact {

// Faces around nodes in compressed rows: rows(offsets(node)) .. rows(offsets(node + 1) - 1), by
// ascending global face id. A row below num_faces is an own face, otherwise remote face row -
// num_faces. Nodes that are not owned here have none.
struct NodeFaceLists {
  View<int*> offsets; // [num_nodes + 1]
  View<int*> rows; // [offsets(num_nodes)]
  View<double*> surface_mass; // mu = rho h_n/2, mass/area [num_faces + num_remote]
  // Share of the face's area that belongs to a corner: 1/4, or 1/3 on triangles [num_faces +
  // num_remote].
  View<double*> corner_share;
};

// The records of own faces to be made. Empty Views: no face is stationary, and all are requested.
struct RecordSelection {
  View<const unsigned char*> stationary; // [own face] has not moved since the last step
  View<const unsigned char*> is_requested; // [own face]
  // [own face] the record is that of the last step; after select(), that of this step
  View<unsigned char*> is_current;

  KOKKOS_INLINE_FUNCTION bool select(std::int64_t face) const {
    const bool has_it = stationary.extent(0) > 0 && stationary(face) && is_current(face);
    const bool takes = !has_it && (is_requested.extent(0) == 0 || is_requested(face));
    is_current(face) = has_it || takes;
    return takes;
  }
};

class NodeFaces {
public:
  // Collective. Uses ids, ownership, connectivity and the surface mass of `surface`. Throws on all
  // ranks if a node is owned by no rank that has it on its surface, since its contacts would be
  // missed.
  NodeFaces(const exec_space& space, const Communicator& comm, const Surface& surface);

  const NodeFaceLists& lists() const { return _lists; }
  int numRemote() const { return _num_remote; }

  // Collective. Fills records(0 .. num_faces + num_remote - 1) at coordinates_new; of remote faces
  // only the normal and the area, with the bits of the face's own rank. Own faces that are not
  // selected are skipped.
  void updateRecords(const exec_space& space, const SweptBoxes& surface,
                     const RecordSelection& selection, const View<FaceRecord*>& records);
  // Collective. Takes part in updateRecords() of the other ranks on a rank without a valid surface.
  void exchangeNothing(const exec_space& space) {
    _plan.forward(space, _border_areas, _remote_areas);
  }

private:
  NodeFaceLists _lists;
  int _num_faces = 0, _num_remote = 0;
  View<int*> _border_faces; // own faces that other ranks request
  View<double* [3]> _border_areas; // area vectors
  View<double* [3]> _remote_areas; // of remote faces
  ExchangePlan _plan;
};

} // namespace brickwall::contact
