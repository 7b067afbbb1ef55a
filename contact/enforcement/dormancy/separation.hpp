// Why a node and a face, or two edges, cannot touch, and what motion that stands. Point-wise.
//
// Let nodes of the one body have moved by w against those of the other, and let any two nodes of one body have moved by no more
// than s against each other. A unit vector v/|v| turns by 2 |dv|/|v| at most. An area vector a = (d1 x d2)/2 changes by no more than
// (s (|d1| + |d2|) + s^2)/2, so that its direction turns by 1.25 s (|d1| + |d2|)/|a| as long as 4 s <= |d1| + |d2|.
// A gap g = n . (x - c), n of turning rate r per s, is then no less than
//   g + n . w - r s (|x - c| + |w|).
#pragma once

#include "contact/enforcement/dormancy/surface_motion.hpp"
#include "contact/surface/projection.hpp"

namespace brickwall::contact {

// How fast a direction turns as its body is bent or turned, per length of s, for s up to `limit`.
struct TurnRate {
  double rate = 0, limit = HUGE_VAL;

  KOKKOS_INLINE_FUNCTION static TurnRate ofFace(const Quad& quad) {
    const Vec3 one = quad.corner[2] - quad.corner[0], other = quad.corner[3] - quad.corner[1];
    const double lengths = norm(one) + norm(other), area = norm(0.5 * cross(one, other));
    if (!(area > 0)) // no direction
      return {HUGE_VAL, 0};
    return {1.25 * lengths / area, 0.25 * lengths};
  }
  KOKKOS_INLINE_FUNCTION void include(const TurnRate& b) {
    rate = maxOf(rate, b.rate);
    limit = minOf(limit, b.limit);
  }
  // Of s, for a turn by no more than `turn`.
  KOKKOS_INLINE_FUNCTION double mostSpread(double turn) const {
    return rate > 0 ? minOf(limit, turn / rate) : limit;
  }
};

// What keeps the two of a pair apart: nothing that is known; only directions (no gap is asked for); or a gap.
struct Separation {
  double most_spread = 0; // it holds as long as s is less; length
  double gap = HUGE_VAL; // g, length
  Vec3 normal; // n: -n . w closes the gap
  double arm = 0; // gap that is lost per length of s
  double arm_by_motion = 0; // and per length of s and length of w

  KOKKOS_INLINE_FUNCTION bool holds() const { return most_spread > 0 && gap > 0; }
};

// The bounds of all separations of a block of rows between two bodies, since they were found.
struct KeptBound {
  static constexpr float tiny = 2.5e-7f; // relative, more than the rounding to a float
  static constexpr double safety = 1 + 1e-6; // for the rounding of all that is stored here

  int body[2]; // places in BodyMotions; w is of the first against the second
  float most_spread, gap, arm, arm_by_motion;
  float along[6]; // greatest components of -n: down xyz, up xyz
  float from[6]; // w when it was found: low xyz rounded up, high xyz rounded down

  KOKKOS_INLINE_FUNCTION void start(const BodyMotions& motions, int first, int second) {
    body[0] = first;
    body[1] = second;
    most_spread = gap = HUGE_VALF;
    arm = arm_by_motion = 0;
    for (int d = 0; d < 3; ++d) {
      along[d] = along[3 + d] = 0;
      const float low = static_cast<float>(motions.low(first, second, d));
      const float high = static_cast<float>(motions.high(first, second, d));
      from[d] = low + tiny * std::fabs(low);
      from[3 + d] = high - tiny * std::fabs(high);
    }
  }
  // `side` 1: the node is of the first body; -1: of the second.
  KOKKOS_INLINE_FUNCTION void include(const Separation& pair, int side) {
    most_spread = minOf(most_spread, static_cast<float>(pair.most_spread));
    if (!(pair.gap < HUGE_VAL))
      return;
    gap = minOf(gap, static_cast<float>(pair.gap));
    arm = maxOf(arm, static_cast<float>(pair.arm));
    arm_by_motion = maxOf(arm_by_motion, static_cast<float>(pair.arm_by_motion));
    for (int d = 0; d < 3; ++d) {
      const auto n = static_cast<float>(side * pair.normal[d]);
      along[d] = maxOf(along[d], n); // closes as w goes down
      along[3 + d] = maxOf(along[3 + d], -n);
    }
  }
  // Whether all of them still hold.
  KOKKOS_INLINE_FUNCTION bool holds(const BodyMotions& motions, double rounding) const {
    double spread = 0, closing = 0, motion = 0;
    for (int d = 0; d < 3; ++d) {
      const double low = motions.low(body[0], body[1], d) - from[d];
      const double high = motions.high(body[0], body[1], d) - from[3 + d];
      spread += high - low;
      closing += along[d] * maxOf(-low, 0.0) + along[3 + d] * maxOf(high, 0.0);
      motion += maxOf(-low, high);
    }
    return safety * spread < most_spread &&
           safety * (closing + spread * (arm + arm_by_motion * motion) + rounding) < gap;
  }
};

} // namespace brickwall::contact
