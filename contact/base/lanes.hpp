// Comparison of boxes lane by lane in SIMD registers, and the lanes of threads of a team: the only
// file that depends on the instruction set. Without AVX-512 or AVX2, and on devices, plain loops
// give the same bits.
#pragma once

#include "contact/base/backend.hpp"

#if defined(__AVX512DQ__) && defined(__AVX512VL__) && !defined(__CUDACC__)
#define BRICKWALL_LANES_AVX512
#include <immintrin.h>
#elif defined(__AVX2__) && !defined(__CUDACC__)
#define BRICKWALL_LANES_AVX2
#include <immintrin.h>
#endif

namespace brickwall {

// Lanes as bits: those where something holds with <= and with <.
struct LanesReached {
  unsigned all, surely;
};

// Bit l: box[s * stride] <= reach[s][l] for all six sides. `reach` is [6][Width], unaligned: one
// box against the reaches of many. No difference of a reach and a side may be NaN.
template <int Width>
KOKKOS_INLINE_FUNCTION LanesReached lanesReaching(const float* reach, const float* box,
                                                  int stride) {
  // a - b >= 0 if and only if a >= b, and a - b > 0 if and only if a > b
#if defined(BRICKWALL_LANES_AVX512)
  if constexpr (Width == 16) {
    __m512 least = _mm512_sub_ps(_mm512_loadu_ps(reach), _mm512_set1_ps(box[0]));
    for (int s = 1; s < 6; ++s)
      least = _mm512_maskz_min_ps(
          0xffff, least,
          _mm512_sub_ps(_mm512_loadu_ps(reach + s * 16), _mm512_set1_ps(box[s * stride])));
    const __m512 zero = _mm512_setzero_ps();
    return {_mm512_cmp_ps_mask(least, zero, _CMP_GE_OQ),
            _mm512_cmp_ps_mask(least, zero, _CMP_GT_OQ)};
  }
#elif defined(BRICKWALL_LANES_AVX2)
  if constexpr (Width % 8 == 0) {
    LanesReached lanes = {0, 0};
    const __m256 zero = _mm256_setzero_ps();
    for (int part = 0; part < Width; part += 8) {
      __m256 least = _mm256_sub_ps(_mm256_loadu_ps(reach + part), _mm256_set1_ps(box[0]));
      for (int s = 1; s < 6; ++s)
        least = _mm256_min_ps(least, _mm256_sub_ps(_mm256_loadu_ps(reach + s * Width + part),
                                                   _mm256_set1_ps(box[s * stride])));
      const auto bits = [&](__m256 which) {
        return static_cast<unsigned>(_mm256_movemask_ps(which)) << part;
      };
      lanes.all |= bits(_mm256_cmp_ps(least, zero, _CMP_GE_OQ));
      lanes.surely |= bits(_mm256_cmp_ps(least, zero, _CMP_GT_OQ));
    }
    return lanes;
  }
#endif
  LanesReached lanes = {0, 0};
  for (int l = 0; l < Width; ++l) {
    bool within = true, surely = true;
    for (int s = 0; s < 6; ++s) {
      within &= box[s * stride] <= reach[s * Width + l];
      surely &= box[s * stride] < reach[s * Width + l];
    }
    lanes.all |= static_cast<unsigned>(within) << l;
    lanes.surely |= static_cast<unsigned>(surely) << l;
  }
  return lanes;
}

// Bit l of eight: sides[s * stride + l] <= reach[s] for all six sides (with Strict: <): many boxes
// against the reach of one.
template <bool Strict = false>
KOKKOS_INLINE_FUNCTION unsigned lanesWithin(const float* sides, int stride,
                                            const float (&reach)[6]) {
#if defined(BRICKWALL_LANES_AVX512) || defined(BRICKWALL_LANES_AVX2)
  constexpr int predicate = Strict ? _CMP_LT_OQ : _CMP_LE_OQ;
#endif
#if defined(BRICKWALL_LANES_AVX512)
  __mmask8 lanes = 0xff;
  for (int s = 0; s < 6; ++s)
    lanes = _mm256_mask_cmp_ps_mask(lanes, _mm256_loadu_ps(sides + s * stride),
                                    _mm256_set1_ps(reach[s]), predicate);
  return lanes;
#elif defined(BRICKWALL_LANES_AVX2)
  __m256 all = _mm256_cmp_ps(_mm256_loadu_ps(sides), _mm256_set1_ps(reach[0]), predicate);
  for (int s = 1; s < 6; ++s)
    all = _mm256_and_ps(all, _mm256_cmp_ps(_mm256_loadu_ps(sides + s * stride),
                                           _mm256_set1_ps(reach[s]), predicate));
  return static_cast<unsigned>(_mm256_movemask_ps(all));
#else
  unsigned lanes = 0;
  for (int l = 0; l < 8; ++l) {
    bool within = true;
    for (int s = 0; s < 6; ++s)
      within &= Strict ? sides[s * stride + l] < reach[s] : sides[s * stride + l] <= reach[s];
    lanes |= static_cast<unsigned>(within) << l;
  }
  return lanes;
#endif
}

// lanes[s][l] = -rows[l][(s + 3) % 6]: the reaches of `Width` boxes.
template <int Width>
KOKKOS_INLINE_FUNCTION void reachOfRows(const float* rows, float* lanes) {
#if defined(BRICKWALL_LANES_AVX512)
  if constexpr (Width == 16) {
    const __m512i six =
        _mm512_set_epi32(90, 84, 78, 72, 66, 60, 54, 48, 42, 36, 30, 24, 18, 12, 6, 0);
    const auto part = [&](int i) { return _mm512_loadu_ps(rows + 16 * i); };
    for (int s = 0; s < 6; ++s) {
      const __m512i at = _mm512_add_epi32(six, _mm512_set1_epi32((s + 3) % 6));
      const __mmask16 from_32 = _mm512_cmpge_epi32_mask(at, _mm512_set1_epi32(32));
      const __mmask16 from_64 = _mm512_cmpge_epi32_mask(at, _mm512_set1_epi32(64));
      __m512 side = _mm512_permutex2var_ps(part(0), at, part(1));
      side = _mm512_mask_mov_ps(side, from_32, _mm512_permutex2var_ps(part(2), at, part(3)));
      side = _mm512_mask_mov_ps(side, from_64, _mm512_permutex2var_ps(part(4), at, part(5)));
      _mm512_storeu_ps(lanes + s * 16, _mm512_xor_ps(side, _mm512_set1_ps(-0.0f)));
    }
    return;
  }
#endif
  for (int s = 0; s < 6; ++s)
    for (int l = 0; l < Width; ++l)
      lanes[s * Width + l] = -rows[l * 6 + (s + 3) % 6];
}

// Writes those of eight numbers of 32 bits whose bit is set, in order. Up to 8 entries of `to` are
// overwritten.
template <class Number>
KOKKOS_INLINE_FUNCTION void selectLanes(const Number* numbers, unsigned bits, Number* to) {
  static_assert(sizeof(Number) == 4, "");
#if defined(BRICKWALL_LANES_AVX512)
  const __m256i all = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(numbers));
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(to),
                      _mm256_maskz_compress_epi32(static_cast<__mmask8>(bits), all));
