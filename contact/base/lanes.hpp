// Comparing boxes lane by lane in SIMD registers: the one place that asks which instructions there are. Without AVX-512 or
// AVX2, and on devices, plain loops give the same bits.
#pragma once

#include "contact/base/backend.hpp"

#if defined(__AVX512F__) && defined(__AVX512VL__) && !defined(__CUDACC__)
#define BRICKWALL_LANES_AVX512
#include <immintrin.h>
#elif defined(__AVX2__) && !defined(__CUDACC__)
#define BRICKWALL_LANES_AVX2
#include <immintrin.h>
#endif

namespace brickwall {

// Bit l: sides[s][l] <= most[s] for all six sides (with Strict: <). `sides` is [6][Width], unaligned.
template <int Width, bool Strict = false>
KOKKOS_INLINE_FUNCTION unsigned lanesWithin(const float* sides, const float (&most)[6]) {
#if defined(BRICKWALL_LANES_AVX512)
  constexpr int predicate = Strict ? _CMP_LT_OQ : _CMP_LE_OQ;
  if constexpr (Width == 16) {
    __mmask16 lanes = 0xffff;
    for (int s = 0; s < 6; ++s)
      lanes = _mm512_mask_cmp_ps_mask(lanes, _mm512_loadu_ps(sides + s * 16),
                                      _mm512_set1_ps(most[s]), predicate);
    return lanes;
  } else if constexpr (Width == 8) {
    __mmask8 lanes = 0xff;
    for (int s = 0; s < 6; ++s)
      lanes = _mm256_mask_cmp_ps_mask(lanes, _mm256_loadu_ps(sides + s * 8),
                                      _mm256_set1_ps(most[s]), predicate);
    return lanes;
  }
#elif defined(BRICKWALL_LANES_AVX2)
  constexpr int predicate = Strict ? _CMP_LT_OQ : _CMP_LE_OQ;
  if constexpr (Width % 8 == 0) {
    unsigned lanes = 0;
    for (int part = 0; part < Width; part += 8) {
      __m256 all = _mm256_cmp_ps(_mm256_loadu_ps(sides + part), _mm256_set1_ps(most[0]), predicate);
      for (int s = 1; s < 6; ++s)
        all = _mm256_and_ps(all, _mm256_cmp_ps(_mm256_loadu_ps(sides + s * Width + part),
                                               _mm256_set1_ps(most[s]), predicate));
      lanes |= static_cast<unsigned>(_mm256_movemask_ps(all)) << part;
    }
    return lanes;
  }
#endif
  unsigned lanes = 0;
  for (int l = 0; l < Width; ++l) {
    bool within = true;
    for (int s = 0; s < 6; ++s)
      within &= Strict ? sides[s * Width + l] < most[s] : sides[s * Width + l] <= most[s];
    lanes |= static_cast<unsigned>(within) << l;
  }
  return lanes;
}

// Number of the lowest bit that is set; bits != 0.
KOKKOS_INLINE_FUNCTION int lowestBit(unsigned bits) {
#if defined(__CUDA_ARCH__)
  return __ffs(static_cast<int>(bits)) - 1;
#elif defined(__GNUC__)
  return __builtin_ctz(bits);
#else
  int bit = 0;
  while (!(bits >> bit & 1u))
    ++bit;
  return bit;
#endif
}

} // namespace brickwall
