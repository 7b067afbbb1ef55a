// Sums over a range whose value is large, such as LimbSums.
#pragma once

#include "contact/base/backend.hpp"

#include <string>

namespace brickwall {

// Reduces a functor over [begin, end) by teams whose threads add many items to sums of their own
// and join these once. With a range policy, Kokkos keeps a value for each thread of a device in
// shared memory, in which few large ones fit. Each multiprocessor holds `teams_at_once` teams.
template <class Value, class Functor, int teams_at_once>
struct SumByTeams {
  static constexpr int team_size = 256;
  // Threads that take items in a row; few items are spread over all teams.
  static constexpr int group_size = 32;
  using policy = Kokkos::TeamPolicy<exec_space, Kokkos::LaunchBounds<team_size, teams_at_once>,
                                    launch_by_argument>;

  Functor functor;
  std::int64_t begin, end;

  KOKKOS_INLINE_FUNCTION void operator()(const typename policy::member_type& team,
                                         Value& sum) const {
    const std::int64_t stride = std::int64_t(team.league_size()) * team_size;
    const std::int64_t group = team.team_rank() / group_size;
    const std::int64_t first = (group * team.league_size() + team.league_rank()) * group_size +
                               team.team_rank() % group_size;
    Value mine;
    for (std::int64_t i = begin + first; i < end; i += stride)
      functor(i, mine);
    sum += mine;
  }
};

// The sum of what functor(i, Value&) adds for i of [begin, end). Value is as for PlusReducer, and
// its sums do not depend on the order. Fences. `teams_at_once`: on a device, teams of 256 threads
// that a multiprocessor runs at once, each of which has 256/teams_at_once registers a thread.
template <class Value, int teams_at_once = 1, class Functor>
Value sumOver(const std::string& label, const exec_space& space, std::int64_t begin,
              std::int64_t end, const Functor& functor) {
  Value sum;
  if constexpr (host_accessible) {
    Kokkos::parallel_reduce(label, range_policy(space, begin, end), functor,
                            PlusReducer<Value>(sum));
  } else {
    using Teams = SumByTeams<Value, Functor, teams_at_once>;
    const std::int64_t fitting = // by registers
        maxOf(1, teams_at_once * (concurrency(space) / (8 * Teams::team_size)));
    const std::int64_t needed = (end - begin + Teams::team_size - 1) / Teams::team_size;
    Kokkos::parallel_reduce(
        label,
        typename Teams::policy(space, static_cast<int>(minOf(fitting, needed)), Teams::team_size),
        Teams{functor, begin, end}, PlusReducer<Value>(sum));
  }
  space.fence();
  return sum;
}

} // namespace brickwall
