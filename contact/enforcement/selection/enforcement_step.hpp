// The data of one kind of contact (node-to-face or edge-to-edge) in a step, which its kernels
// share, and the works of the last step's forces.
//
// `Kinematics` provides the geometry; its contract is in kinematics.hpp.
#pragma once

#include "contact/base/lanes.hpp"
#include "contact/enforcement/law/contact_law.hpp"
#include "contact/enforcement/law/contact_sums.hpp"
#include "contact/enforcement/law/face_contact.hpp"
#include "contact/enforcement/law/pair_forces.hpp"
#include "contact/enforcement/selection/steady_rows.hpp"

namespace brickwall::contact {

// Memory for the contacts of crowded rows, which have more sides than the local arrays of a thread
// hold.
struct RowWorkspace {
  View<PersistentContact*> persistent; // [place]
  View<FaceContact*> contacts; // [place]
  View<std::int64_t> num_reserved; // places; beyond the extent if there are too few

  // Reserves consecutive places. Returns the first one, or -1 if there are too few.
  KOKKOS_INLINE_FUNCTION std::int64_t reserve(int count) const {
    const std::int64_t first = Kokkos::atomic_fetch_add(num_reserved.data(), std::int64_t(count));
    return first + count <= static_cast<std::int64_t>(contacts.extent(0)) ? first : -1;
  }
};

// A pair that passes ContactTest::activate or transfer.
struct TestedPair {
  PenetratedPoint point;
  std::int64_t passed; // tests, as bitOf(); as wide as the others: compilers then copy whole words
};
// Those of the rows in lists (row_lists.hpp).
struct TestedPairs {
  // [pair] place in `pairs`, or -1 if it passes neither or there is no room; set in these rows only
  View<int*> place;
  View<TestedPair*> pairs; // [place]
  View<std::int64_t> count; // beyond the extent if there are too few places
};

template <class Kinematics>
struct EnforcementStep {
  // Whether `tested` is filled before faces are selected.
  static constexpr bool has_tested_pairs = !fills_lanes && !Kinematics::tests_rows_at_once;

  ContactLaw law;
  LimbScale energy_scale;
  Kinematics kinematics;
  FaceAccess faces = {{}, GhostFaces::none()};
  CandidatePairs pairs = CandidatePairs::none();
  SteadyFlags steady;
  TestedPairs tested;
  ContactHistory previous;
  ContactHistory next; // interactions beyond its extent are counted, not written
  View<std::int64_t> next_count;
  RowWorkspace workspace;
  int number = 0; // of this step
  View<int*> last_contact; // [node] number of the step after its last contact, or 0; with friction
  PairForces add; // accumulates the forces of the interactions written to `next`

  // The work of a fading force over a motion of its pair.
  KOKKOS_INLINE_FUNCTION double workOf(const FadingForce& force, const Vec3& relative_motion,
                                       const Interaction& pair, int face) const {
    Vec3 of_corner[4];
    for (int j = 0; j < 4; ++j)
      of_corner[j] = faces.cornerMotion(face, j);
    return force.times(pair.normal, relative_motion, of_corner,
                       faces.nodeMotion(pair.point.node[1]) - faces.nodeMotion(pair.point.node[0]));
  }

  // Records the work of the last step's forces over the half steps before and after them; this
  // step's motion is the second of these. Returns the work done on the contact's spring, dt F n .
  // (v^{n-1/2} + v^{n+1/2})/2, with its fading part. `closing_now` is the approach of this step
  // along the last normal.
  KOKKOS_INLINE_FUNCTION double recordWork(const PersistentContact& persistent, double closing_now,
                                           ContactSums& sums) const {
    const int index = persistent.previous, last_face = persistent.face;
    const Interaction& last = previous.interactions(index);
    const Vec3& motion = persistent.last_motion;
    const double kick = 0.5 * (law.previous_dt + law.dt);
    const double closing = law.kickClosing(last.closing, closing_now);
    double on_spring = last.force * closing;
    if (last.fade_weight < 1) {
      const FadingForce& fading = previous.fading(index);
      on_spring -=
          kick * 0.5 *
          (fading.work / law.previous_dt + workOf(fading, motion, last, last_face) / law.dt);
    }
    if (Kinematics::records_spring_work)
      sums.terms.add(spring_work, -on_spring, energy_scale);
    if (last.damping != 0)
      sums.terms.add(damping_work, -last.damping * closing, energy_scale);
    if (law.config.friction > 0)
      recordFrictionWork(index, motion, last_face, sums);
    return on_spring;
  }
  // The part of friction: of contact `index` of the history, whose pair moves by `motion`.
  KOKKOS_INLINE_FUNCTION void recordFrictionWork(int index, const Vec3& motion, int last_face,
                                                 ContactSums& sums) const {
    const Interaction& last = previous.interactions(index);
    const FrictionSpring& friction = previous.friction(index);
    Vec3 tangent[2], tangent_motion[2];
    kinematics.findTangents(faces, last, last_face, tangent, tangent_motion);
    const Vec3 slip = slipOf(friction, motion, last.normal, tangent_motion);
    const double kick = 0.5 * (law.previous_dt + law.dt);
    sums.terms.add(friction_work,
                   kick * 0.5 *
                       (dot(friction.force, friction.motion) / law.previous_dt +
                        dot(friction.force, slip) / law.dt),
                   energy_scale);
  }

  // Whether a contact of this node returns: the node had none in the last step, but one shortly
  // before. Without friction it does not matter.
  KOKKOS_INLINE_FUNCTION bool returns(int node) const {
    if (!law.maySettle())
      return false;
    int& last = last_contact(node);
    if (previous.row_count(node) > 0)
      last = number;
    return last > 0 && last < number && number - last <= ContactLaw::settling_steps;
  }

  KOKKOS_INLINE_FUNCTION double inverseMassOf(const FaceContact& contact) const {
    double inverse_mass = kinematics.inverseMass(contact.point);
    for (int j = 0; j < 4; ++j)
      if (contact.weight[j] != 0)
        inverse_mass += contact.weight[j] * contact.weight[j] / faces.cornerMass(contact.face, j);
    return inverse_mass;
  }

  // Slots of `next`; those beyond its extent are not there.
  KOKKOS_INLINE_FUNCTION std::int64_t reserveSlots(int count) const {
    if (!add.is_alone)
      return reservePlaces(next_count.data(), count);
    const std::int64_t first = next_count();
    next_count() = first + count;
    return first;
  }
  KOKKOS_INLINE_FUNCTION bool hasSlots(std::int64_t first, int count) const {
    return first + count <= next.interactions.size();
  }
};

} // namespace brickwall::contact
