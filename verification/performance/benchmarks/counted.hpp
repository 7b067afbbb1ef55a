// A scalar type that counts its arithmetic: point-wise templates run on it to count flops. A
// division and a square root count as one; comparisons and choices count nothing.
#pragma once

#include "contact/base/fixed_pack.hpp"

namespace brickwall {

struct Counted {
  static inline std::int64_t count = 0;
  double value;
  Counted() = default;
  Counted(double v) : value(v) {}
  static Counted of(double v) {
    ++count;
    return v;
  }
  Counted& operator+=(const Counted& b) { return *this = of(value + b.value); }
  Counted& operator-=(const Counted& b) { return *this = of(value - b.value); }
};
#define BRICKWALL_COUNTED(op)                                                                      \
  inline Counted operator op(const Counted& a, const Counted& b) {                                 \
    return Counted::of(a.value op b.value);                                                        \
  }                                                                                                \
  inline Counted operator op(const Counted& a, double b) {                                         \
    return Counted::of(a.value op b);                                                              \
  }                                                                                                \
  inline Counted operator op(double a, const Counted& b) {                                         \
    return Counted::of(a op b.value);                                                              \
  }
BRICKWALL_COUNTED(+)
BRICKWALL_COUNTED(-)
BRICKWALL_COUNTED(*)
BRICKWALL_COUNTED(/)
#undef BRICKWALL_COUNTED
inline Counted operator-(const Counted& a) {
  return -a.value;
}
inline bool operator<(const Counted& a, const Counted& b) {
  return a.value < b.value;
}
inline bool operator>(const Counted& a, const Counted& b) {
  return a.value > b.value;
}
inline bool operator<=(const Counted& a, const Counted& b) {
  return a.value <= b.value;
}
inline bool operator==(const Counted& a, const Counted& b) {
  return a.value == b.value;
}
inline Counted where(bool mask, const Counted& a, const Counted& b) {
  return mask ? a : b;
}
inline Counted whereNotZero(const Counted&, const Counted& a) {
  return a;
}
inline Counted squareRoot(const Counted& a) {
  return Counted::of(std::sqrt(a.value));
}
inline Counted magnitude(const Counted& a) {
  return std::fabs(a.value);
}
inline std::int64_t toFixed(const Counted& quanta) {
  return toFixed(Counted::of(quanta.value).value);
}
inline bool fitsFixedPoint(const Counted& quanta) {
  return fitsFixedPoint(quanta.value);
}

} // namespace brickwall
