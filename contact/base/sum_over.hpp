// Sums over a range whose value is large, such as LimbSums.
#pragma once

#include "contact/base/backend.hpp"

#include <cstring>
#include <new>
#include <string>

namespace brickwall {

// For a kernel of `Teams` over n items: as many teams as these need, or as the device runs at once.
// The number of multiprocessors is counted as if each had 2048 threads (A100, H100), so others run
// fewer teams.
template <class Teams>
typename Teams::policy teamPolicy(const exec_space& space, std::int64_t n, int teams_at_once) {
  const int team_size = host_accessible ? 1 : +Teams::team_size;
  const std::int64_t fitting = maxOf(1, teams_at_once * (concurrency(space) / 2048)),
                     needed = maxOf<std::int64_t>(1, dividedUp(n, team_size));
  typename Teams::policy policy(space, static_cast<int>(minOf(fitting, needed)), team_size);
  policy.set_scratch_size(0, Kokkos::PerTeam(+Teams::scratch_bytes));
  return policy;
}

// Reduces a functor over [begin, end) by teams whose threads add many items to sums of their own
// and join these once. With a range policy, Kokkos keeps a value for each thread of a device in
// shared memory, in which few large ones fit. Each multiprocessor holds `teams_at_once` teams.
template <class Value, class Functor, int teams_at_once>
struct SumByTeams {
  static constexpr int team_size = 256, scratch_bytes = 0;
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
    Value mine = Value();
    for (std::int64_t i = begin + first; i < end; i += stride)
      functor(i, mine);
    sum += mine;
  }
};

// Launches the sum of what functor(i, Value&) adds for i of [begin, end). Value is as for
// PlusReducer, and its sums do not depend on the order. `teams_at_once`: on a device, teams of 256
// threads that a multiprocessor runs at once, each of which has 256/teams_at_once registers a
// thread.
template <class Value, int teams_at_once = 1, class Space, class Functor>
void launchSum(const std::string& label, const exec_space& space, std::int64_t begin,
               std::int64_t end, const Functor& functor, const PlusReducer<Value, Space>& sum) {
  if constexpr (host_accessible) {
    Kokkos::parallel_reduce(label, range_policy(space, begin, end), functor, sum);
  } else {
    using Teams = SumByTeams<Value, Functor, teams_at_once>;
    Kokkos::parallel_reduce(label, teamPolicy<Teams>(space, end - begin, teams_at_once),
                            Teams{functor, begin, end}, sum);
  }
}
// The sum itself. Fences.
template <class Value, int teams_at_once = 1, class Functor>
Value sumOver(const std::string& label, const exec_space& space, std::int64_t begin,
              std::int64_t end, const Functor& functor) {
  Value sum = Value();
  launchSum<Value, teams_at_once>(label, space, begin, end, functor, PlusReducer<Value>(sum));
  return sum;
}

// Sums of several kernels, each of which stores one, that the host reads when it waits next.
template <class Value>
class LaunchedSums {
public:
  using Reducer = PlusReducer<Value, staging_space>;
  static constexpr int max_launched = 64;

  // The place of the sum of the next kernel.
  Reducer next(const exec_space& space) {
    if (_stored.extent(0) == 0)
      _stored = Kokkos::View<Value*, staging_space>(
          Kokkos::view_alloc(Kokkos::WithoutInitializing, "base::LaunchedSums"), max_launched);
    if (_num_launched == max_launched)
      take(space);
    Value& place = *new (&_stored(_num_launched++)) Value();
    return Reducer(place);
  }
  // The sum of all. Waits for the device if any was launched since the last call.
  Value read(const exec_space& space) {
    take(space);
    const Value sum = _sum;
    _sum = Value();
    return sum;
  }

private:
  void take(const exec_space& space) {
    if (_num_launched > 0)
      space.fence();
    for (int k = 0; k < _num_launched; ++k)
      _sum += _stored(k);
    _num_launched = 0;
  }

  Value _sum; // of kernels that the host has waited for
  Kokkos::View<Value*, staging_space> _stored;
  int _num_launched = 0;
};

