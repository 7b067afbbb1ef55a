// What the contact of a node (or of an edge) with an opposing body remembers from step to step: one interaction per (owned
// node or edge, body), in rows by node. Plain Views of plain structs, so that a restart file can hold them.
#pragma once

#include "contact/base/vec3.hpp"
#include "contact/surface/contact_point.hpp"

namespace brickwall::contact {

// Most bodies that one node can touch at once; more are counted and reported.
constexpr int max_interactions = 8;

// One node (or edge) against one body. P is the penetration, n the outward normal of the face.
struct Interaction {
  global_id body = -1; // opposing body
  global_id face = -1; // face id touched
  double offset = 0; // e, length: penetration that was there when the contact was born or switched
  double depth = 0; // p = P - e, length: what the spring feels
  double stiffness = 0; // k, force/length: of the birth, lowered where the cap falls below it
  double fade_weight =
      1; // w, 0 to 1: less than 1 beyond true edges and beyond the ends of crossing ones
  double stored = 0; // U, energy: work done on this contact since its birth
  double force = 0; // F, force: of the spring along the normal, as applied at the last step
  double damping = 0; // F_d, force along the normal; F + F_d >= 0
  double closing = 0; // d-, length: closing motion of the step that led to the last force
  Vec3 normal; // of that step
  double weight[4] = {0, 0, 0, 0}; // N_j of that step
  double first_force = 0; // F0 = k w p of that step, before the corrections
  ContactPoint point; // of that step; its nodes are numbers of this rank
  int is_held =
      0; // 1: an edge that goes on at a fixed point, until it has no load or crosses the other again

  // Of the current step only.
  int is_new = 1; // born in this step
  int node = -1; // surface node whose row this is
  int face_index = -1; // own face below num_faces, else ghost face index - num_faces
  double first_damping = 0; // F_d before the corrections
  double inverse_mass = 0; // 1/m_s + sum N_j^2/m_j
};
static_assert(sizeof(Interaction) == 3 * 64, "as many cache lines as needed, and no more");

// Coulomb friction of an interaction: an elastic spring along the face that slips at mu F_n.
//
// Node and face point stand P apart, so that t on the one and -t on the other would turn the bodies: the couple P n x t. The face
// takes it back by forces along the normal, -(q_xi N_j,xi + q_eta N_j,eta) on corner j with q = (lever . t), the parametric
// components of P t; with edges, both edges do.
struct FrictionSpring {
  Vec3 force; // t, on the node; what the spring holds
  Vec3 trial; // t of a sticking contact, of the current step
  Vec3 motion; // of the node along the face in the step that led to t, length
  double stiffness = 0; // k_t, force/length
  Vec3 lever[2]; // P times the dual basis of the face (or of both edges)
};

// Forces along the normal on single nodes of a pair; their sum is zero.
struct NormalForces {
  double on_corner[4] = {0, 0, 0, 0}; // of the face
  double on_end = 0; // on the second node of the pushing point, and taken from the first
  KOKKOS_INLINE_FUNCTION void add(const NormalForces& b) {
    for (int j = 0; j < 4; ++j)
      on_corner[j] += b.on_corner[j];
    on_end += b.on_end;
  }
};

// Forces of an interaction that are neither along its normal nor friction: see edge_fading.hpp.
struct FadingForce {
  Vec3 on_node; // each corner takes -N_j of it
  NormalForces normal; // besides
  double work = 0; // its work on the bodies over the motion of the step that led to it, energy
  double factor = 1; // by which the corrections have multiplied it
  double work_to_end = 0; // its work until w = 0 and the contact ends, energy

  // With motions (or accelerations) of what it acts on: `relative`, of the pushing point against the face point; of the corners; and
  // of the pushing point's second node less that of the first.
  KOKKOS_INLINE_FUNCTION double times(const Vec3& along, const Vec3& relative,
                                      const Vec3 (&of_corner)[4], const Vec3& of_ends) const {
    double sum = dot(on_node, relative);
    for (int j = 0; j < 4; ++j)
      sum += normal.on_corner[j] * dot(along, of_corner[j]);
    return sum + normal.on_end * dot(along, of_ends);
  }
  KOKKOS_INLINE_FUNCTION void scale(double by) {
    on_node = by * on_node;
    normal.on_end *= by;
    for (int j = 0; j < 4; ++j)
      normal.on_corner[j] *= by;
    work *= by;
    work_to_end *= by;
  }
  KOKKOS_INLINE_FUNCTION void correct(double by) {
    scale(by);
    factor *= by;
  }
};

// Rows by surface node; a row's place in `interactions` follows no order, its contents do: ascending body.
struct ContactHistory {
  View<Interaction*> interactions; // [0, count); the View may be longer
  View<FrictionSpring*> friction; // [as interactions], empty without friction
  View<FadingForce*> fading; // [as interactions], valid where fade_weight < 1
  View<int*> row_begin; // [node]
  View<unsigned char*> row_count; // [node]
  std::int64_t count = 0;

  // Asks for an interaction that will be read soon.
  KOKKOS_FORCEINLINE_FUNCTION void prefetch(std::int64_t i) const {
    const Interaction& pair = interactions(i);
    brickwall::prefetch(&pair.body);
    brickwall::prefetch(&pair.damping);
    brickwall::prefetch(&pair.first_force);
  }
};

} // namespace brickwall::contact
