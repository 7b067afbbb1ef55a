// A face that is touched, and what faces are tested for: between SelectInteractions and what knows the geometry, NodeFaceKinematics or
// EdgeEdgeKinematics.
#pragma once

#include "contact/enforcement/law/persistent_contact.hpp"

namespace brickwall::contact {

// A face that a node or an edge penetrates. No default values: arrays of it are not initialised.
struct FaceContact {
  double weight[4];
  double normal[3];
  double place[2]; // of a node: xi, eta on the face; of an edge: share of its second node
  double depth; // P
  Vec3 motion; // of the node in this step as seen from the face point
  double contact_work; // energy that the last force put into the contact with the same body
  double
      closing_before; // motion of this step along the last normal, at the point where that force acted
  int face; // candidate index
  int previous; // interaction with the same body at the last step, or -1
  int previous_face; // candidate index of that interaction's face, or -1
  const PersistentContact*
      known; // what is known of the contact with that face; null where the hit is another
  bool is_held; // ContactTest::retain: until it has no load, or its edges cross again
  bool is_loaded;
  bool has_ended; // that interaction: its node is outside the face again

  KOKKOS_INLINE_FUNCTION Vec3 unitNormal() const { return {normal[0], normal[1], normal[2]}; }
};

// What a face is tested for: to keep a contact, to bear one (or to go on with it there as if it were born), or, if no face is
// fit for that, to go on with a contact under load where the surfaces are turned towards each other no more than a little; or, if
// there is none, to hold on to the last one: between faces or edges that are bent away from each other is a wedge that neither
// covers.
enum class ContactTest { persist, activate, transfer, retain };

} // namespace brickwall::contact