#else
  for (int l = 0; l < 8; ++l) {
    *to = numbers[l];
    to += bits >> l & 1u;
  }
#endif
}

// bits[l]: for each of four numbers numbers[k][l], bit numbers[k][l] - first, if that is in [0,
// 32).
KOKKOS_INLINE_FUNCTION void bitsOfNumbers(const int* numbers, int first, unsigned (&bits)[8]) {
#if defined(BRICKWALL_LANES_AVX512) || defined(BRICKWALL_LANES_AVX2)
  const __m256i one = _mm256_set1_epi32(1), base = _mm256_set1_epi32(first);
  __m256i all = _mm256_setzero_si256();
  for (int k = 0; k < 4; ++k) { // a shift by 32 or more, as unsigned, gives 0
    const __m256i number = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(numbers + 8 * k));
    all = _mm256_or_si256(all, _mm256_sllv_epi32(one, _mm256_sub_epi32(number, base)));
  }
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(bits), all);
#else
  for (int l = 0; l < 8; ++l) {
    bits[l] = 0;
    for (int k = 0; k < 4; ++k) {
      const auto at = static_cast<unsigned>(numbers[8 * k + l] - first);
      bits[l] |= at < 32u ? 1u << at : 0u;
    }
  }
#endif
}

// The box of the points a and b (xyz), larger by `tolerance` and relative to `origin`, as floats:
// lower xyz, then minus upper xyz, clamped to the range of floats. Returns whether all six
// coordinates are finite; otherwise the box is meaningless. May read a[3] and b[3]; sides[6] and
// sides[7] have no meaning.
KOKKOS_INLINE_FUNCTION bool sweptBox(const double* a, const double* b, double tolerance,
                                     const double (&origin)[4], float (&sides)[8]) {
#if defined(BRICKWALL_LANES_AVX512) || defined(BRICKWALL_LANES_AVX2)
  const __m256d x = _mm256_loadu_pd(a), y = _mm256_loadu_pd(b), from = _mm256_loadu_pd(origin);
  const __m256d inflate = _mm256_set1_pd(tolerance);
  const __m256d zero = _mm256_add_pd(_mm256_sub_pd(x, x), _mm256_sub_pd(y, y)); // or NaN
  const __m256d low = _mm256_sub_pd(_mm256_sub_pd(_mm256_min_pd(x, y), inflate), from);
  const __m256d high = _mm256_sub_pd(_mm256_add_pd(_mm256_max_pd(x, y), inflate), from);
  const __m256 most = _mm256_set1_ps(3.40282347e+38f), least = _mm256_set1_ps(-3.40282347e+38f);
  const __m256 both = _mm256_set_m128(_mm256_cvtpd_ps(high), _mm256_cvtpd_ps(low));
  const __m256 box =
      _mm256_add_ps(_mm256_min_ps(_mm256_max_ps(both, least), most), _mm256_setzero_ps());
  const __m256 minus = _mm256_setr_ps(0, 0, 0, 0, -0.0f, -0.0f, -0.0f, -0.0f);
  _mm256_storeu_ps(sides, _mm256_permutevar8x32_ps(_mm256_xor_ps(box, minus),
                                                   _mm256_setr_epi32(0, 1, 2, 4, 5, 6, 3, 7)));
  return (_mm256_movemask_pd(_mm256_cmp_pd(zero, _mm256_setzero_pd(), _CMP_EQ_OQ)) & 7) == 7;
#else
  constexpr double most = 3.40282346638528859812e+38;
  double zero = 0; // or NaN
  sides[6] = sides[7] = 0;
  for (int d = 0; d < 3; ++d) {
    zero += (a[d] - a[d]) + (b[d] - b[d]);
    const double low = (b[d] < a[d] ? b[d] : a[d]) - tolerance - origin[d];
    const double high = (b[d] < a[d] ? a[d] : b[d]) + tolerance - origin[d];
    sides[d] = static_cast<float>(minOf(maxOf(low, -most), most)) + 0.0f;
    sides[3 + d] = -(static_cast<float>(minOf(maxOf(high, -most), most)) + 0.0f);
  }
  return zero == 0;
#endif
}

