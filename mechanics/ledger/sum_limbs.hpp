// LimbSums over a range of items of which each thread adds many, and the kernel of devices for
// them.
#pragma once

#include "contact/base/fixed_point.hpp"
#include "contact/base/sum_over.hpp"

#include <algorithm>
#include <string>
#include <utility>

namespace brickwall::mechanics {

// Sums of int64 in the memory of a device or, for a quick copy, in page-locked memory, kept until
// Kokkos::finalize() because allocations take longer than a sum.
template <class Space>
Kokkos::View<std::int64_t*, Space>& wordsOfSums(int size) {
  using Words = Kokkos::View<std::int64_t*, Space>;
  static Words words;
  if (static_cast<int>(words.extent(0)) < size) {
    if (words.extent(0) == 0)
      Kokkos::push_finalize_hook([] { words = Words(); });
    words = Words("mechanics::wordsOfSums", static_cast<std::size_t>(size));
  }
  return words;
}

// LimbSums of one thread of a device, which initialises only those to which it adds: they are in
// its local memory, and few threads add to all of them.
template <int N>
class SparseLimbSums {
public:
  static_assert(N <= 64, "a bit of _used for each sum");

  KOKKOS_INLINE_FUNCTION void add(int i, double term, const LimbScale& scale) {
    LimbSum one;
    if (one.add(term, scale))
      add(i, one);
    else
      ++invalid;
  }
  KOKKOS_INLINE_FUNCTION void add(int i, const LimbSum& sum) {
    const LimbSum before = has(i) ? LimbSum{_words[i][0], _words[i][1], _words[i][2]} : LimbSum();
    _words[i][0] = before.high + sum.high;
    _words[i][1] = before.low + sum.low;
    _words[i][2] = before.tail + sum.tail;
    _used |= std::uint64_t(1) << i;
  }
  KOKKOS_INLINE_FUNCTION std::int64_t word(int i, int limb) const {
    return has(i) ? _words[i][limb] : 0;
  }

  std::int64_t invalid = 0; // terms that did not fit

private:
  KOKKOS_INLINE_FUNCTION bool has(int i) const { return (_used >> i & 1u) != 0; }

  std::uint64_t _used = 0;
  std::int64_t _words[N][3]; // set where _used has the bit
};

// The sums to which items may add, of N.
template <int N>
struct SumList {
  int count = 0;
  unsigned char number[N] = {};

  void add(int first, int how_many = 1) {
    for (int i = 0; i < how_many; ++i)
      number[count++] = static_cast<unsigned char>(first + i);
  }
};

// Teams whose threads add many items to sums of their own, of which those of functor.listed are
// then summed in scratch memory, a few at a time. Kokkos would join whole LimbSums in registers.
template <int N, class Functor>
struct AddLimbsByTeams {
  static constexpr int team_size = 128, teams_at_once = 3, sums_at_once = 4, rows_per_word = 16;
  using policy = Kokkos::TeamPolicy<exec_space, Kokkos::LaunchBounds<team_size, teams_at_once>,
                                    launch_by_argument>;
  using member_type = typename policy::member_type;

  Functor functor;
  View<std::int64_t*> total;

  // Words of some sums of all threads, and partial sums of all words in padded rows.
  static constexpr int scratch_bytes =
      (3 * sums_at_once * team_size + 3 * N * (rows_per_word + 1)) * sizeof(std::int64_t);
  static_assert(scratch_bytes <= 48 * 1024, "scratch memory that every device has");

  KOKKOS_INLINE_FUNCTION void operator()(const member_type& team) const {
    SparseLimbSums<N> mine;
    functor(std::int64_t(team.league_rank()) * team.team_size() + team.team_rank(),
            std::int64_t(team.league_size()) * team.team_size(), mine);
    if (mine.invalid != 0)
      Kokkos::atomic_add(&total(3 * N), mine.invalid);
    auto* const scratch = static_cast<std::int64_t*>(team.team_shmem().get_shmem(+scratch_bytes));
    std::int64_t* const partial = scratch + 3 * sums_at_once * team_size;
    for (int first = 0; first < functor.listed.count; first += sums_at_once) {
      const int num_words = 3 * minOf(+sums_at_once, functor.listed.count - first);
      for (int w = 0; w < num_words; ++w)
        scratch[w * team.team_size() + team.team_rank()] =
            mine.word(functor.listed.number[first + w / 3], w % 3);
      team.team_barrier();
      for (int k = team.team_rank(); k < num_words * rows_per_word; k += team.team_size()) {
        const int w = k / rows_per_word, row = k % rows_per_word;
        std::int64_t sum = 0;
        for (int t = row; t < team.team_size(); t += rows_per_word)
          sum += scratch[w * team.team_size() + t];
        partial[(3 * first + w) * (rows_per_word + 1) + row] = sum;
      }
      team.team_barrier();
    }
    for (int w = team.team_rank(); w < 3 * functor.listed.count; w += team.team_size()) {
      std::int64_t sum = 0;
      for (int row = 0; row < rows_per_word; ++row)
        sum += partial[w * (rows_per_word + 1) + row];
      if (sum != 0)
        Kokkos::atomic_add(&total(3 * functor.listed.number[w / 3] + w % 3), sum);
    }
  }
};

// The same on a host: a thread takes one of `pieces` parts.
template <int N, class Functor>
struct AddPiece {
  Functor functor;
  std::int64_t pieces;

  void operator()(const std::int64_t first, LimbSums<N>& all) const { functor(first, pieces, all); }
};

// The LimbSums of what functor(first, stride, sums) adds for the items first, first + stride, ...
// of [0, n). `on_device` chooses the kernel. Fences.
template <int N, bool on_device = !host_accessible, class Functor>
LimbSums<N> sumStrided(const std::string& label, const exec_space& space, std::int64_t n,
                       const Functor& functor) {
  LimbSums<N> sums;
  if constexpr (on_device) {
    using Teams = AddLimbsByTeams<N, Functor>;
    const auto range = std::make_pair(0, +sums.size());
    const auto words = Kokkos::subview(wordsOfSums<memory_space>(sums.size()), range);
    const auto staged = Kokkos::subview(wordsOfSums<staging_space>(sums.size()), range);
    Kokkos::deep_copy(space, words, 0);
    Kokkos::parallel_for(label, teamPolicy<Teams>(space, n, Teams::teams_at_once),
                         Teams{functor, words});
    Kokkos::deep_copy(space, staged, words);
    space.fence();
    std::copy(staged.data(), staged.data() + sums.size(), sums.data());
  } else {
    const std::int64_t pieces = minOf<std::int64_t>(n, concurrency(space));
    Kokkos::parallel_reduce(label, rangePolicy(space, pieces),
                            AddPiece<N, Functor>{functor, pieces}, PlusReducer<LimbSums<N>>(sums));
  }
  return sums;
}

} // namespace brickwall::mechanics
