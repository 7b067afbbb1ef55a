// The contact surface that a host code gives to the search, and the results of the search: ghosts
// and candidate pairs.
#pragma once

#include "contact/base/backend.hpp"
#include "contact/surface/contact_point.hpp"
#include "contact/surface/face_attributes.hpp"

#include <cstdint>

namespace brickwall::contact {

// The surface of a body may be divided into sides (surface_sides.hpp): a node has at most one
// contact with each. The side 0 of a body has the number of the body itself.
inline constexpr int body_bits = 40; // of the number of a body
KOKKOS_INLINE_FUNCTION global_id sideOfBody(global_id body, int side) {
  return body | global_id(side) << body_bits;
}
KOKKOS_FORCEINLINE_FUNCTION global_id bodyOfSide(global_id side) {
  return side & ((global_id(1) << body_bits) - 1);
}

// The input of the search: boxes swept over the step, one for each node, and faces, whose boxes are
// the hulls of those of their corners. Node boxes look for partners among the faces of all ranks.
// The arrays belong to the host code; the search only reads them. A node that several ranks share
// is owned by exactly one of them.
struct SweptBoxes {
  int num_nodes = 0;
  int num_faces = 0;
  // Two opposite corners of the box of each node [node][xyz], length. Of a node that moves they are
  // x^n and x^{n+1}.
  View<const double* [3]> coordinates_old;
  View<const double* [3]> coordinates_new;
  // [face][corner], outward normal by the right-hand rule; a triangle repeats a corner
  View<const int* [4]> face_to_nodes;
  // [node] 0 or more, each once on a rank; below 2^60 for enforcement
  View<const global_id*> node_ids;
  View<const global_id*> face_ids; // [face] likewise
  View<const unsigned char*> node_is_owned; // [node]
  View<const global_id*> node_body; // [node] 0 or more, below 2^40; bodies share no node
  View<const global_id*> face_body; // [face] body, or side of a body
  ConstAttributeWords face_attributes; // data of the host that ghosts carry along; may be empty
};

// Calls body(node) for the nodes of a pair on this rank: those of the point, a node twice, and the
// corners of an own face.
template <class Body>
KOKKOS_FORCEINLINE_FUNCTION void forEachNodeOf(const ContactPoint& point, int face,
                                               const SweptBoxes& surface, const Body& body) {
  body(point.node[0]);
  body(point.node[1]);
  if (face < surface.num_faces)
    for (int j = 0; j < 4; ++j)
      body(surface.face_to_nodes(face, j));
}

// This rank's exterior faces and the nodes on them (local surface nodes 0 .. num_nodes-1), which
// move from x^n to x^{n+1}. Contact enforcement needs FaceAttributes.
struct Surface : SweptBoxes {};

// Copies of other ranks' faces that this rank's owned nodes may touch, by owner rank; those of one
// owner by face id (methods `paper` and `reference`) or in the order in which the owner keeps its
// faces (`cluster`), which lasts until the owner sorts again. Rows [0, count) are valid; the Views
// may be longer (they persist and grow).
struct GhostFaces {
  using CornerIds = View<global_id* [4]>; // [ghost][corner]
  using CornerCoordinates = View<double* [12]>; // [ghost][3 * corner + xyz], length

  int count = 0;
  View<global_id*> face_ids{"contact::GhostFaces::face_ids", 0}; // [ghost]
  View<global_id*> bodies{"contact::GhostFaces::bodies", 0}; // [ghost] as face_body
  CornerIds corner_ids{"contact::GhostFaces::corner_ids", 0}; // global node ids
  CornerCoordinates coordinates_old{"contact::GhostFaces::coordinates_old", 0}; // x^n
  CornerCoordinates coordinates_new{"contact::GhostFaces::coordinates_new", 0}; // x^{n+1}
  AttributeWords attributes{"contact::GhostFaces::attributes", 0, 0}; // [ghost] as face_attributes

  // A placeholder that allocates nothing, not even labels.
  static GhostFaces none() { return {0, {}, {}, {}, {}, {}, {}}; }
};

// A search with a margin (candidate_search.hpp) finds more pairs than a search in the step would.
// The latter are the pairs whose boxes of the step, inflated by these tolerances, overlap
// (FaceAccess::boxesOverlap); results that must not depend on the margin are tested for that.
struct StepTest {
  bool is_needed = false;
  double node_tolerance = 0, face_tolerance = 0; // length; set also where the test is not needed
};

// Candidate pairs in rows, one row for each surface node, in an order chosen by the search: row r
// lists the faces that node(r) may touch, faces(begin(r)) .. faces(end(r) - 1). A face index below
// num_faces is an own face, otherwise it is ghost face index - num_faces. Rows of nodes not owned
// here are empty. Each row is in the order of (side, face id), without repeats. Rows come in
// blocks; between blocks `faces` may have entries that belong to no row. The Views persist and
// grow.
struct CandidatePairs {
  static constexpr int rows_per_block = cluster_size;

  std::int64_t count = 0; // pairs in all rows
  int num_rows = 0; // number of surface nodes
  View<int*> row_nodes{"contact::CandidatePairs::row_nodes", 0}; // [row] surface node
  View<std::int64_t*> block_begin{"contact::CandidatePairs::block_begin", 0}; // [block] into faces
  // [block][rows_per_block + 1] begin of each row of the block and end of its last row, relative to
  // block_begin
  View<int*> row_begin{"contact::CandidatePairs::row_begin", 0};
  View<int*> faces{"contact::CandidatePairs::faces", 0};
  // [block] 0: the rows are the same as in the previous search, which had the version before this
  // one. Without meaning where the version is 0.
  View<unsigned char*> changed{"contact::CandidatePairs::changed", 0};
  // increases by 1 with each search, by 2 where the rows are in a new order
  std::int64_t version = 0;
  StepTest step_test;

  // As GhostFaces::none().
  static CandidatePairs none() { return {0, 0, {}, {}, {}, {}, {}, 0, {}}; }

  KOKKOS_INLINE_FUNCTION int node(std::int64_t row) const { return row_nodes(row); }
  KOKKOS_INLINE_FUNCTION std::int64_t begin(std::int64_t row) const { return at(row, 0); }
  KOKKOS_INLINE_FUNCTION std::int64_t end(std::int64_t row) const { return at(row, 1); }

private:
  KOKKOS_INLINE_FUNCTION std::int64_t at(std::int64_t row, int next) const {
    const std::int64_t block = row / rows_per_block;
    return block_begin(block) + row_begin(row + block + next);
  }
};

} // namespace brickwall::contact