// Sorts the numbers and masks of the first `count` <= 64 entries by key, without branching on the
// keys, which must all differ. The keys themselves may remain unsorted.
KOKKOS_INLINE_FUNCTION void sortTogether(int* keys, int* numbers, unsigned* masks, int count) {
#if defined(BRICKWALL_LANES_AVX512)
  int sorted[64];
  unsigned sorted_masks[64];
  for (int i = 0; i < count; ++i) { // its position is the number of smaller keys
    const __m512i key = _mm512_set1_epi32(keys[i]);
    int place = 0;
    for (int j = 0; j < count; j += 16) {
      const auto used = static_cast<__mmask16>(count - j >= 16 ? 0xffffu : (1u << (count - j)) - 1);
      place += __builtin_popcount(
          _mm512_mask_cmplt_epi32_mask(used, _mm512_maskz_loadu_epi32(used, keys + j), key));
    }
    sorted[place] = numbers[i];
    sorted_masks[place] = masks[i];
  }
  for (int i = 0; i < count; ++i) {
    numbers[i] = sorted[i];
    masks[i] = sorted_masks[i];
  }
#else
  for (int i = 1; i < count; ++i) {
    const int key = keys[i], number = numbers[i];
    const unsigned mask = masks[i];
    int to = i;
    for (; to > 0 && key < keys[to - 1]; --to) {
      keys[to] = keys[to - 1];
      numbers[to] = numbers[to - 1];
      masks[to] = masks[to - 1];
    }
    keys[to] = key;
    numbers[to] = number;
    masks[to] = mask;
  }
#endif
}

// Writes the numbers whose mask has this bit, in order, and returns their count. Up to 16 entries
// of `to` after them are overwritten.
KOKKOS_INLINE_FUNCTION int selectByBit(const int* numbers, const unsigned* masks, int count,
                                       int bit, int* to) {
  int written = 0;
#if defined(BRICKWALL_LANES_AVX512)
  const __m512i wanted = _mm512_set1_epi32(1 << bit);
  for (int i = 0; i < count; i += 16) {
    const auto used = static_cast<__mmask16>(count - i >= 16 ? 0xffffu : (1u << (count - i)) - 1);
    const __mmask16 has =
        _mm512_mask_test_epi32_mask(used, _mm512_maskz_loadu_epi32(used, masks + i), wanted);
    _mm512_storeu_si512(to + written, _mm512_maskz_compress_epi32(
                                          has, _mm512_maskz_loadu_epi32(used, numbers + i)));
    written += __builtin_popcount(has);
  }
#else
  for (int i = 0; i < count; ++i) {
    to[written] = numbers[i];
    written += static_cast<int>(masks[i] >> bit & 1u);
  }
#endif
  return written;
}

