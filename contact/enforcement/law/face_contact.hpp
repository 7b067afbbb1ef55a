// A face that a node (or edge) penetrates, as the kinematics report it to the selection and to the
// contact law, and the tests that a pair is put to.
#pragma once

#include "contact/enforcement/law/persistent_contact.hpp"

namespace brickwall::contact {

// No default values: arrays of it are not initialised.
struct FaceContact {
  double weight[4];
  double normal[3];
  double place[2]; // of a node: xi, eta on the face; of an edge: weight of its second node
  double depth; // P, length
  Vec3 motion; // of the node in this step with respect to the face point, length
  double contact_work; // work of the last force on the contact with the same body, energy
  // approach of this step along the last normal, at the points where the last force acted
  double closing_at_last_point;
  int face; // candidate index
  int previous; // index of the interaction with the same body in the contact history, or -1
  int previous_face; // candidate index of that interaction's face, or -1
  const PersistentContact*
      persistent; // data of the persistent contact; null if `face` is another face
  bool is_retained; // ContactTest::retain
  bool is_loaded;
  bool has_ended; // that interaction has ended: its node is in front of the face again

  KOKKOS_INLINE_FUNCTION Vec3 unitNormal() const { return {normal[0], normal[1], normal[2]}; }
};

// The tests of a pair:
//   persist   to continue the contact on the same face
//   activate  to become active, or to take over the spring of a contact with the same body
//   transfer  to take over the spring of a loaded contact where no face passes `activate`: the
//             surfaces need to oppose each other only a little
//   retain    to continue a loaded contact where no face passes `transfer`: a node or edge in the
//             wedge between two faces or edges that are bent away from each other is covered by
//             neither
enum class ContactTest { persist, activate, transfer, retain };

} // namespace brickwall::contact
