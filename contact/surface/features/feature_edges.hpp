// The feature edges of a surface: edges at which a face has no coplanar neighbour of its body.
// Node-to-face contact fades out beyond them (edge_fading.hpp), and convex ones enter edge-to-edge
// contact (edge_contact.hpp).
// Equations: theory.md, section 9.
#pragma once

#include "contact/surface/surface.hpp"

#include <mpi.h>

#include <vector>

namespace brickwall::contact {

inline constexpr int num_lines = 1 << 22;

// A convex edge between two faces of a body, listed by the rank of the face of lower id.
struct FeatureEdge {
  int face = -1; // own face
  int edge = 0; // from corner `edge` to the next one
  // of the angle between the outward normals of its two faces; sine > 0
  double cosine = 1, sine = 0;
  double width[2] = {0, 0}; // of its own face and of the other one: area over the edge's length
  // Bit 0, 1: beyond its first, second node another feature edge continues in the same direction.
  int goes_on = 0;
  // Of its line (edge_lines.hpp), below num_lines: a hash of the lowest id of an edge of the line.
  // Two lines of a body have one number with a probability of 1/num_lines; they count as one.
  int line = 0;

  friend bool operator<(const FeatureEdge& a, const FeatureEdge& b) { // in FeatureEdges::convex
    return a.face != b.face ? a.face < b.face : a.edge < b.edge;
  }
};

// Enforcement needs face_edges as FaceAttributes::feature_edges and the sides in
// Surface::face_body, by sideOfBody().
struct FeatureEdges {
  // [own face] bit j: edge j is a feature edge, convex or not; bit 4 + j: the body is concave
  // there, or the surface is bent at another edge (FaceAttributes::feature_edges)
  std::vector<unsigned char> face_edges;
  std::vector<int> face_sides; // [own face] the side of its body (surface_sides.hpp)
  std::vector<FeatureEdge> convex; // ascending
};

// Collective; for set-up. Finds the edges at which the normals of the two faces at coordinates_new
// differ by more than the angle of the given cosine, and those at which they differ by more than
// 1e-3. Edges of one face only, or of more than two, are feature edges but never listed as convex.
// Throws InputError on all ranks for a surface that checkSurface() refuses.
FeatureEdges findFeatureEdges(MPI_Comm comm, const Surface& surface, double cosine = 0.75);

} // namespace brickwall::contact
