// Bodies that stand in each other before anything has moved: nodes in bodies, and elements in elements.
#pragma once

#include "contact/base/vec3.hpp"
#include "contact/overlap/hex_overlap.hpp"
#include "contact/surface/leading_pair.hpp"
#include "contact/surface/surface.hpp"

#include <mpi.h>

namespace brickwall::contact {

// The face is the nearest of the body that the node is in.
struct InitialOverlap : PairIds {
  double depth = 0; // length; 0: no node is inside another body
};

// The node that is deepest inside another body, at coordinates_new, of those no deeper than about 2 `reach` (length). A node is
// inside if the nearest point of the body's faces lies on the face, not on its rim, and the node behind it. Of equal depths the
// lowest node, then face. A set-up task: one search with wide boxes. Collective.
InitialOverlap deepestOverlap(const exec_space& space, MPI_Comm comm, const Surface& surface,
                              double reach);

// Elements of this rank that may stand in elements of other bodies, hexahedra.
struct BodyElements {
  int count = 0;
  View<const Hexahedron*> hexahedra; // [element] corners in Exodus order, length
  View<const global_id*> ids, bodies; // [element]
};

struct ElementOverlap {
  global_id element = -1, other = -1; // the lower id first
  global_id body = -1, other_body = -1;
  Vec3 centre; // of `element`
  double depth = 0; // length; 0: there is none
};

// The two elements of different bodies that stand deepest in each other, of those deeper than `least`: finds bodies that
// overlap though no node of the one is inside the other, or too far inside for deepestOverlap(). Deeper by half the
// warp of their sides is asked of warped elements, whose hulls (hex_overlap.hpp) may meet where they touch. Of equal depths
// the lowest ids. Needs elements of those bodies only whose boxes overlap by `least` (bodiesThatMeet()). For set-up: the work is that
// of one search, and of some hundred axes for each pair that does overlap. Collective.
ElementOverlap deepestElementOverlap(const exec_space& space, MPI_Comm comm,
                                     const BodyElements& elements, double least);

} // namespace brickwall::contact