// Adds what functor(i, Value&) adds for i of [begin, end) to `total`, word by word, in teams whose
// threads keep their sums in scratch memory: registers do not hold them. The words of `Value` are
// integers; the last Value::num_maxima are numbers >= 0, of which the largest is taken.
template <class Value, class Functor, int teams_at_once>
struct AddWordsByTeams {
  static_assert(std::is_trivially_copyable<Value>::value && sizeof(Value) % 8 == 0, "words");
  static constexpr int team_size = 128, group_size = 32; // as in SumByTeams
  static constexpr int num_words = sizeof(Value) / 8;
  static constexpr int row = num_words | 1; // odd: no two threads use one bank of scratch memory
  static constexpr int scratch_bytes = sizeof(std::int64_t) * row * team_size;
  using policy = Kokkos::TeamPolicy<exec_space, Kokkos::LaunchBounds<team_size, teams_at_once>,
                                    launch_by_argument>;

  Functor functor;
  std::int64_t begin, end;
  View<std::int64_t*> total;

  KOKKOS_INLINE_FUNCTION void operator()(const typename policy::member_type& team) const {
    const int num_threads = team.team_size(), thread = team.team_rank();
    auto* const words = static_cast<std::int64_t*>(
        team.team_shmem().get_shmem(sizeof(std::int64_t) * row * num_threads));
    Value& mine = *new (words + thread * row) Value();
    const std::int64_t stride = std::int64_t(team.league_size()) * num_threads;
    const std::int64_t group = thread / group_size;
    const std::int64_t first =
        (group * team.league_size() + team.league_rank()) * group_size + thread % group_size;
    for (std::int64_t i = begin + first; i < end; i += stride)
      functor(i, mine);
    team.team_barrier();
    const int num_parts = maxOf(1, num_threads / num_words);
    for (int k = thread; k < num_words * num_parts; k += num_threads)
      add(words + k % num_words, k / num_words, num_parts, num_threads, k % num_words);
  }

private:
  // Adds word w of the threads part, part + num_parts, ...
  KOKKOS_INLINE_FUNCTION void add(const std::int64_t* word, int part, int num_parts,
                                  int num_threads, int w) const {
    const bool is_maximum = w >= num_words - Value::num_maxima;
    std::int64_t sum = 0;
    for (int t = part; t < num_threads; t += num_parts) {
      std::int64_t value;
      memcpy(&value, __builtin_assume_aligned(word + t * row, sizeof value), sizeof value);
      sum = is_maximum ? maxOf(sum, value) : sum + value;
    }
    if (sum != 0 && is_maximum)
      Kokkos::atomic_fetch_max(&total(w), sum);
    else if (sum != 0)
      Kokkos::atomic_add(&total(w), sum);
  }
};

// A sum that several kernels of a device add to, and that the host reads once. `Value` as for
// AddWordsByTeams. `on_device` chooses the kernel.
template <class Value, bool on_device = !host_accessible>
class LateSum {
public:
  LateSum() = default;
  explicit LateSum(const std::string& label) {
    if constexpr (on_device) {
      _words = View<std::int64_t*>(label, sizeof(Value) / 8);
      _staged = Kokkos::View<std::int64_t*, staging_space>(label + "::staged", sizeof(Value) / 8);
    }
  }

  // Empties the sum if a kernel that is launched next zeroes the words returned; a host has none.
  const View<std::int64_t*>& clear() {
    _sum = Value();
    return _words;
  }
  // `teams_at_once`: teams of 128 threads that a multiprocessor runs at once, each of which has
  // 512/teams_at_once registers a thread. Waits on a host only.
  template <int teams_at_once = 2, class Functor>
  void add(const std::string& label, const exec_space& space, std::int64_t begin, std::int64_t end,
           const Functor& functor) {
    if constexpr (on_device) {
      using Teams = AddWordsByTeams<Value, Functor, teams_at_once>;
      if (end > begin)
        Kokkos::parallel_for(label, teamPolicy<Teams>(space, end - begin, teams_at_once),
                             Teams{functor, begin, end, _words});
    } else {
      _sum += sumOver<Value>(label, space, begin, end, functor);
    }
  }
  // Sends the sum on its way to the host, after the last add().
  void send(const exec_space& space) {
    if constexpr (on_device)
      Kokkos::deep_copy(space, _staged, _words);
  }
  // The sum that was sent. Waits for the device.
  Value read(const exec_space& space) {
    if constexpr (on_device) {
      space.fence();
      memcpy(static_cast<void*>(&_sum), _staged.data(), sizeof _sum);
    }
    return _sum;
  }

private:
  Value _sum;
  View<std::int64_t*> _words;
  Kokkos::View<std::int64_t*, staging_space> _staged;
};

} // namespace brickwall
