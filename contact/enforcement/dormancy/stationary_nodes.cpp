// See stationary_nodes.hpp.
#include "contact/enforcement/dormancy/stationary_nodes.hpp"

namespace brickwall::contact {

StationaryNodes::StationaryNodes(const std::string& label, const SweptBoxes& surface,
                                 const View<const int*>& point_to_node)
    : _point_to_node(point_to_node),
      _nodes(label + "::still_nodes", point_to_node.data() ? surface.num_nodes : 0),
      _faces(label + "::still_faces", surface.num_faces) {
  _flags.nodes = _nodes;
  _flags.faces = _faces;
  _flags.known_apart = View<unsigned char*>(label + "::clear_rows", surface.num_nodes);
}

void StationaryNodes::update(const exec_space& space, const SweptBoxes& surface,
                             const SurfaceMotion& motion, const StepTest& test) {
  const bool has_grown = test.node_tolerance > _last_test.node_tolerance ||
                         test.face_tolerance > _last_test.face_tolerance;
  if (has_grown)
    Kokkos::deep_copy(space, _flags.known_apart, static_cast<unsigned char>(0));
  _last_test = test;
  _flags.is_any = !motion.isNoneStill();
  _is_unchanged = _is_all_still && motion.isAllStill() && !has_grown;
  _is_all_still = motion.isAllStill();
  if (!_is_unchanged && _flags.is_any) // else all flags are set, or none is looked at
    setFlags(space, surface, motion);
}

void StationaryNodes::setFlags(const exec_space& space, const SweptBoxes& surface,
                               const SurfaceMotion& motion) {
  const auto still = motion.stillNodes();
  const auto to_node = _point_to_node;
  const auto nodes = _nodes, faces = _faces;
  const auto num_points = static_cast<std::int64_t>(to_node.extent(0));
  const bool has_list = num_points > 0;
  if (has_list)
    Kokkos::parallel_for(
        "contact::StationaryNodes::points", rangePolicy(space, num_points),
        KOKKOS_LAMBDA(const std::int64_t i) { nodes(i) = still(to_node(i)); });
  else
    _flags.nodes = still;
  const auto of_points = _flags.nodes;
  Kokkos::parallel_for(
      "contact::StationaryNodes::faces", rangePolicy(space, surface.num_faces),
      KOKKOS_LAMBDA(const std::int64_t face) {
        unsigned all = 1;
        for (int j = 0; j < 4; ++j)
          all &= of_points(surface.face_to_nodes(face, j));
        faces(face) = static_cast<unsigned char>(all);
        if (has_list)
          nodes(num_points + face) = static_cast<unsigned char>(all);
      });
}

} // namespace brickwall::contact
