// A 64-bit hash of words, on host and device, by SplitMix64 (Steele, Lea and Flood 2014). Sums of
// hashes, modulo 2^64, compare sets regardless of order.
#pragma once

#include "contact/base/vec3.hpp"

#include <cstdint>
#include <cstring>

namespace brickwall {

constexpr std::uint64_t golden_ratio = 0x9E3779B97F4A7C15ull; // its fraction, times 2^64

// Each bit of the result depends on all bits of the word; 0 stays 0.
KOKKOS_INLINE_FUNCTION std::uint64_t mixBits(std::uint64_t word) {
  word = (word ^ (word >> 30)) * 0xBF58476D1CE4E5B9ull;
  word = (word ^ (word >> 27)) * 0x94D049BB133111EBull;
  return word ^ (word >> 31);
}

KOKKOS_INLINE_FUNCTION std::uint64_t hashOfWord(std::uint64_t word) {
  return mixBits(word + golden_ratio);
}

class Hash {
public:
  KOKKOS_INLINE_FUNCTION void take(std::uint64_t word) { _state = hashOfWord(_state + word); }
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

// Uniform in [-1, 1), by the upper 53 of random bits.
KOKKOS_INLINE_FUNCTION double uniformOf(std::uint64_t bits) {
  return static_cast<double>(bits >> 11) * 0x1p-52 - 1;
}
// A number in [-1, 1) that depends on the seed alone.
KOKKOS_INLINE_FUNCTION double randomOf(std::uint64_t seed) {
  return uniformOf(hashOfWord(seed));
}

} // namespace brickwall
