// See still_parts.hpp.
#include "contact/still_parts.hpp"

#include <cmath>

namespace brickwall::contact {
StillParts::StillParts(const exec_space& space, const std::string& label, const Surface& surface,
                       int num_points)
    : _num_points(num_points),
      _last(allocate<View<double* [3]>>(space, label + "::last_coordinates", num_points)),
      _nodes(label + "::still_nodes", surface.num_nodes),
      _faces(label + "::still_faces", surface.num_faces) {
  Kokkos::deep_copy(space, _last, static_cast<double>(NAN));
  _flags.nodes = _nodes;
  _flags.faces = _faces;
  _flags.clear = View<unsigned char*>(label + "::clear_rows", surface.num_nodes);
}

void StillParts::update(const exec_space& space, const Surface& surface, const StepTest& test) {
  const bool has_grown = test.node_tolerance > _last_test.node_tolerance ||
                         test.face_tolerance > _last_test.face_tolerance;
  if (has_grown)
    Kokkos::deep_copy(space, _flags.clear, static_cast<unsigned char>(0));
  _last_test = test;
  const auto last = _last;
  const auto nodes = _nodes, faces = _faces;
  const int num_points = _num_points;
  std::int64_t num_moving = 0;
  Kokkos::parallel_reduce(
      "contact::StillParts::nodes", over(space, num_points),
      KOKKOS_LAMBDA(const std::int64_t i, std::int64_t& moving) {
        bool is_still = true;
        for (int d = 0; d < 3; ++d) {
          const double x = surface.coordinates_new(i, d);
          is_still &= sameBits(x, last(i, d)) & sameBits(x, surface.coordinates_old(i, d));
        }
        if (!is_still)
          for (int d = 0; d < 3; ++d)
            last(i, d) = surface.coordinates_new(i, d);
        nodes(i) = is_still;
        moving += !is_still;
      },
      num_moving);
  _is_unchanged = _is_all_still && num_moving == 0 && !has_grown;
  _is_all_still = num_moving == 0;
  if (_is_unchanged)
    return; // all flags are set
  Kokkos::parallel_for(
      "contact::StillParts::faces", over(space, surface.num_faces),
      KOKKOS_LAMBDA(const std::int64_t face) {
        unsigned all = 1;
        for (int j = 0; j < 4; ++j)
          all &= nodes(surface.face_to_nodes(face, j));
        faces(face) = static_cast<unsigned char>(all);
        if (num_points + face < surface.num_nodes)
          nodes(num_points + face) = static_cast<unsigned char>(all);
      });
}

} // namespace brickwall::contact
