// Phase 1: bounding boxes of nodes and faces over the step (x^n and x^{n+1}), and the rank boxes
// that contain them.
// Equations: theory.md, section 1, eqs. (1) and (2).
#pragma once

#include "contact/base/box.hpp"
#include "contact/surface/search_config.hpp"
#include "contact/surface/surface.hpp"

#include <cstdint>

namespace brickwall::contact {

// What a rank sends to all others in phase 2.
struct OwnRankBoxes {
  Box node_box; // Bbar_n
  Box face_box; // Bbar_f
  std::int64_t num_invalid = 0; // nodes with a coordinate that is NaN or infinite
  global_id first_invalid = 0; // smallest global id of these
};

struct SurfaceBoxes : OwnRankBoxes {
  // B_n [node]; the empty box where not owned
  View<Box*> node_boxes{"contact::SurfaceBoxes::nodes", 0};
  View<Box*> face_boxes{"contact::SurfaceBoxes::faces", 0}; // B_f [face]
};

// Box of a node over the step.
KOKKOS_INLINE_FUNCTION Box nodeBox(const Vec3& x_old, const Vec3& x_new, double tolerance) {
  Box box;
  box.include(x_old);
  box.include(x_new);
  box.inflate(tolerance);
  return box;
}

// Box of a face over the step. All search methods use these boxes, bit for bit.
KOKKOS_INLINE_FUNCTION Box faceBox(const View<const double* [3]>& x_old,
                                   const View<const double* [3]>& x_new,
                                   const View<const int* [4]>& face_to_nodes, std::int64_t face,
                                   double tolerance) {
  Box box;
  for (int corner = 0; corner < 4; ++corner) {
    const int node = face_to_nodes(face, corner);
    box.include(rowOf(x_old, node));
    box.include(rowOf(x_new, node));
  }
  box.inflate(tolerance);
  return box;
}

// Box of a ghost over the step, with coordinates [ghost][3 * corner + xyz]: the same bits as on its
// owner.
KOKKOS_INLINE_FUNCTION Box ghostBox(const GhostFaces::CornerCoordinates& x_old,
                                    const GhostFaces::CornerCoordinates& x_new, std::int64_t ghost,
                                    double tolerance) {
  Box box;
  for (int c = 0; c < 12; c += 3) {
    box.include(Vec3{x_old(ghost, c), x_old(ghost, c + 1), x_old(ghost, c + 2)});
    box.include(Vec3{x_new(ghost, c), x_new(ghost, c + 1), x_new(ghost, c + 2)});
  }
  box.inflate(tolerance);
  return box;
}

// Fills `boxes` from the surface. Coordinates that are not finite are counted; the ranks decide
// together in phase 2.
void constructBoxes(const exec_space& space, const SweptBoxes& surface, const SearchConfig& config,
                    SurfaceBoxes& boxes);

} // namespace brickwall::contact
