// Random numbers as a pure function of (seed, id, component): the same on any rank count and in any
// order.
#pragma once

#include "contact/base/hash.hpp"

namespace brickwall::io {

// Uniform in [-1, 1). Jitter uses node ids, drift brick ids, with seeds of their
// own.
inline double hashedUniform(std::uint64_t seed, std::int64_t id, int component) {
  std::uint64_t bits = hashOfWord(seed);
  bits = mixBits(bits ^ (static_cast<std::uint64_t>(id) + golden_ratio));
  bits = mixBits(bits ^ (static_cast<std::uint64_t>(component) + golden_ratio));
  return uniformOf(bits);
}

} // namespace brickwall::io
