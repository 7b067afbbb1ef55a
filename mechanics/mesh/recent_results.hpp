// Results of the last few distinct inputs of a function, for elements that are copies of each other
// bit for bit: those of a regular mesh at rest, or rows of it under a uniform deformation.
#pragma once

#include "contact/base/backend.hpp"

#include <cstring>

namespace brickwall::mechanics {

// Consecutive items that one thread works on with the results of the others at hand; on a device
// each thread has one item and nothing to remember.
constexpr int items_per_memory = host_accessible ? 256 : 1;

template <class Input, class Result>
class RecentResults {
public:
  // evaluate(), or its result for an earlier input with the same bits. Input has no padding and a
  // size of whole words.
  template <class Evaluate>
  KOKKOS_INLINE_FUNCTION const Result& find(const Input& input, const Evaluate& evaluate) {
    constexpr int num_words = sizeof(Input) / sizeof(std::uint64_t);
    std::uint64_t words[num_words], hash = 0;
    static_assert(sizeof words == sizeof input);
    memcpy(words, &input, sizeof words);
    for (int w = 0; w < num_words; ++w)
      hash += (words[w] ^ (words[w] >> 32)) * (0x9E3779B97F4A7C15ull * (2 * w + 1));
    for (int i = 0; i < minOf(_count, capacity); ++i) {
      bool is_same = _hashes[i] == hash;
      for (int w = 0; is_same && w < num_words; ++w)
        is_same = _inputs[i][w] == words[w];
      if (is_same)
        return _results[i];
    }
    const int oldest = _count++ % capacity;
    _hashes[oldest] = hash;
    for (int w = 0; w < num_words; ++w)
      _inputs[oldest][w] = words[w];
    return _results[oldest] = evaluate();
  }

private:
  static constexpr int capacity = minOf(items_per_memory, 64);
  int _count = 0; // of all evaluations
  std::uint64_t _hashes[capacity], _inputs[capacity][sizeof(Input) / sizeof(std::uint64_t)];
  Result _results[capacity];
};

} // namespace brickwall::mechanics
