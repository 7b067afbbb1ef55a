// Bounds on the motion that keeps a node and a face, or two edges, out of contact; eqs. (33) and
// (34) of theory.md. Point-wise.
//
// Let nodes of one body have moved by w with respect to those of the other, and let any two nodes
// of one body have moved by no more than s with respect to each other. A unit vector v/|v| turns by
// 2 |dv|/|v| at most. An area vector a = (d1 x d2)/2 changes by no more than (s (|d1| + |d2|) +
// s^2)/2, so that its direction turns by 1.25 s (|d1| + |d2|)/|a| as long as 4 s <= |d1| + |d2|. A
// gap g = n . (x - c), with n turning at the rate r per s, is then at least
//     g + n . w - r s (|x - c| + |w|).
#pragma once

#include "contact/enforcement/dormancy/surface_motion.hpp"
#include "contact/surface/projection.hpp"

namespace brickwall::contact {

// Bound on the rotation of a direction as its body rotates or deforms: rate per length of s, valid
// for s up to `limit`.
struct TurnRate {
  double rate = 0, limit = HUGE_VAL;

  KOKKOS_INLINE_FUNCTION static TurnRate ofFace(const Quad& quad) {
    const Vec3 one = quad.corner[2] - quad.corner[0], other = quad.corner[3] - quad.corner[1];
    const double lengths = norm(one) + norm(other), area = norm(0.5 * cross(one, other));
    if (!(area > 0)) // the direction is undefined
      return {HUGE_VAL, 0};
    return {1.25 * lengths / area, 0.25 * lengths};
  }
  KOKKOS_INLINE_FUNCTION void include(const TurnRate& b) {
    rate = maxOf(rate, b.rate);
    limit = minOf(limit, b.limit);
  }
  // The largest s for which the direction turns by no more than `turn`.
  KOKKOS_INLINE_FUNCTION double maxSpread(double turn) const {
    return rate > 0 ? minOf(limit, turn / rate) : limit;
  }
};

// Bound of a pair: none (max_spread 0), one on directions only (infinite gap), or one on a gap.
struct Separation {
  double max_spread = 0; // the bound holds while s is less, length
  double gap = HUGE_VAL; // g, length
  Vec3 normal; // n: the motion -n . w closes the gap
  double arm = 0; // loss of gap per length of s
  double arm_by_motion = 0; // loss of gap per length of s and length of w

  KOKKOS_INLINE_FUNCTION bool holds() const { return max_spread > 0 && gap > 0; }
};

// Envelope of the bounds of all pairs of a block of rows between two bodies, as of the step in
// which they were found. It holds only while both bodies are at rest if max_spread is 0, as of
// pairs that have no bound, such as those of flush bodies.
struct SeparationBound {
  static constexpr float tiny = 2.5e-7f; // relative, more than the rounding to a float
  static constexpr double safety = 1 + 1e-6; // for the rounding of all values stored here

  int body[2]; // places in BodyMotions; w is the motion of the first with respect to the second
  float max_spread, gap, arm, arm_by_motion;
  float max_normal[6]; // largest components of n for w downwards (xyz), of -n for w upwards (xyz)
  // w when the bound was found: low xyz rounded up, high xyz rounded down
  float reference_motion[6];

  KOKKOS_INLINE_FUNCTION void start(const BodyMotions& motions, int first, int second) {
    body[0] = first;
    body[1] = second;
    max_spread = gap = HUGE_VALF;
    arm = arm_by_motion = 0;
    for (int d = 0; d < 3; ++d) {
      max_normal[d] = max_normal[3 + d] = 0;
      const float low = static_cast<float>(motions.low(first, second, d));
      const float high = static_cast<float>(motions.high(first, second, d));
      reference_motion[d] = low + tiny * std::fabs(low);
      reference_motion[3 + d] = high - tiny * std::fabs(high);
    }
  }
  // `side` 1: the node belongs to the first body; -1: to the second.
  KOKKOS_INLINE_FUNCTION void include(const Separation& pair, int side) {
    max_spread = minOf(max_spread, static_cast<float>(pair.max_spread));
    if (!(pair.gap < HUGE_VAL))
      return;
    gap = minOf(gap, static_cast<float>(pair.gap));
    arm = maxOf(arm, static_cast<float>(pair.arm));
    arm_by_motion = maxOf(arm_by_motion, static_cast<float>(pair.arm_by_motion));
    for (int d = 0; d < 3; ++d) {
      const auto n = static_cast<float>(side * pair.normal[d]);
      max_normal[d] = maxOf(max_normal[d], n); // closes as w decreases
      max_normal[3 + d] = maxOf(max_normal[3 + d], -n);
    }
  }
  // Whether all pairs are still surely apart.
  KOKKOS_INLINE_FUNCTION bool holds(const BodyMotions& motions, double rounding) const {
    if (max_spread == 0)
      return motions.is_at_rest(body[0]) && motions.is_at_rest(body[1]);
    double spread = 0, closing = 0, motion = 0;
    for (int d = 0; d < 3; ++d) {
      const double low = motions.low(body[0], body[1], d) - reference_motion[d];
      const double high = motions.high(body[0], body[1], d) - reference_motion[3 + d];
      spread += high - low;
      closing += max_normal[d] * maxOf(-low, 0.0) + max_normal[3 + d] * maxOf(high, 0.0);
      motion += maxOf(-low, high);
    }
    return safety * spread < max_spread &&
           safety * (closing + spread * (arm + arm_by_motion * motion) + rounding) < gap;
  }
};

} // namespace brickwall::contact