// Whether any of the numbers has a bit that is set.
template <int N>
KOKKOS_FORCEINLINE_FUNCTION bool anyBitIn(const std::uint64_t (&numbers)[N]) {
#if defined(BRICKWALL_LANES_AVX512)
  if constexpr (N == 8)
    return _mm512_test_epi64_mask(_mm512_loadu_si512(numbers), _mm512_set1_epi64(-1)) != 0;
#endif
  std::uint64_t any = 0;
  for (const std::uint64_t number : numbers)
    any |= number;
  return any != 0;
}

// Reserves `count` >= 0 consecutive places of a list whose length is *counter, which other threads
// extend at the same time, and returns the first. Threads of a warp that call it together for one
// list share one atomic operation.
KOKKOS_INLINE_FUNCTION std::int64_t reservePlaces(std::int64_t* counter, int count) {
#if defined(__CUDA_ARCH__)
  const unsigned together =
      __match_any_sync(__activemask(), reinterpret_cast<unsigned long long>(counter));
  unsigned lower_lanes;
  asm("mov.u32 %0, %%lanemask_lt;" : "=r"(lower_lanes));
  int before = 0, all = 0;
  for (int bit = 0; __any_sync(together, count >> bit); ++bit) {
    const unsigned has = __ballot_sync(together, count >> bit & 1);
    before += __popc(has & lower_lanes) << bit;
    all += __popc(has) << bit;
  }
  std::int64_t first = 0;
  if ((together & lower_lanes) == 0)
    first = Kokkos::atomic_fetch_add(counter, std::int64_t(all));
  return __shfl_sync(together, first, __ffs(static_cast<int>(together)) - 1) + before;
#else
  return Kokkos::atomic_fetch_add(counter, std::int64_t(count));
#endif
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

// Number of bits that are set.
KOKKOS_INLINE_FUNCTION int countBits(unsigned bits) {
#if defined(__CUDA_ARCH__)
  return __popc(bits);
#elif defined(__GNUC__)
  return __builtin_popcount(bits);
#else
  int count = 0;
  for (; bits != 0; bits &= bits - 1)
    ++count;
  return count;
#endif
}

// Lanes of a thread of a team policy of this vector length. On a device they run together, on a
// host one after another.
constexpr int vector_lanes = 32;

// A variable of each lane; registers on a device.
template <class T>
struct OfLanes {
  static constexpr int lanes_here =
      std::is_same<memory_space, Kokkos::HostSpace>::value ? vector_lanes : 1;
  T values[lanes_here];
  KOKKOS_FORCEINLINE_FUNCTION T& operator[](int lane) { return values[lane % lanes_here]; }
};

// Calls body(lane) in all lanes. What it writes is visible to all lanes afterwards.
template <class Member, class Body>
KOKKOS_FORCEINLINE_FUNCTION void forLanes(const Member& team, const Body& body) {
#if defined(__CUDA_ARCH__)
  (void)team;
  body(static_cast<int>(threadIdx.x));
  __syncwarp();
#else
  Kokkos::parallel_for(Kokkos::ThreadVectorRange(team, vector_lanes), body);
#endif
}

// Bit l: test(l).
template <class Member, class Test>
KOKKOS_FORCEINLINE_FUNCTION unsigned lanesWhere(const Member& team, const Test& test) {
#if defined(__CUDA_ARCH__)
  (void)team;
  return __ballot_sync(0xffffffffu, test(static_cast<int>(threadIdx.x)));
#else
  unsigned lanes = 0;
  Kokkos::parallel_reduce(
      Kokkos::ThreadVectorRange(team, vector_lanes),
      [&](const int lane, unsigned& all) { all |= static_cast<unsigned>(test(lane)) << lane; },
      Kokkos::BOr<unsigned>(lanes));
  return lanes;
#endif
}

// The least value(lane).
template <class Member, class Value>
KOKKOS_FORCEINLINE_FUNCTION auto leastOfLanes(const Member& team, const Value& value) {
#if defined(__CUDA_ARCH__)
  (void)team;
  auto least = value(static_cast<int>(threadIdx.x));
  for (int other = vector_lanes / 2; other > 0; other /= 2)
    least = minOf(least, __shfl_xor_sync(0xffffffffu, least, other));
#else
  using Number = decltype(value(0));
  Number least{};
  Kokkos::parallel_reduce(
      Kokkos::ThreadVectorRange(team, vector_lanes),
      [&](const int lane, Number& all) { all = minOf(all, value(lane)); },
      Kokkos::Min<Number>(least));
#endif
  return least;
}

// The sum of value(lane).
template <class Member, class Value>
KOKKOS_FORCEINLINE_FUNCTION std::int64_t sumOfLanes(const Member& team, const Value& value) {
  std::int64_t total = 0;
  Kokkos::parallel_reduce(
      Kokkos::ThreadVectorRange(team, vector_lanes),
      [&](const int lane, std::int64_t& sum) { sum += value(lane); }, total);
  return total;
}

} // namespace brickwall
