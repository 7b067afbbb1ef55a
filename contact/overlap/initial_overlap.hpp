// Initial penetration of bodies: nodes inside other bodies, and elements that overlap elements.
// Equations: theory.md, section 13.
#pragma once

#include "contact/base/vec3.hpp"
#include "contact/overlap/hex_overlap.hpp"
#include "contact/surface/leading_pair.hpp"
#include "contact/surface/surface.hpp"

#include <mpi.h>

namespace brickwall::contact {

// The face is the nearest face of the body that the node penetrates.
struct InitialOverlap : PairIds {
  double depth = 0; // length; 0: no node is inside another body
};

// The node that is deepest inside another body at coordinates_new, among those no deeper than about
// 2 `reach` (length). A node is inside if the nearest point of the body's faces lies within the
// face, not on its rim, and the node lies behind the face. Among equal depths the lowest node, then
// face. `surface` is not divided into sides. For set-up: the cost is that of one search with wide
// boxes. Collective.
InitialOverlap deepestOverlap(const exec_space& space, MPI_Comm comm, const Surface& surface,
                              double reach);

// Hexahedral elements of this rank that may overlap elements of other bodies.
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

// The two elements of different bodies that overlap deepest, among those deeper than `least`. It
// finds bodies that overlap although no node of one is inside the other, or too deep for
// deepestOverlap(). For warped elements the limit is larger by half the warp of their sides, since
// their hulls (hex_overlap.hpp) may overlap where the elements only touch. Among equal depths the
// lowest ids. Only elements of bodies whose boxes overlap by `least` (bodiesThatMeet()) are needed.
// For set-up: the cost is that of one search and of some hundred axes for each pair whose boxes
// overlap. Collective.
ElementOverlap deepestElementOverlap(const exec_space& space, MPI_Comm comm,
                                     const BodyElements& elements, double least);

} // namespace brickwall::contact
