#include "contact/enforcement/dormancy/stationary_nodes.hpp"

namespace brickwall::contact {
namespace {

// A face is stationary if all its corners are. With points of their own, `nodes` are these and then
// the faces.
void flagFaces(const exec_space& space, const SweptBoxes& surface,
               const View<const unsigned char*>& of_surface, const View<const int*>& point_to_node,
               const View<unsigned char*>& faces, const View<unsigned char*>& nodes) {
  const auto num_points = static_cast<std::int64_t>(point_to_node.extent(0));
  const std::int64_t num_faces = surface.num_faces;
  Kokkos::parallel_for(
      "contact::StationaryNodes::flagFaces", rangePolicy(space, maxOf(num_points, num_faces)),
      KOKKOS_LAMBDA(const std::int64_t i) {
        const bool has_points = num_points > 0;
        if (i < num_points)
          nodes(i) = of_surface(point_to_node(i));
        if (i >= num_faces)
          return;
        unsigned all = 1;
        for (int j = 0; j < 4; ++j) {
          const int corner = surface.face_to_nodes(i, j);
          all &= of_surface(has_points ? point_to_node(corner) : corner);
        }
        faces(i) = static_cast<unsigned char>(all);
        if (has_points)
          nodes(num_points + i) = static_cast<unsigned char>(all);
      });
}

} // namespace

StationaryNodes::StationaryNodes(const std::string& label, const SweptBoxes& surface,
                                 const View<const int*>& point_to_node)
    : _point_to_node(point_to_node),
      _nodes(label + "::stationary_nodes", point_to_node.data() ? surface.num_nodes : 0),
      _faces(label + "::stationary_faces", surface.num_faces) {
  _flags.nodes = _nodes;
  _flags.faces = _faces;
  _flags.known_apart = View<unsigned char*>(label + "::known_apart", surface.num_nodes);
}

void StationaryNodes::update(const exec_space& space, const SweptBoxes& surface,
                             const SurfaceMotion& motion, const StepTest& test) {
  const bool has_grown = test.node_tolerance > _last_test.node_tolerance ||
                         test.face_tolerance > _last_test.face_tolerance;
  if (has_grown)
    Kokkos::deep_copy(space, _flags.known_apart, static_cast<unsigned char>(0));
  _last_test = test;
  _flags.is_any = !motion.isNoneStationary();
  _is_unchanged = _is_all_stationary && motion.isAllStationary() && !has_grown;
  _is_all_stationary = motion.isAllStationary();
  // Otherwise all flags are set, or none is read.
  if (!_is_unchanged && _flags.is_any) {
    const auto of_surface = motion.stationaryNodes();
    if (_point_to_node.extent(0) == 0)
      _flags.nodes = of_surface;
    flagFaces(space, surface, of_surface, _point_to_node, _faces, _nodes);
  }
}

} // namespace brickwall::contact
