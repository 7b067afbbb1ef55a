// A 64-bit hash of words, on host and device: each word is spread over all bits (splitmix64,
// Steele, Lea and Flood 2014). Sums of hashes, modulo 2^64, compare sets regardless of order.
#pragma once

#include "contact/base/vec3.hpp"

#include <cstdint>
#include <cstring>

namespace brickwall {

KOKKOS_INLINE_FUNCTION std::uint64_t spreadBits(std::uint64_t word) {
  word += 0x9E3779B97F4A7C15ull;
  word = (word ^ (word >> 30)) * 0xBF58476D1CE4E5B9ull;
  word = (word ^ (word >> 27)) * 0x94D049BB133111EBull;
  return word ^ (word >> 31);
}

class Hash {
public:
  KOKKOS_INLINE_FUNCTION void take(std::uint64_t word) { _state = spreadBits(_state + word); }
  KOKKOS_INLINE_FUNCTION void take(std::int64_t value) { take(static_cast<std::uint64_t>(value)); }
  KOKKOS_INLINE_FUNCTION void take(int value) { take(static_cast<std::int64_t>(value)); }
  // All bits: 0.0 and -0.0 differ.
  KOKKOS_INLINE_FUNCTION void take(double value) {
    std::uint64_t word;
    memcpy(&word, &value, sizeof word);
    take(word);
  }
  KOKKOS_INLINE_FUNCTION void take(const Vec3& v) {
    for (int i = 0; i < 3; ++i)
      take(v[i]);
  }
  KOKKOS_INLINE_FUNCTION std::uint64_t value() const { return _state; }

private:
  std::uint64_t _state = 0;
};

// A number in [-1, 1) that depends on the seed alone.
KOKKOS_INLINE_FUNCTION double randomOf(std::uint64_t seed) {
  return static_cast<double>(spreadBits(seed) >> 11) * 0x1p-52 - 1;
}

} // namespace brickwall
