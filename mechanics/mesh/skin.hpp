// The exterior faces of the mesh: element faces that no other element of any rank shares.
#pragma once

#include "mechanics/mesh/hex_mesh.hpp"

#include <vector>

namespace brickwall::mechanics {

// Local corners of the sides of a hex8 (Exodus order, 0-based); the normal is outward by the
// right-hand rule.
constexpr int hex8_sides[6][4] = {{0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6},
                                  {0, 4, 7, 3}, {0, 3, 2, 1}, {4, 5, 6, 7}};

struct Skin {
  int num_faces = 0; // of elements of this rank, in the order of local element, then side
  int num_nodes = 0; // on the surface, including those only on faces of other ranks

  View<int*> face_to_elem; // [face] local element
  View<int*> face_to_side; // [face] 0..5
  View<global_id*> face_ids; // [face] global element id * 6 + side
  View<int* [4]> face_to_nodes; // [face][corner] mesh-local nodes, outward normal
  View<int* [4]> face_to_surface_nodes; // [face][corner] surface nodes
  View<int*> surface_to_node; // [surface node] mesh-local node, ascending
};

// Faces are matched by their four global node ids, between ranks by a rendezvous. Throws
// BadElementError if more than two elements share a face. For set-up; collective.
Skin findSkin(const exec_space& space, MPI_Comm comm, const HexMesh& mesh,
              const SharedNodeLists& shared);

// Corner nodes [face][4] of the given element sides, for side sets.
std::vector<int> sideNodes(const HexMesh& mesh, const std::vector<int>& elems,
                           const std::vector<int>& sides);

} // namespace brickwall::mechanics
