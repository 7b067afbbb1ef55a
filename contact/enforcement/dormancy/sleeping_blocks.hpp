// Dormant blocks of rows of candidates. When a block was last tested, none of its pairs could be in
// contact, and the motion of the bodies since then, if any, cannot have brought any of them into
// contact, by the bounds kept then (separation.hpp). A block wakes when its bounds are exhausted or
// when a search has changed its rows: a new pair has no bound.
//
// `Kinematics` provides the geometry (node_face_separation.hpp or edge_separation.hpp). Blocks with
// ghosts do not sleep, since the motion of other ranks is unknown here, nor do rows with a contact.
#pragma once

#include "contact/enforcement/dormancy/separation.hpp"
#include "contact/surface/face_access.hpp"
#include "contact/surface/seen_rows.hpp"

namespace brickwall::contact {

constexpr int max_bounds = 6; // pairs of bodies in a block; blocks with more do not sleep

// State of the blocks for kernels, one entry a block.
struct SleepState {
  static constexpr unsigned char awake = 255;

  View<unsigned char*> num_bounds; // `awake`, or the number of bounds of a dormant block
  // First bounds of all blocks, then the second ones, and so on, since few blocks have many.
  View<SeparationBound*> bounds;
  // Blocks whose bounds cannot be found, or are exhausted soon, are not tried again for `wait`
  // steps; the wait doubles each time, up to a limit.
  View<unsigned char*> age, wait, next_wait;

  KOKKOS_INLINE_FUNCTION SeparationBound& bound(std::int64_t block, int b) const {
    return bounds(b * static_cast<std::int64_t>(num_bounds.extent(0)) + block);
  }
  KOKKOS_INLINE_FUNCTION bool sleeps(std::int64_t block) const {
    return num_bounds(block) != awake;
  }
  KOKKOS_INLINE_FUNCTION void postpone(std::int64_t block) const {
    constexpr int longest = 31;
    const int now = next_wait(block);
    wait(block) = next_wait(block) = static_cast<unsigned char>(minOf(2 * now + 1, longest));
  }
};

class SleepingBlocks {
public:
  SleepingBlocks() = default;
  SleepingBlocks(const exec_space& space, const std::string& label, int num_nodes);

  // At the start of a step: wakes the blocks that must be tested. `motion` must include this step.
  // `is_unchanged`: nothing has moved in this step and in the last one, and there are no ghosts;
  // rows gain pairs then by a search only.
  void wake(const exec_space& space, const CandidatePairs& pairs, const SurfaceMotion& motion,
            bool is_unchanged);

  // After the blocks that are awake have been tested: puts those to sleep whose pairs are apart.
  // `row_count` [node]: contacts of the present step. `known_apart`, see StationaryFlags, is reset
  // for dormant rows.
  template <class Kinematics>
  void putToSleep(const exec_space& space, const Kinematics& kinematics, const FaceAccess& faces,
                  const CandidatePairs& pairs, const SurfaceMotion& motion,
                  const View<const int*>& row_count, const View<unsigned char*>& known_apart);

