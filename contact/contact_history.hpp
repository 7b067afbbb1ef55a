// What the contact of a node with an opposing body remembers from step to step: one interaction per
// (owned node, body), in rows by node. Plain Views of plain structs, so that a restart file can
// hold them.
#pragma once

#include "contact/base/vec3.hpp"

namespace brickwall::contact {

// Most bodies that one node can touch at once; more are counted and reported.
constexpr int max_interactions = 8;

// One node against one body. Symbols as in shared/contact_energy.md.
struct Interaction {
  global_id body = -1; // opposing body
  global_id face = -1; // face id touched
  double offset = 0; // e, length: penetration that was there when the contact was born or switched
  double depth = 0; // p = P - e, length: what the spring feels
  double stiffness = 0; // k, force/length: of the birth, lowered where the cap falls below it
  double stored = 0; // U, energy: work done on this contact since its birth
  double force = 0; // F, force: along the normal, as applied at the last step
  double closing = 0; // d-, length: closing motion of the step that led to the last force
  Vec3 normal; // of that step
  double weight[4] = {0, 0, 0, 0}; // N_j of that step

  // Of the current step only.
  double first_force = 0; // F0 = k p
  double mobility = 0; // tau = dt^2 (1/m_s + sum N_j^2/m_j), length/force
  int node = -1; // surface node
  int face_index = -1; // own face below num_faces, else ghost face index - num_faces
  int is_new = 1; // born now, or p was 0 at the last step
};

// Rows by surface node; a row's place in `interactions` follows no order, its contents do:
// ascending body.
struct ContactHistory {
  View<Interaction*> interactions; // [0, count); the View may be longer
  View<int*> row_begin; // [node]
  View<unsigned char*> row_count; // [node]
  std::int64_t count = 0;
};

} // namespace brickwall::contact
