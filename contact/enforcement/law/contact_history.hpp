// The contact history: what a contact of a node (or edge) with an opposing side carries from step
// to step. One interaction per (owned node or edge, side), in rows by node. Arrays of plain
// structs, so that a restart file can hold them. Symbols are those of contact/theory.md.
#pragma once

#include "contact/base/struct_array.hpp"
#include "contact/base/vec3.hpp"
#include "contact/surface/contact_point.hpp"

#include <cfloat>

namespace brickwall::contact {

// One node (or edge) against one side of a body. P is the penetration, n the outward normal of the
// face.
struct Interaction {
  global_id side = -1; // opposing side (surface.hpp), or line of edges
  global_id face = -1; // global id of the face in contact
  double offset = 0; // e, length: part of the penetration that gives no force; eq. (9)
  double depth = 0; // p = P - e, length: deformation of the spring
  // k, force/length: as at activation, reduced where the cap falls below it; eqs. (11) to (13)
  double stiffness = 0;
  // w, 0 to 1: fade weight; below 1 beyond true edges and beyond the ends of edges; eq. (24)
  double fade_weight = 1;
  double stored = 0; // U, energy: work done on this contact since its activation
  double force = 0; // F, force: normal force of the spring as applied in the last step
  double damping = 0; // F_d, force: normal damping force; F + F_d >= 0
  // d-, length: normal approach of the pair in the step that led to the last force
  double closing = 0;
  Vec3 normal; // n in that step
  double weight[4] = {0, 0, 0, 0}; // N_j in that step
  double first_force = 0; // F0 = k w p in that step, before the energy-neutral corrections
  ContactPoint point; // in that step; local node numbers
  // 1: an edge contact that continues at fixed points (ContactTest::retain), or releases()
  int is_retained = 0;

  bool is_new = true; // activated in that step
  bool settles = false; // damped as a sliding contact that returned; eq. (41)
  int node = -1; // surface node (or number of the edge) whose row this is
  int face_index = -1; // own face below num_faces, otherwise ghost face index - num_faces

  // Of the current step only.
  double first_damping = 0; // F_d before the corrections
  double inverse_mass = 0; // 1/m_s + sum N_j^2/m_j, 1/mass

  // Whether the contact returns all that it stores, whatever its motion: then e is the least finite
  // number, so that neutralForce() finds that no force keeps it from ending.
  static constexpr double releasing_offset = -DBL_MAX;
  KOKKOS_INLINE_FUNCTION bool releases() const { return offset == releasing_offset; }
};
static_assert(sizeof(Interaction) == 3 * 64, "as many cache lines as needed, and no more");

// Coulomb friction of an interaction: an elastic spring in the tangential plane that slips at mu
// F_n; eq. (21).
//
// The node and the face point are P apart, so that t on one and -t on the other exert the couple P
// n x t. Normal forces -(q_xi N_j,xi + q_eta N_j,eta) on the face's corners balance it, with q =
// lever . t; in edge-to-edge contact the ends of both edges carry them; eq. (22).
struct FrictionSpring {
  Vec3 force; // t, force on the node
  Vec3 trial; // t of a sticking contact, in the current step
  Vec3 motion; // tangential motion of the node in the step that led to t, length
  double stiffness = 0; // k_t, force/length
  Vec3 lever[2]; // P times the dual basis of the face (or of both edges)
};

// Normal forces on single nodes of a pair; their sum is zero.
struct NormalForces {
  double on_corner[4] = {0, 0, 0, 0}; // on the face's corners
  double on_end = 0; // on the second node of the pushing point; the first node takes the opposite
  KOKKOS_INLINE_FUNCTION void add(const NormalForces& b) {
    for (int j = 0; j < 4; ++j)
      on_corner[j] += b.on_corner[j];
    on_end += b.on_end;
  }
};

// The lateral force of a contact that fades out beyond an edge; eq. (26), edge_fading.hpp.
struct FadingForce {
  Vec3 on_node; // each corner takes -N_j of it
  NormalForces normal; // in addition, along the normal
  double work = 0; // work on the bodies over the motion of the step that led to this force, energy
  double factor = 1; // product of all factors that the corrections have applied
  double work_to_end = 0; // work of this force until w = 0 and the contact ends, energy

  // Power (or work) for these velocities (or motions): `relative`, of the pushing point with
  // respect to the face point; `of_corner`; and `of_ends`, of the pushing point's second node minus
  // that of the first.
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

// Rows by surface node. The order of the rows in `interactions` is arbitrary; within a row, sides
// ascend.
struct ContactHistory {
  StructArray<Interaction> interactions; // [0, count); the array may be longer
  StructArray<FrictionSpring> friction; // [as interactions]; empty without friction
  StructArray<FadingForce> fading; // [as interactions]; valid where fade_weight < 1
  View<int*> row_begin; // [node]
  View<int*> row_count; // [node]
  std::int64_t count = 0;
};

} // namespace brickwall::contact
