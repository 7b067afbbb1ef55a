// The contract of `Kinematics`, the template parameter of the selection (select_interactions.hpp).
// NodeFaceKinematics and EdgeEdgeKinematics fulfil it. They know the geometry of a pair; the law
// and the selection know none. To add a kind of contact, write a third type and instantiate
// KinematicsContract with it.
//
// "Node" is a row of the candidate lists: a surface node, or the number that stands for an edge.
// "Face" is a candidate index (FaceAccess): a face or, in edge-to-edge contact, an edge. All
// functions are const and callable in kernels. Equations are those of contact/theory.md.
//
// Constants
//   records_spring_work           works of springs are summed as ContactTerm::spring_work
//   projects_persistent_contacts  projectPersistent() fills PersistentContact completely
//   projects_candidates_at_once   test() in two parts, isFacing() and testPoint(), with up to
//                                 candidates_at_once points of projectCandidates() between them
//   tests_rows_at_once            rows are rejected by rowsThatMayActivate() instead of
//                                 mayPenetrate() and mayActivate(); passedTests() is not needed
//
// Identity
//   sideOf(faces, face)           side of a body of a candidate (surface.hpp), or line of edges
//   idOf(faces, face)             global id of a candidate
//   pushes(own_body, body)        whether a row of own_body tests candidates of body
//   pointOf(faces, node, contact) pushing point: its nodes and the weight of the second one
//
// Contact tests at x^{n+1}
//   test(faces, node, face, kind, contact)
//       whether the pair is in contact by ContactTest `kind`, activate or transfer; if so, fills
//       weight, normal (unit), place, depth (length, > 0), face and is_retained of `contact`
//   passedTests(faces, node, face, contact)
//       the kinds of test(), as bits (bitOf()), that the pair passes; fills `contact` as test()
//       does, in whose place devices use it
//   projectPersistent(faces, history, count, contacts)
//       fills the data of contacts whose face is still a candidate
//   testPersistent(faces, persistent, kind, contact)
//       the same with the contact's own face, from these data, by kind persist, retain or release;
//       at release the depth may be <= 0. Where projects_persistent_contacts, it is at persist
//       acceptPersistent(faces, persistent, contact) && isOpposing(node, face, persist)
//   isBeyondInnerEdge(faces, contact)
//       whether the node is beyond an edge where the body's surface continues
//   hasLeftThrough(faces, node, face, contact)
//       whether the node is in front of `face`, which continues the surface of the contact's face
//   isInFront(faces, face, point)
//       whether a node that projects onto the face at `point` is in front of it: gap >= 0, within
//       its edges
//
// Quick rejection: false only if test() at ContactTest::activate is false for all pairs
//   mayPenetrate(faces, node, face)   by position
//   mayActivate(node, face)           by orientation
//   rowsThatMayActivate(faces, pairs, rows, count, requested)
//                                     a bit for each row, for the requested ones
//
// Mechanics
//   inverseMass(point)            1/m_s of the pushing point, 1/mass
//   stiffnessAtActivation(config, faces, contact, contacts, count)
//                                 k, force/length, of one of the contacts of a node; eq. (11)
//   stiffnessCap(config, inverse_mass)
//                                 upper bound of k, force/length; eq. (12); also in SIMD lanes
//   capFactor(node, face)         factor of this bound for the contact of a node with a face's side
//   mayFade(contact)              false only if w is 1
//   fadeWeightOf(faces, node, contact)
//                                 w in [0, 1]; eq. (24)
//   fade(config, faces, contact, pair, fading)
//                                 sets w, multiplies the normal force, fills the fading force; eq.
//                                 (26)
//   findTangents(faces, pair, face, tangent, motion)
//                                 derivatives of the position by the two parameters of the face, or
//                                 along both edges, and their changes in this step, length
//   relativeDepth(faces, contact) penetration over the size of the face or edge
//   record(node, count, deepest)  stores the number of contacts and the largest penetration of the
//                                 node
//
// Prefetching, without effect on results
//   prefetchHead(node), prefetchNode(node), prefetchFace(face), prefetchSide(faces, face)
//
// Dormancy needs two free functions: surroundingsOf(kinematics, faces, node) and
// separationOf(kinematics, faces, surroundings, node, face); see node_face_separation.hpp and
// edge_separation.hpp.
#pragma once

#include "contact/enforcement/law/contact_history.hpp"
#include "contact/enforcement/law/enforcement_config.hpp"
#include "contact/enforcement/law/face_contact.hpp"
#include "contact/surface/face_access.hpp"

#include <type_traits>

namespace brickwall::contact {

// Instantiating it compiles only if `K` has the members of the contract, with these results.
template <class K>
struct KinematicsContract {
  // Stand-ins for arguments; not defined.
  static const K& k();
  static const FaceAccess& faces();
  static const EnforcementConfig& config();
  static const ContactHistory& history();
  static const PersistentContact& persistent();
  static PersistentContact* persistents();
  static FaceContact& contact();
  static Interaction& pair();
  static FadingForce& fading();
  static Vec3 (&vectors())[2];
  static constexpr ContactTest activate = ContactTest::activate;
  template <class Found, class Needed>
  static constexpr bool is = std::is_same<Found, Needed>::value;

  static_assert(is<decltype(K::records_spring_work), const bool>);
  static_assert(is<decltype(K::projects_persistent_contacts), const bool>);
  static_assert(is<decltype(K::projects_candidates_at_once), const bool>);
  static_assert(is<decltype(K::tests_rows_at_once), const bool>);
  static_assert(is<decltype(k().sideOf(faces(), 0)), global_id>);
  static_assert(is<decltype(k().idOf(faces(), 0)), global_id>);
  static_assert(is<decltype(k().pushes(global_id(), global_id())), bool>);
  static_assert(is<decltype(k().pointOf(faces(), 0, contact())), ContactPoint>);
  static_assert(is<decltype(k().test(faces(), 0, 0, activate, contact())), bool>);
  static_assert(is<decltype(k().projectPersistent(faces(), history(), 0, persistents())), void>);
  static_assert(is<decltype(k().testPersistent(faces(), persistent(), activate, contact())), bool>);
  static_assert(is<decltype(k().isBeyondInnerEdge(faces(), contact())), bool>);
  static_assert(is<decltype(k().hasLeftThrough(faces(), 0, 0, contact())), bool>);
  static_assert(is<decltype(k().isInFront(faces(), 0, FacePoint())), bool>);
  static_assert(is<decltype(k().inverseMass(ContactPoint())), double>);
  static_assert(
      is<decltype(k().stiffnessAtActivation(config(), faces(), contact(), &contact(), 1)), double>);
  static_assert(is<decltype(k().stiffnessCap(config(), 1.0)), double>);
  static_assert(is<decltype(k().stiffnessCap(config(), Lanes())), Lanes>);
  static_assert(is<decltype(k().capFactor(0, 0)), double>);
  static_assert(is<decltype(k().mayFade(contact())), bool>);
  static_assert(is<decltype(k().fadeWeightOf(faces(), 0, contact())), double>);
  static_assert(is<decltype(k().fade(config(), faces(), contact(), pair(), fading())), void>);
  static_assert(is<decltype(k().findTangents(faces(), pair(), 0, vectors(), vectors())), void>);
  static_assert(is<decltype(k().relativeDepth(faces(), contact())), double>);
  static_assert(is<decltype(k().record(0, 1, 0.0)), void>);
};

} // namespace brickwall::contact
