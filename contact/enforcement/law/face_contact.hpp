// A face that a node (or edge) penetrates, as the kinematics report it to the selection and to the
// contact law, and the tests that a pair is put to.
#pragma once

#include "contact/enforcement/law/persistent_contact.hpp"

namespace brickwall::contact {

// No default values: arrays of these are not initialised.

// The point of a face that is penetrated.
struct PenetratedPoint {
  double weight[4];
  double normal[3];
  double place[2]; // of a node: xi, eta on the face; of an edge: weight of its second node
  double depth; // P, length
};

struct FaceContact : PenetratedPoint {
  // Found by the tests of Kinematics, with the point
  int face; // candidate index
  bool is_retained; // see Interaction

  // The contact with the same side in the contact history
  int previous; // index of the interaction, or -1
  int previous_face; // candidate index of its face, or -1
  // data of the persistent contact; null if `face` is another face
  const PersistentContact* persistent;
  double contact_work; // work of its last force on the contact, energy
  // approach of this step along the last normal, at the points where the last force acted
  double closing_at_last_point;
  bool has_ended; // its node is in front of the face again
  bool releases; // see Interaction
  bool is_persistent; // it continues under load; all other contacts become active in this step
  bool is_compressive; // it has a force
  bool settles; // see Interaction

  // Of contacts that are selected
  Vec3 motion; // of the pushing point in this step with respect to the face point, length
  double inverse_mass; // 1/m_s + sum N_j^2/m_j, 1/mass
  double activation_stiffness; // k if the contact becomes active, force/length
  ContactPoint point; // that pushes
  int node; // node (or number of the edge) whose row this is

  KOKKOS_INLINE_FUNCTION Vec3 unitNormal() const { return {normal[0], normal[1], normal[2]}; }
  // Whether it slides faster than it approaches.
  KOKKOS_INLINE_FUNCTION bool slides() const {
    const double along = dot(unitNormal(), motion);
    return dot(motion, motion) > 2 * along * along;
  }
  // Whether the contact continues on another face, or at other points, than `last`.
  KOKKOS_INLINE_FUNCTION bool hasChangedFace(const Interaction& last) const {
    return face != previous_face || last.releases() || (last.is_retained && !is_retained);
  }
};

// The tests of a pair:
//   persist   to continue the contact on the same face
//   activate  to become active, or to take over the spring of a contact with the same side
//   transfer  to take over the spring of a loaded contact where no face passes `activate`: the
//             surfaces need to oppose each other only a little
//   retain    to continue a loaded contact where no face passes `transfer`: a node or edge in the
//             wedge between two faces or edges that are bent away from each other is covered by
//             neither
//   release   to return the energy of a loaded contact that ends otherwise than through its face
enum class ContactTest { persist, activate, transfer, retain, release };
KOKKOS_INLINE_FUNCTION constexpr unsigned bitOf(ContactTest kind) {
  return 1u << static_cast<int>(kind);
}

} // namespace brickwall::contact
