// A box as six message words: lower xyz, upper xyz.
#pragma once

#include "contact/base/box.hpp"
#include "contact/base/exchange_plan.hpp"

namespace brickwall::contact {

constexpr int box_words = 6;

KOKKOS_INLINE_FUNCTION void packBox(const Box& box, std::int64_t* words) {
  for (int d = 0; d < 3; ++d) {
    words[d] = toWord(box.lower[d]);
    words[3 + d] = toWord(box.upper[d]);
  }
}
KOKKOS_INLINE_FUNCTION Box unpackBox(const std::int64_t* words) {
  Box box;
  for (int d = 0; d < 3; ++d) {
    fromWord(words[d], box.lower[d]);
    fromWord(words[3 + d], box.upper[d]);
  }
  return box;
}

} // namespace brickwall::contact
