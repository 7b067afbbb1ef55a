#include "contact/search/spatial/radix_sort.hpp"

#include "contact/base/mpi.hpp"

#include <algorithm>
#include <utility>

namespace brickwall::contact {
namespace {

// The division of rows into chunks: one thread counts and scatters each chunk in order.
struct Chunks {
  std::int64_t num_rows = 0;
  std::int64_t num_chunks = 1;
  int digit_bits = 8;

  KOKKOS_INLINE_FUNCTION std::int64_t begin(std::int64_t chunk) const {
    return num_rows * chunk / num_chunks;
  }
  KOKKOS_INLINE_FUNCTION std::int64_t numDigits() const { return std::int64_t(1) << digit_bits; }
};

// Few threads get long chunks and wide digits (few passes), many threads short chunks and narrow
// digits (small tables).
Chunks cut(const exec_space& space, std::int64_t n, int num_bits) {
  Chunks chunks;
  const std::int64_t threads = concurrency(space);
  const std::int64_t shortest = threads > 256 ? 128 : 2048;
  chunks.num_rows = n;
  chunks.num_chunks = std::max<std::int64_t>(1, std::min(threads, n / shortest));
  const int widest = threads > 256 ? 4 : (n < 4096 ? 8 : 11);
  const int passes = dividedUp(num_bits, widest);
  chunks.digit_bits = dividedUp(num_bits, passes);
  return chunks;
}

void countDigits(const exec_space& space, const Chunks& chunks, int shift,
                 const View<std::uint64_t*>& keys, const View<int*>& counts) {
  Kokkos::parallel_for(
      "contact::sortByKey::count", rangePolicy(space, chunks.num_chunks),
      KOKKOS_LAMBDA(const std::int64_t chunk) {
        const std::int64_t digits = chunks.numDigits();
        int* const count = &counts(chunk * digits);
        for (std::int64_t digit = 0; digit < digits; ++digit)
          count[digit] = 0;
        const auto mask = static_cast<std::uint64_t>(digits - 1);
        for (std::int64_t i = chunks.begin(chunk); i < chunks.begin(chunk + 1); ++i)
          ++count[(keys(i) >> shift) & mask];
      });
}

// Turns counts into the first position of each (digit, chunk), digit-major.
void scanDigits(const exec_space& space, const Chunks& chunks, const View<int*>& counts) {
  Kokkos::parallel_scan(
      "contact::sortByKey::scan", rangePolicy(space, chunks.num_chunks * chunks.numDigits()),
      KOKKOS_LAMBDA(const std::int64_t i, int& sum, const bool final) {
        const std::int64_t digit = i / chunks.num_chunks, chunk = i % chunks.num_chunks;
        int& entry = counts(chunk * chunks.numDigits() + digit);
        const int count = entry;
        if (final)
          entry = sum;
        sum += count;
      });
}

void scatter(const exec_space& space, const Chunks& chunks, int shift, const SortedKeys& sorted) {
  const auto keys = sorted.keys, to_keys = sorted.other_keys;
  const auto values = sorted.values, to_values = sorted.other_values;
  const auto counts = sorted.counts;
  Kokkos::parallel_for(
      "contact::sortByKey::scatter", rangePolicy(space, chunks.num_chunks),
      KOKKOS_LAMBDA(const std::int64_t chunk) {
        const std::int64_t digits = chunks.numDigits();
        int* const next = &counts(chunk * digits);
        const auto mask = static_cast<std::uint64_t>(digits - 1);
        for (std::int64_t i = chunks.begin(chunk); i < chunks.begin(chunk + 1); ++i) {
          const std::uint64_t key = keys(i);
          const int to = next[(key >> shift) & mask]++;
          to_keys(to) = key;
          to_values(to) = values(i);
        }
      });
}

} // namespace

void SortedKeys::grow(const exec_space& space, std::int64_t n) {
  checkedInt(n, "sorted keys");
  growTo(space, keys, n);
  growTo(space, values, n);
  growTo(space, other_keys, n);
  growTo(space, other_values, n);
}

void sortByKey(const exec_space& space, std::int64_t n, int num_bits, SortedKeys& sorted) {
  if (n < 2 || num_bits < 1)
    return;
  const Chunks chunks = cut(space, n, num_bits);
  growTo(space, sorted.counts, chunks.num_chunks * chunks.numDigits());
  for (int shift = 0; shift < num_bits; shift += chunks.digit_bits) {
    countDigits(space, chunks, shift, sorted.keys, sorted.counts);
    scanDigits(space, chunks, sorted.counts);
    scatter(space, chunks, shift, sorted);
    std::swap(sorted.keys, sorted.other_keys);
    std::swap(sorted.values, sorted.other_values);
  }
}

int bitsFor(std::uint64_t limit) {
  int bits = 0;
  while (bits < 64 && (limit > (std::uint64_t(1) << bits)))
    ++bits;
  return bits;
}

} // namespace brickwall::contact
