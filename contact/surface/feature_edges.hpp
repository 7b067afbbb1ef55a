// The true edges of a surface: where a face has no coplanar neighbour of its body. Node-face contact fades out beyond them
// (edge_fading.hpp), and edges that cross such edges of other bodies push them (edge_contact.hpp).
#pragma once

#include "contact/surface/surface.hpp"

#include <mpi.h>

#include <vector>

namespace brickwall::contact {

// A convex edge between two faces of a body, listed by the rank of the face of lower id.
struct FeatureEdge {
  int face = -1; // own face
  int edge = 0; // from corner `edge` to the next one
  double cosine = 1,
         sine = 0; // of the angle between the outward normals of its two faces; sine > 0
  double width[2] = {0, 0}; // of its own face and of the other one: area over the edge's length
  int goes_on =
      0; // bit 0, 1: beyond its first, second node another one goes on in the same direction
};

struct FeatureEdges {
  std::vector<unsigned char> true_edges; // [own face] bit j: edge j is a true edge, convex or not
  std::vector<FeatureEdge> convex; // by ascending (face, edge)
};

// Collective; for set-up. Edges where the normals of the two faces at coordinates_new differ by more than the angle whose
// cosine is given; also edges of one face only, or of more than two, which are true but never listed as convex.
FeatureEdges findFeatureEdges(MPI_Comm comm, const Surface& surface, double cosine = 0.75);

} // namespace brickwall::contact
