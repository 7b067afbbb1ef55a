// LimbSums over a range of items of which each thread adds many, and the kernel of devices for them.
#pragma once

#include "contact/base/fixed_point.hpp"

#include <string>
#include <utility>

namespace brickwall::mechanics {

// Sums of int64 in device memory, kept until Kokkos::finalize() because allocations take longer than
// a sum.
inline View<std::int64_t*>& wordsOfSums(int size) {
  static View<std::int64_t*> words;
  if (static_cast<int>(words.extent(0)) < size) {
    if (words.extent(0) == 0)
      Kokkos::push_finalize_hook([] { words = View<std::int64_t*>(); });
    words = View<std::int64_t*>("mechanics::wordsOfSums", static_cast<std::size_t>(size));
  }
  return words;
}

// Teams whose threads add many items to LimbSums of their own, which are then summed word by word in
// scratch memory. Kokkos would join whole LimbSums in registers.
template <int N, class Functor>
struct AddLimbsByTeams {
  static constexpr int team_size = 256, teams_at_once = 2, num_words = 3 * N + 1, words_at_once = 8,
                       sums_per_word = 32;
  using policy = Kokkos::TeamPolicy<exec_space, Kokkos::LaunchBounds<team_size, teams_at_once>,
                                    launch_by_argument>;
  using member_type = typename policy::member_type;

  Functor functor;
  View<std::int64_t*> total;

  // Words of some threads of a team, and partial sums of all words in padded rows.
  KOKKOS_INLINE_FUNCTION static constexpr std::size_t scratchBytes() {
    return (words_at_once * team_size + num_words * (sums_per_word + 1)) * sizeof(std::int64_t);
  }
  KOKKOS_INLINE_FUNCTION void operator()(const member_type& team) const {
    LimbSums<N> mine;
    functor(std::int64_t(team.league_rank()) * team.team_size() + team.team_rank(),
            std::int64_t(team.league_size()) * team.team_size(), mine);
    const std::int64_t* const words = reinterpret_cast<const std::int64_t*>(&mine);
    auto* const scratch = static_cast<std::int64_t*>(team.team_shmem().get_shmem(scratchBytes()));
    std::int64_t* const partial = scratch + words_at_once * team_size;
    for (int first = 0; first < num_words; first += words_at_once) {
      const int count = minOf(+words_at_once, num_words - first);
      for (int w = 0; w < count; ++w)
        scratch[w * team.team_size() + team.team_rank()] = words[first + w];
      team.team_barrier();
      for (int k = team.team_rank(); k < count * sums_per_word; k += team.team_size()) {
        const int w = k / sums_per_word, row = k % sums_per_word;
        std::int64_t sum = 0;
        for (int t = row; t < team.team_size(); t += sums_per_word)
          sum += scratch[w * team.team_size() + t];
        partial[(first + w) * (sums_per_word + 1) + row] = sum;
      }
      team.team_barrier();
    }
    for (int w = team.team_rank(); w < num_words; w += team.team_size()) {
      std::int64_t sum = 0;
      for (int row = 0; row < sums_per_word; ++row)
        sum += partial[w * (sums_per_word + 1) + row];
      if (sum != 0)
        Kokkos::atomic_add(&total(w), sum);
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

// The LimbSums of what functor(first, stride, sums) adds for the items first, first + stride, ... of
// [0, n). `on_device` chooses the kernel. Fences.
template <int N, bool on_device = !host_accessible, class Functor>
LimbSums<N> sumStrided(const std::string& label, const exec_space& space, std::int64_t n,
                       const Functor& functor) {
  LimbSums<N> sums;
  if constexpr (on_device) {
    using Teams = AddLimbsByTeams<N, Functor>;
    const int team_size = host_accessible ? 1 : +Teams::team_size;
    const std::int64_t fitting = maxOf(1, concurrency(space) * Teams::teams_at_once / 2048),
                       needed = maxOf<std::int64_t>(1, (n + team_size - 1) / team_size);
    static_assert(Teams::scratchBytes() <= 48 * 1024, "scratch memory that every device has");
    const auto words = Kokkos::subview(wordsOfSums(sums.size()), std::make_pair(0, +sums.size()));
    Kokkos::deep_copy(space, words, 0);
    auto policy =
        typename Teams::policy(space, static_cast<int>(minOf(fitting, needed)), team_size);
    policy.set_scratch_size(0, Kokkos::PerTeam(Teams::scratchBytes()));
    Kokkos::parallel_for(label, policy, Teams{functor, words});
    Kokkos::deep_copy(space,
                      Kokkos::View<std::int64_t*, Kokkos::HostSpace, Kokkos::MemoryUnmanaged>(
                          sums.data(), static_cast<std::size_t>(sums.size())),
                      words);
  } else {
    const std::int64_t pieces = minOf<std::int64_t>(n, concurrency(space));
    Kokkos::parallel_reduce(label, rangePolicy(space, pieces),
                            AddPiece<N, Functor>{functor, pieces}, PlusReducer<LimbSums<N>>(sums));
  }
  space.fence();
  return sums;
}

} // namespace brickwall::mechanics
