// The energy-neutral correction of one interaction from the accelerations by the present forces;
// eqs. (17) to (19) and (28). Contacts that share nodes move each other, so a round takes two
// passes: the first proposes a change of each force as if the others stayed, the second allows for
// the proposals of all, eq. (36).
#pragma once

#include "contact/enforcement/law/contact_law.hpp"
#include "contact/enforcement/law/coulomb_friction.hpp"
#include "contact/enforcement/law/energy_neutral.hpp"
#include "contact/surface/face_access.hpp"

namespace brickwall::contact {

// A vector for each surface node and for each corner of each ghost face.
struct NodeVectors {
  View<const double* [3]> nodes; // [surface node][xyz]
  View<const double* [12]> ghosts; // [ghost face][3 * corner + xyz]
};

struct CorrectPair {
  // Changes smaller than this share of the uncorrected force F0 are not made. Each is worth at most
  // this share of F0 times the approach of the pair over a kick.
  static constexpr double least_change = 1e-4;

  FaceAccess faces;
  NodeVectors accelerations;
  // Accelerations by the magnitudes of all proposed changes; without Views in the first pass.
  NodeVectors responses;
  double dt, next_dt; // lengths of the drifts before and after the kick, time
  double friction_limit; // mu
  double settling_rate; // c/k of contacts that settle, time; eq. (41)
  View<unsigned char*> marks = {}; // [surface node] set to 1 where the pass adds; or empty

  struct Correction {
    double force, damping;
    Vec3 friction;
    double friction_change = 0; // magnitude
    double fading = 1; // factor of the fading force
    KOKKOS_INLINE_FUNCTION bool changes(const Interaction& pair) const {
      return isChange(force - pair.force, pair.first_force) ||
             isChange(damping - pair.damping, pair.first_force) ||
             isChange(friction_change, pair.first_force) || isChange(fading - 1, 1.0);
    }
    // Of the forces that eq. (36) allows for.
    KOKKOS_INLINE_FUNCTION double normalChange(const Interaction& pair) const {
      return std::fabs(force - pair.force) + (pair.settles ? std::fabs(damping - pair.damping) : 0);
    }
  };

  KOKKOS_INLINE_FUNCTION Correction correctionOf(const ContactHistory& pairs,
                                                 std::int64_t i) const {
    const Interaction& pair = pairs.interactions(i);
    const double kick = 0.5 * (dt + next_dt);
    const Vec3 relative = relativeAcceleration(pair);
    const KickedPair present = kicked(pair.closing, pair.inverse_mass, dot(pair.normal, relative));
    KickedPair motion = present;
    Correction corrected;
    correctNormal(pair, motion, corrected);
    if (!isProposal()) {
      motion = present;
      motion.mobility = mobilityOf(corrected.normalChange(pair), responseOf(pair), present);
      correctNormal(pair, motion, corrected);
    }
    if (friction_limit > 0) {
      const FrictionSpring& spring = pairs.friction(i);
      corrected.friction =
          returnMap(spring.trial, friction_limit * (corrected.force + corrected.damping));
      if (endsBy(springOf(pair), motion.next_drift, motion.next_closing))
        corrected.friction =
            shareToReturn(pair, spring, corrected.friction, relative) * corrected.friction;
      corrected.friction_change = norm(corrected.friction - spring.force);
    }
    if (pair.fade_weight < 1) {
      const FadingForce& fading = pairs.fading(i);
      KickedFading kicked;
      kicked.before = kick / dt * fading.work;
      kicked.after = kicked.before + kick * kick * power(fading, pair, relative);
      kicked.gain = motion.mobility * dot(fading.on_node, fading.on_node);
      kicked.next_drift = motion.next_drift;
      corrected.fading = neutralFading(pair, corrected.force, motion, kicked, fading.work_to_end);
    }
    return corrected;
  }
  KOKKOS_INLINE_FUNCTION void apply(const Correction& corrected, const ContactHistory& pairs,
                                    std::int64_t i) const {
    pairs.interactions.setMember(i, &Interaction::force, corrected.force);
    pairs.interactions.setMember(i, &Interaction::damping, corrected.damping);
    if (friction_limit > 0) {
      FrictionSpring spring = pairs.friction(i);
      spring.force = corrected.friction;
      pairs.friction.store(i, spring);
    }
    if (corrected.fading != 1) {
      FadingForce fading = pairs.fading(i);
      fading.correct(corrected.fading);
      pairs.fading.store(i, fading);
    }
  }

  // Marks the nodes of a pair with an own face.
  KOKKOS_FORCEINLINE_FUNCTION void mark(const Interaction& pair) const {
    if (marks.extent(0) == 0 || !faces.isOwn(pair.face_index))
      return;
    const unsigned char set = 1;
    forEachNodeOf(pair.point, pair.face_index, faces.surface,
                  [&](int node) { storeShared(marks(node), set); });
  }
  KOKKOS_FORCEINLINE_FUNCTION static bool isChange(double change, double of) {
    return !(std::fabs(change) <= least_change * std::fabs(of)); // also if it is NaN
  }
  KOKKOS_INLINE_FUNCTION bool isProposal() const { return responses.nodes.data() == nullptr; }

