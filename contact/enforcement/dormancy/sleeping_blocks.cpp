#include "contact/enforcement/dormancy/sleeping_blocks.hpp"

namespace brickwall::contact {

SleepingBlocks::SleepingBlocks(const exec_space& space, const std::string& label, int num_nodes)
    : _num_blocks(dividedUp(num_nodes, CandidatePairs::rows_per_block)), _num_awake(_num_blocks),
      _counted(label + "::num_awake") {
  const auto n = static_cast<std::size_t>(_num_blocks);
  _state.num_bounds = allocate<View<unsigned char*>>(space, label + "::num_bounds", n);
  // the first putToSleep() allocates them
  _state.bounds = View<SeparationBound*>(label + "::bounds", 0);
  _state.age = View<unsigned char*>(label + "::age", n);
  _state.wait = View<unsigned char*>(label + "::wait", n);
  _state.next_wait = View<unsigned char*>(label + "::patience", n);
  Kokkos::deep_copy(space, _state.num_bounds, SleepState::awake);
}

void SleepingBlocks::wake(const exec_space& space, const CandidatePairs& pairs,
                          const SurfaceMotion& motion, bool is_unchanged) {
  const SeenRows::Comparison rows = _seen.see(pairs);
  const bool are_same = rows.are_same;
  if (!rows.are_known) {
    Kokkos::deep_copy(space, _state.num_bounds, SleepState::awake);
    _num_awake = _num_blocks;
    _is_counting = false;
  }
  const bool has_slept = _state.bounds.extent(0) > 0;
  // A search may add pairs at nodes at rest, since boxes kept with a margin were left before.
  if (!rows.are_known || (is_unchanged && are_same) || !has_slept)
    return;
  const SleepState state = _state;
  const View<const unsigned char*> changed = pairs.changed;
  const BodyMotions& motions = motion.bodies();
  const double rounding = motion.rounding();
  Kokkos::parallel_reduce(
      "contact::SleepingBlocks::wake", rangePolicy(space, _num_blocks),
      KOKKOS_LAMBDA(const std::int64_t block, std::int64_t& awake) {
        const int count = state.num_bounds(block);
        if (count == SleepState::awake) {
          ++awake;
          return;
        }
        bool sleeps = are_same || changed(block) == 0;
        for (int b = 0; b < count && sleeps; ++b)
          sleeps = state.bound(block, b).holds(motions, rounding);
        constexpr int soon = 16; // steps after which the search for bounds has paid off
        if (sleeps) {
          state.age(block) = static_cast<unsigned char>(minOf(state.age(block) + 1, soon));
          return;
        }
        state.num_bounds(block) = SleepState::awake;
        ++awake;
        if (state.age(block) < soon)
          state.postpone(block);
        else
          state.next_wait(block) = 0;
      },
      Kokkos::Sum<std::int64_t, staging_space>(_counted));
  _is_counting = true;
  if (host_accessible)
    numAwake(space);
}

std::int64_t SleepingBlocks::numAwake(const exec_space& space) const {
  if (_is_counting) {
    space.fence();
    _num_awake = _counted();
    _is_counting = false;
  }
  return _num_awake;
}

} // namespace brickwall::contact
