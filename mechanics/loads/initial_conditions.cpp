#include "mechanics/loads/initial_conditions.hpp"

#include "mechanics/mesh/host_mesh.hpp"

namespace brickwall::mechanics {

AffineField rigidVelocity(const Vec3& velocity, const Vec3& angular_velocity, const Vec3& center) {
  AffineField field;
  const Vec3& w = angular_velocity;
  field.value = velocity;
  field.gradient(0, 1) = -w.z, field.gradient(0, 2) = w.y;
  field.gradient(1, 0) = w.z, field.gradient(1, 2) = -w.x;
  field.gradient(2, 0) = -w.y, field.gradient(2, 1) = w.x;
  field.center = center;
  return field;
}

void setInitialField(const exec_space& space, const HexMesh& mesh, SharedNodeSum& shared,
                     const std::vector<unsigned char>& elem_is_chosen, const AffineField& field,
                     const View<double* [3]>& target) {
  const auto chosen = toDevice(space, "mechanics::setInitialField::elem_is_chosen", elem_is_chosen);
  const auto elem_to_nodes = mesh.elem_to_nodes;
  View<std::int64_t**> touches("mechanics::setInitialField::touches", mesh.num_nodes, 1);
  Kokkos::parallel_for(
      "mechanics::setInitialField::mark", rangePolicy(space, mesh.num_elems),
      KOKKOS_LAMBDA(const std::int64_t elem) {
        if (chosen(elem))
          for (int c = 0; c < 8; ++c)
            Kokkos::atomic_add(&touches(elem_to_nodes(elem, c), 0), std::int64_t(1));
      });
  shared.sum(space, touches);
  const View<const double* [3]> X = mesh.reference_coordinates;
  Kokkos::parallel_for(
      "mechanics::setInitialField::set", rangePolicy(space, mesh.num_nodes),
      KOKKOS_LAMBDA(const std::int64_t node) {
        if (touches(node, 0) == 0)
          return;
        const Vec3 value = field.at(rowOf(X, node));
        for (int i = 0; i < 3; ++i)
          target(node, i) = value[i];
      });
  space.fence();
}

} // namespace brickwall::mechanics