  // tau' of a contact that proposes `change`; eq. (36).
  template <class Real>
  KOKKOS_INLINE_FUNCTION Real mobilityOf(const Real& change, const Real& response,
                                         const KickedPairOf<Real>& motion) const {
    const double kick = 0.5 * (dt + next_dt);
    const Real none = 0.0;
    const Real mobility = kick * kick * response / where(change > none, change, Real(1.0));
    return where(change > none, maxOf(motion.mobility, mobility), motion.mobility);
  }
  // F' and F_d, and in `motion` the approach after the kick with them.
  KOKKOS_INLINE_FUNCTION void correctNormal(const Interaction& pair, KickedPair& motion,
                                            Correction& corrected) const {
    const double force = neutralForce(springOf(pair), motion);
    corrected.force = force;
    corrected.damping = pair.first_damping;
    motion.next_closing += (pair.force - force) * motion.mobility;
    if (pair.settles && pair.depth > 0) {
      const double c = settling_rate * pair.stiffness * pair.fade_weight;
      corrected.damping = meanDamping(pair.damping, c / (0.5 * (dt + next_dt)), motion);
    }
    corrected.damping = maxOf(corrected.damping, -force);
    if (pair.settles)
      motion.next_closing += (pair.damping - corrected.damping) * motion.mobility;
  }
  // `acceleration`: normal component, of the pushing point with respect to the face point.
  template <class Real>
  KOKKOS_INLINE_FUNCTION KickedPairOf<Real> kicked(const Real& closing, const Real& inverse_mass,
                                                   const Real& acceleration) const {
    const double kick = 0.5 * (dt + next_dt);
    KickedPairOf<Real> motion;
    motion.closing = kick / dt * closing;
    motion.next_closing = motion.closing - kick * kick * acceleration;
    motion.next_drift = next_dt / kick;
    motion.mobility = kick * kick * inverse_mass;
    return motion;
  }

  // The share of the friction of a contact that ends with which it returns no more than its spring
  // stores, as neutralForce() lets the normal force do; eq. (45).
  KOKKOS_INLINE_FUNCTION double shareToReturn(const Interaction& pair, const FrictionSpring& spring,
                                              const Vec3& friction, const Vec3& relative) const {
    if (!(spring.stiffness > 0))
      return 1;
    const double kick = 0.5 * (dt + next_dt), gain = kick * kick * pair.inverse_mass;
    // R t^n, but for the turn of the slip, which is of second order
    const Vec3 last = spring.trial + spring.stiffness * spring.motion;
    const Vec3 first =
        returnMap(spring.trial, friction_limit * (pair.first_force + pair.first_damping));
    const double stored = maxOf(0.5 * dot(last, first) / spring.stiffness, 0.0);
    // Twice the motion without this friction, over the kick.
    const Vec3 motion =
        (2 * kick / dt) * spring.motion + (kick * kick) * relative - gain * spring.force;
    const double linear = 0.5 * dot(friction, motion),
                 square = 0.5 * gain * dot(friction, friction);
    if (!(square > 0) || linear + square <= stored)
      return 1;
    return (-linear + std::sqrt(linear * linear + 4 * square * stored)) / (2 * square);
  }

  // By how much all proposed changes together can change the acceleration of the pair along its
  // normal: the row of |G|^T M^-1 |G| |dF| in eq. (36).
  KOKKOS_INLINE_FUNCTION double responseOf(const Interaction& pair) const {
    const double share = pair.point.share;
    Vec3 sum = std::fabs(1 - share) * rowOf(responses.nodes, pair.point.node[0]);
    if (!pair.point.isNode())
      sum += std::fabs(share) * rowOf(responses.nodes, pair.point.node[1]);
    for (int j = 0; j < 4; ++j)
      if (pair.weight[j] != 0)
        sum += std::fabs(pair.weight[j]) *
               faces.corner(pair.face_index, j, responses.nodes, responses.ghosts);
    return std::fabs(pair.normal.x) * sum.x + std::fabs(pair.normal.y) * sum.y +
           std::fabs(pair.normal.z) * sum.z;
  }
  // Of the pushing point with respect to the face point.
  KOKKOS_INLINE_FUNCTION Vec3 relativeAcceleration(const Interaction& pair) const {
    const double share = pair.point.share;
    Vec3 relative = rowOf(accelerations.nodes, pair.point.node[0]);
    if (!pair.point.isNode())
      relative = (1 - share) * relative + share * rowOf(accelerations.nodes, pair.point.node[1]);
    for (int j = 0; j < 4; ++j)
      if (pair.weight[j] != 0)
        relative -= pair.weight[j] * ofCorner(pair, j);
    return relative;
  }
  // The fading force times the accelerations of the points that it acts on.
  KOKKOS_INLINE_FUNCTION double power(const FadingForce& fading, const Interaction& pair,
                                      const Vec3& relative) const {
    Vec3 of_corner[4];
    for (int j = 0; j < 4; ++j)
      of_corner[j] = ofCorner(pair, j);
    return fading.times(pair.normal, relative, of_corner,
                        rowOf(accelerations.nodes, pair.point.node[1]) -
                            rowOf(accelerations.nodes, pair.point.node[0]));
  }
  KOKKOS_INLINE_FUNCTION Vec3 ofCorner(const Interaction& pair, int j) const {
    return faces.corner(pair.face_index, j, accelerations.nodes, accelerations.ghosts);
  }
};

// `responses` without Views in the first pass.
inline CorrectPair correctPair(const EnforcementConfig& config, const FaceAccess& faces,
                               const StepLengths& steps, const NodeVectors& accelerations,
                               const NodeVectors& responses, const View<unsigned char*>& marks) {
  return {faces,
          accelerations,
          responses,
          steps.dt,
          steps.next_dt,
          config.friction,
          ContactLaw{config}.settlingRate(),
          marks};
}

} // namespace brickwall::contact
