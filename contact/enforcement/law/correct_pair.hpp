// The energy-neutral correction of one interaction from the accelerations by the present forces;
// eqs. (17) to (19) and (28).
#pragma once

#include "contact/enforcement/law/coulomb_friction.hpp"
#include "contact/enforcement/law/energy_neutral.hpp"
#include "contact/surface/face_access.hpp"

namespace brickwall::contact {

struct CorrectPair {
  FaceAccess faces;
  View<const double* [12]> ghost_accelerations;
  View<const double* [3]> accelerations;
  double dt, next_dt; // lengths of the drifts before and after the kick, time
  double friction_limit; // mu
  double relaxation; // share of the computed change that is applied

  struct Correction {
    double force, damping;
    Vec3 friction;
    double fading = 1; // factor of the fading force
    bool has_friction = false;
    KOKKOS_INLINE_FUNCTION bool changes(const Interaction& pair) const {
      return has_friction || force != pair.force || damping != pair.damping || fading != 1;
    }
  };

  KOKKOS_INLINE_FUNCTION Correction correctionOf(const ContactHistory& pairs,
                                                 std::int64_t i) const {
    const Interaction& pair = pairs.interactions(i);
    const double kick = 0.5 * (dt + next_dt);
    const Vec3 relative = relativeAcceleration(pair);
    KickedPair motion = kicked(pair.closing, pair.inverse_mass, dot(pair.normal, relative));
    Correction corrected;
    corrected.force = relaxed(pair.force, neutralForce(springOf(pair), motion));
    corrected.damping = maxOf(pair.first_damping, -corrected.force);
    if (friction_limit > 0) {
      const FrictionSpring& spring = pairs.friction(i);
      corrected.friction =
          returnMap(spring.trial, friction_limit * (corrected.force + corrected.damping));
      const Vec3 change = corrected.friction - spring.force;
      corrected.has_friction = change.x != 0 || change.y != 0 || change.z != 0;
    }
    if (pair.fade_weight < 1) {
      motion.next_closing += (pair.force - corrected.force) * motion.mobility;
      const FadingForce& fading = pairs.fading(i);
      KickedFading kicked;
      kicked.before = kick / dt * fading.work;
      kicked.after = kicked.before + kick * kick * power(fading, pair, relative);
      kicked.gain = motion.mobility * dot(fading.on_node, fading.on_node);
      kicked.next_drift = motion.next_drift;
      corrected.fading =
          relaxed(1.0, neutralFading(pair, corrected.force, motion, kicked, fading.work_to_end));
    }
    return corrected;
  }
  KOKKOS_INLINE_FUNCTION void apply(const Correction& corrected, const ContactHistory& pairs,
                                    std::int64_t i) const {
    pairs.interactions(i).force = corrected.force;
    pairs.interactions(i).damping = corrected.damping;
    if (friction_limit > 0)
      pairs.friction(i).force = corrected.friction;
    if (corrected.fading != 1)
      pairs.fading(i).correct(corrected.fading);
  }

  template <class Real>
  KOKKOS_INLINE_FUNCTION Real relaxed(const Real& present, const Real& target) const {
    return relaxation < 1 ? present + relaxation * (target - present) : target;
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

  // Of the pushing point with respect to the face point.
  KOKKOS_INLINE_FUNCTION Vec3 relativeAcceleration(const Interaction& pair) const {
    const double share = pair.point.share;
    Vec3 relative = rowOf(accelerations, pair.point.node[0]);
    if (!pair.point.isNode())
      relative = (1 - share) * relative + share * rowOf(accelerations, pair.point.node[1]);
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
                        rowOf(accelerations, pair.point.node[1]) -
                            rowOf(accelerations, pair.point.node[0]));
  }
  KOKKOS_INLINE_FUNCTION Vec3 ofCorner(const Interaction& pair, int j) const {
    return faces.corner(pair.face_index, j, accelerations, ghost_accelerations);
  }
};

} // namespace brickwall::contact
