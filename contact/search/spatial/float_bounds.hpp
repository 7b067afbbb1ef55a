// Boxes in single precision for the cluster search. They never cause a wrong decision: rounding is
// monotone, a <= b implies fl(a) <= fl(b) and fl(a) < fl(b) implies a < b. So `<=` on floats never
// loses a pair of closed double boxes, `<` is always correct, and only ties in a float are resolved
// by the double boxes.
// Equations: theory.md, section 3, eq. (4).
#pragma once

#include "contact/base/box.hpp"

#include <algorithm>
#include <cfloat>

namespace brickwall::contact {

// The nearest float. Doubles beyond the range become the largest float, so that infinity can mean
// "no box" and differences are never NaN; zero becomes +0, so that no difference of equal bounds is
// -0.
KOKKOS_INLINE_FUNCTION float toFloat(double x) {
  return static_cast<float>(minOf(maxOf(x, -double(FLT_MAX)), double(FLT_MAX))) + 0.0f;
}

// A box as six numbers whose minimum is the union: lower xyz, then minus upper xyz. The default is
// the empty box.
struct FloatBounds {
  float side[6] = {HUGE_VALF, HUGE_VALF, HUGE_VALF, HUGE_VALF, HUGE_VALF, HUGE_VALF};

  KOKKOS_INLINE_FUNCTION void include(const FloatBounds& b) {
    for (int s = 0; s < 6; ++s)
      side[s] = minOf(side[s], b.side[s]);
  }
  KOKKOS_INLINE_FUNCTION static FloatBounds of(const Box& box, const Vec3& origin = {}) {
    FloatBounds bounds;
    if (!box.empty())
      for (int d = 0; d < 3; ++d) {
        bounds.side[d] = toFloat(box.lower[d] - origin[d]);
        bounds.side[3 + d] = -toFloat(box.upper[d] - origin[d]);
      }
    return bounds;
  }
  // The limits that the sides of another box must not exceed if it overlaps this one: upper xyz,
  // minus lower xyz.
  KOKKOS_INLINE_FUNCTION FloatBounds reach() const {
    FloatBounds reach;
    for (int d = 0; d < 3; ++d) {
      reach.side[d] = -side[3 + d];
      reach.side[3 + d] = -side[d];
    }
    return reach;
  }
  friend bool operator==(const FloatBounds& a, const FloatBounds& b) {
    return std::equal(a.side, a.side + 6, b.side);
  }
};

// Whether a box with these six sides overlaps the boxes of this reach.
KOKKOS_FORCEINLINE_FUNCTION bool isWithin(const float* sides, const FloatBounds& reach) {
  bool inside = true;
  for (int s = 0; s < 6; ++s)
    inside &= sides[s] <= reach.side[s];
  return inside;
}

} // namespace brickwall::contact
