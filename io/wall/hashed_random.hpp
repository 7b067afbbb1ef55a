// Random numbers as a pure function of (seed, id, component): the same on any rank count and in any
// order. The mixer is SplitMix64's finaliser (Steele, Lea and Flood 2014).
#pragma once

#include <cstdint>

namespace brickwall::io {

inline std::uint64_t mixBits(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return z ^ (z >> 31);
}

// Uniform in [-1, 1), of 53 random bits. Jitter uses node ids, drift brick ids, with seeds of their
// own.
inline double hashedUniform(std::uint64_t seed, std::int64_t id, int component) {
  constexpr std::uint64_t golden = 0x9e3779b97f4a7c15ull;
  std::uint64_t bits = mixBits(seed + golden);
  bits = mixBits(bits ^ (static_cast<std::uint64_t>(id) + golden));
  bits = mixBits(bits ^ (static_cast<std::uint64_t>(component) + golden));
  return static_cast<double>(bits >> 11) * 0x1p-52 - 1.0;
}

} // namespace brickwall::io
