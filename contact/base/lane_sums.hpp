// LimbSums of terms computed in SIMD lanes, one term of each lane at a time. A term is split into
// two integers of 51 bits by adding and subtracting 1.5 * 2^52 units, first of 2^51 tail units of
// its LimbScale, then of one (Rump, Ogita and Oishi 2008, error-free extraction); their bit
// patterns are added as integers. The sum equals that of LimbSum::add exactly.
#pragma once

#include "contact/base/fixed_point.hpp"
#include "contact/base/pack.hpp"

namespace brickwall {

// A LimbScale as the numbers that LaneSums adds to split terms.
struct SplitScale {
  double high, low;
  static SplitScale of(const LimbScale& scale) {
    constexpr double shift = 6755399441055744.0; // 1.5 * 2^52
    return {shift * 2251799813685248.0 * scale.tail_quantum, shift * scale.tail_quantum};
  }
};

KOKKOS_FORCEINLINE_FUNCTION std::uint64_t patternOf(double value) {
  std::uint64_t bits;
  memcpy(&bits, &value, sizeof bits);
  return bits;
}

// Adds the parts of split terms: the sums, modulo 2^64, of the bit patterns of `rows` terms with
// the shifts of `scale`.
KOKKOS_FORCEINLINE_FUNCTION void addParts(LimbSum& sum, std::uint64_t high_bits,
                                          std::uint64_t low_bits, std::uint64_t rows,
                                          const SplitScale& scale) {
  const auto high = static_cast<std::int64_t>(high_bits - rows * patternOf(scale.high));
  const auto low = static_cast<std::int64_t>(low_bits - rows * patternOf(scale.low));
  sum.high += high >> 17;
  sum.low += ((high & 0x1ffff) << 17) + (low >> 34);
  sum.tail += low & 0x3ffffffff;
}

template <int N, int W>
class LaneSums {
public:
  using Real = PackOf<W>;
  using Bits = typename VectorsOf<W>::bits; // sums modulo 2^64

  // Sums may overflow if foldInto() does not clear them after at most this many rows.
  static constexpr int max_rows = 4000;

  LaneSums() { clear(); }

  // Adds a term of each lane; every row adds all N sums.
  void add(int i, const Real& term, const SplitScale& scale) {
    const typename Real::vector high = term.v + scale.high;
    const typename Real::vector low = (term.v - (high - scale.high)) + scale.low;
    _high[i] += (Bits)high;
    _low[i] += (Bits)low;
    _misfit |= (Bits)high ^ patternOf(scale.high);
  }
  void endRow() { ++_rows; }

  // Adds the sums since the last call; `scales` are those of the terms.
  template <int M>
  void foldInto(LimbSums<M>& sums, const int (&index)[N], const SplitScale* const (&scales)[N]) {
    if (_rows == 0)
      return;
    for (int i = 0; i < N; ++i)
      for (int lane = 0; lane < W; ++lane)
        addParts(sums.sum[index[i]], _high[i][lane], _low[i][lane], _rows, *scales[i]);
    bool fits = true; // the exponents equal those of the shifts
    for (int lane = 0; lane < W; ++lane)
      fits = fits && _misfit[lane] >> 52 == 0;
    if (!fits)
      ++sums.invalid;
    clear();
  }

private:
  void clear() {
    for (int i = 0; i < N; ++i)
      _high[i] = _low[i] = Bits{};
    _misfit = Bits{};
    _rows = 0;
  }

  Bits _high[N], _low[N], _misfit;
  std::uint64_t _rows = 0;
};

// The same for the terms of one thread of a device.
template <int N>
class SplitSums {
public:
  static constexpr unsigned max_rows = 4000; // as in LaneSums

  KOKKOS_FORCEINLINE_FUNCTION void add(int i, double term, const SplitScale& scale) {
    const double high = term + scale.high;
    const double low = (term - (high - scale.high)) + scale.low;
    _high[i] += patternOf(high);
    _low[i] += patternOf(low);
    _misfit |= patternOf(high) ^ patternOf(scale.high);
  }
  KOKKOS_FORCEINLINE_FUNCTION void endRow() { ++_rows; }
  KOKKOS_FORCEINLINE_FUNCTION unsigned rows() const { return _rows; }

  // Adds sum i, whose terms have the scale scales(i), to the sum index(i).
  template <class Sums, class Index, class Scales>
  KOKKOS_INLINE_FUNCTION void foldInto(Sums& sums, const Index& index, const Scales& scales) {
    if (_rows > 0) // a sparse sum stays unused
      for (int i = 0; i < N; ++i) {
        LimbSum part;
        addParts(part, _high[i], _low[i], _rows, scales(i));
        sums.add(index(i), part);
      }
    sums.invalid += _misfit >> 52 != 0;
    *this = SplitSums();
  }

private:
  std::uint64_t _high[N] = {}, _low[N] = {}, _misfit = 0;
  unsigned _rows = 0;
};

} // namespace brickwall
