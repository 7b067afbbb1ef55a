// The contact surface that a host code gives to the search, and what the search gives back.
#pragma once

#include "contact/base/backend.hpp"

namespace brickwall::contact {

// This rank's exterior faces and the nodes on them (local surface nodes 0 .. num_nodes-1). The arrays are the host
// code's; the search only reads them. A node that several ranks share is owned by exactly one of them.
struct Surface {
  int num_nodes = 0;
  int num_faces = 0;
  View<const double* [3]> coordinates_old; // x^n     [node][xyz], length
  View<const double* [3]> coordinates_new; // x^{n+1} [node][xyz], length
  // [face][corner], outward normal by the right-hand rule; a triangle repeats a corner
  View<const int* [4]> face_to_nodes;
  View<const global_id*> node_ids; // [node]
  View<const global_id*> face_ids; // [face]
  View<const unsigned char*> node_is_owned; // [node]
  View<const global_id*> node_body; // [node] bodies share no node
  View<const global_id*> face_body; // [face]
  // [face][any number] host data that ghosts carry along; may be empty
  View<const double**> face_attributes;
};

// Copies of other ranks' faces that this rank's owned nodes may touch, in the order of owner rank, then face id.
// Rows [0, count) are valid; the Views may be longer (they persist and grow).
struct GhostFaces {
  using CornerIds = View<global_id* [4]>; // [ghost][corner]
  using CornerCoordinates = View<double* [12]>; // [ghost][3 * corner + xyz], length

  int count = 0;
  View<global_id*> face_ids{"contact::GhostFaces::face_ids", 0}; // [ghost]
  View<global_id*> bodies{"contact::GhostFaces::bodies", 0}; // [ghost]
  CornerIds corner_ids{"contact::GhostFaces::corner_ids", 0}; // global node ids
  CornerCoordinates coordinates_old{"contact::GhostFaces::coordinates_old", 0}; // x^n
  CornerCoordinates coordinates_new{"contact::GhostFaces::coordinates_new", 0}; // x^{n+1}
  View<double**> attributes{"contact::GhostFaces::attributes", 0, 0}; // [ghost][as face_attributes]
};

// Candidate pairs by node, compressed rows: faces(offsets(node)) .. faces(offsets(node + 1) - 1). A face index below
// num_faces is an own face, else ghost face index - num_faces. Rows of nodes not owned here are empty. Each row is
// in the order of (body, face id), without repeats. The Views may be longer (they persist and grow).
struct CandidatePairs {
  std::int64_t count = 0;
  View<std::int64_t*> offsets{"contact::CandidatePairs::offsets", 0}; // [num_nodes + 1]
  View<int*> faces{"contact::CandidatePairs::faces", 0}; // [count]
};

} // namespace brickwall::contact