  const SleepState& state() const { return _state; }
  // Whether a block may be asleep, and whether all are known to be; neither waits for a device.
  bool mayHaveAsleep() const { return _is_counting || _num_awake < _num_blocks; }
  bool areAllAsleep() const { return !_is_counting && _num_awake == 0; }
  // Waits for the device after wake().
  std::int64_t numAwake(const exec_space& space) const;
  std::int64_t numBlocks() const { return _num_blocks; }

private:
  SleepState _state;
  std::int64_t _num_blocks = 0;
  mutable std::int64_t _num_awake = 0;
  mutable bool _is_counting = false; // _counted holds _num_awake once the device is done
  Kokkos::View<std::int64_t, staging_space> _counted;
  SeenRows _seen;
};

// Kernel functor of putToSleep(), for one block.
template <class Kinematics>
struct FindBounds {
  Kinematics kinematics;
  FaceAccess faces;
  CandidatePairs pairs;
  BodyMotions motions;
  double rounding;
  View<const int*> row_count;
  View<unsigned char*> known_apart;
  SleepState state;

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t block) const {
    if (state.sleeps(block))
      return;
    if (state.wait(block) > 0) {
      --state.wait(block);
      return;
    }
    const std::int64_t begin = block * CandidatePairs::rows_per_block;
    const std::int64_t end =
        minOf<std::int64_t>(begin + CandidatePairs::rows_per_block, pairs.num_rows);
    SeparationBound bounds[max_bounds];
    int count = 0;
    for (std::int64_t row = begin; row < end; ++row)
      if (!isWithoutContact(row) || !includeRow(row, bounds, count)) {
        state.postpone(block);
        return;
      }
    for (int b = 0; b < count; ++b)
      state.bound(block, b) = bounds[b];
    state.num_bounds(block) = static_cast<unsigned char>(count);
    state.age(block) = 0;
    for (std::int64_t row = begin; row < end; ++row)
      known_apart(pairs.node(row)) = 0;
  }

private:
  KOKKOS_INLINE_FUNCTION bool isWithoutContact(std::int64_t row) const {
    return row_count(pairs.node(row)) == 0;
  }
  KOKKOS_INLINE_FUNCTION bool includeRow(std::int64_t row, SeparationBound (&bounds)[max_bounds],
                                         int& count) const {
    const std::int64_t end = pairs.end(row);
    if (pairs.begin(row) == end)
      return true;
    const int node = pairs.node(row);
    const auto around = surroundingsOf(kinematics, faces, node);
    const int own = motions.find(faces.surface.node_body(node));
    global_id body = -1;
    int other = -1, side = 1;
    SeparationBound* bound = nullptr;
    for (std::int64_t p = pairs.begin(row); p < end; ++p) {
      const int face = pairs.faces(p);
      if (!faces.isOwn(face))
        return false;
      const Separation separation = separationOf(kinematics, faces, around, node, face);
      const bool has_bound = separation.holds() && separation.gap > rounding;
      if (!has_bound && !known_apart(node))
        return false;
      if (bound == nullptr || faces.body(face) != body) {
        body = faces.body(face);
        other = motions.find(body);
        if (own < 0 || other < 0)
          return false;
        side = own <= other ? 1 : -1;
        bound = boundOf(minOf(own, other), maxOf(own, other), bounds, count);
        if (bound == nullptr)
          return false;
      }
      if (!has_bound && !(motions.is_at_rest(own) && motions.is_at_rest(other)))
        return false;
      bound->include(has_bound ? separation : Separation(), side);
    }
    return true;
  }
  KOKKOS_INLINE_FUNCTION SeparationBound*
  boundOf(int first, int second, SeparationBound (&bounds)[max_bounds], int& count) const {
    for (int b = 0; b < count; ++b)
      if (bounds[b].body[0] == first && bounds[b].body[1] == second)
        return &bounds[b];
    if (count == max_bounds)
      return nullptr;
    bounds[count].start(motions, first, second);
    return &bounds[count++];
  }
};

template <class Kinematics>
void SleepingBlocks::putToSleep(const exec_space& space, const Kinematics& kinematics,
                                const FaceAccess& faces, const CandidatePairs& pairs,
                                const SurfaceMotion& motion, const View<const int*>& row_count,
                                const View<unsigned char*>& known_apart) {
  // Rows by themselves, on a device, sleep only if lists are kept for several steps.
  const bool rows_last = CandidatePairs::rows_per_block > 1 || pairs.step_test.is_needed;
  if (pairs.version == 0 || !rows_last || numAwake(space) == 0)
    return;
  if (_state.bounds.extent(0) == 0)
    _state.bounds =
        allocate<View<SeparationBound*>>(space, _state.bounds.label(), max_bounds * _num_blocks);
  constexpr int chunk = 64; // blocks without rows, or asleep, follow each other
  Kokkos::parallel_for("contact::SleepingBlocks::putToSleep",
                       dynamicPolicy(space, _num_blocks, chunk),
                       FindBounds<Kinematics>{kinematics, faces, pairs, motion.bodies(),
                                              motion.rounding(), row_count, known_apart, _state});
}

} // namespace brickwall::contact
