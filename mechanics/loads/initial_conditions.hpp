// Initial velocities and displacements: an affine field of the reference position on the nodes of
// chosen elements.
#pragma once

#include "contact/base/vec3.hpp"
#include "mechanics/mesh/hex_mesh.hpp"
#include "mechanics/mesh/shared_node_sum.hpp"

#include <vector>

namespace brickwall::mechanics {

// value + gradient (X - center)
struct AffineField {
  Vec3 value;
  Mat3 gradient;
  Vec3 center; // length
  KOKKOS_INLINE_FUNCTION Vec3 at(const Vec3& X) const { return value + gradient * (X - center); }
};

// velocity + angular_velocity x (X - center), the velocity of a rigid motion.
AffineField rigidVelocity(const Vec3& velocity, const Vec3& angular_velocity = {},
                          const Vec3& center = {});

// Sets target(node, :) to field.at(X) on all nodes of the elements chosen on this rank or, at
// shared nodes, on another rank (elem_is_chosen [num_elems], host). The value depends on the node's
// X alone, so sharers get the same bits. Collective.
void setInitialField(const exec_space& space, const HexMesh& mesh, SharedNodeSum& shared,
                     const std::vector<unsigned char>& elem_is_chosen, const AffineField& field,
                     const View<double* [3]>& target);

} // namespace brickwall::mechanics
