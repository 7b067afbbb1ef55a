#include "contact/surface/construct_boxes.hpp"

#include "contact/base/region.hpp"

#include <cfloat>

namespace brickwall::contact {
namespace {

// The reduction over the nodes: the rank box, and the nodes with coordinates that are not finite.
struct NodeReduction {
  Box box;
  std::int64_t num_invalid = 0;
  global_id first_invalid = INT64_MAX;

  KOKKOS_INLINE_FUNCTION NodeReduction& operator+=(const NodeReduction& b) {
    box += b.box;
    num_invalid += b.num_invalid;
    first_invalid = minOf(first_invalid, b.first_invalid);
    return *this;
  }
};

KOKKOS_INLINE_FUNCTION bool isFinite(const Vec3& x) {
  return std::fabs(x.x) <= DBL_MAX && std::fabs(x.y) <= DBL_MAX && std::fabs(x.z) <= DBL_MAX;
}

void constructNodeBoxes(const exec_space& space, const SweptBoxes& surface, double tolerance,
                        SurfaceBoxes& boxes) {
  const Region region("contact::search::node_boxes");
  const auto x_old = surface.coordinates_old, x_new = surface.coordinates_new;
  const auto ids = surface.node_ids;
  const auto owned = surface.node_is_owned;
  const auto node_boxes = boxes.node_boxes;
  NodeReduction result;
  Kokkos::parallel_reduce(
      "contact::constructBoxes::nodes", rangePolicy(space, surface.num_nodes),
      KOKKOS_LAMBDA(const std::int64_t node, NodeReduction& all) {
        const Vec3 a = rowOf(x_old, node), b = rowOf(x_new, node);
        if (!isFinite(a) || !isFinite(b)) { // counted on every rank that has it: a face may use it
          ++all.num_invalid;
          all.first_invalid = minOf(all.first_invalid, ids(node));
        }
        const Box box = owned(node) ? nodeBox(a, b, tolerance) : Box();
        node_boxes(node) = box;
        all.box.include(box);
      },
      PlusReducer<NodeReduction>(result));
  boxes.node_box = result.box;
  boxes.num_invalid = result.num_invalid;
  boxes.first_invalid = result.first_invalid;
}

void constructFaceBoxes(const exec_space& space, const SweptBoxes& surface, double tolerance,
                        SurfaceBoxes& boxes) {
  const Region region("contact::search::face_boxes");
  const auto x_old = surface.coordinates_old, x_new = surface.coordinates_new;
  const auto face_to_nodes = surface.face_to_nodes;
  const auto face_boxes = boxes.face_boxes;
  Kokkos::parallel_reduce(
      "contact::constructBoxes::faces", rangePolicy(space, surface.num_faces),
      KOKKOS_LAMBDA(const std::int64_t face, Box& all) {
        const Box box = faceBox(x_old, x_new, face_to_nodes, face, tolerance);
        face_boxes(face) = box;
        all.include(box);
      },
      PlusReducer<Box>(boxes.face_box));
}

} // namespace

void constructBoxes(const exec_space& space, const SweptBoxes& surface, const SearchConfig& config,
                    SurfaceBoxes& boxes) {
  const Region region("contact::constructBoxes");
  {
    const Region allocation("contact::search::allocation");
    growTo(space, boxes.node_boxes, surface.num_nodes);
    growTo(space, boxes.face_boxes, surface.num_faces);
  }
  constructNodeBoxes(space, surface, config.node_tolerance, boxes);
  constructFaceBoxes(space, surface, config.face_tolerance, boxes);
}

} // namespace brickwall::contact
