// Blocks of rows of candidates that need not be looked at: when they were, none of their pairs could touch, and by the bounds that
// were kept then (separation.hpp), the motion of the bodies since does not bring any of them to it. A block wakes when its bounds
// are used up, or when its rows have changed since the last search: a pair that was not listed then has no bound.
//
// `Touch` knows the geometry: with node_face_separation.hpp or edge_separation.hpp. Blocks with ghosts do not sleep, for other
// ranks' motion is not known here, nor do rows with a contact.
#pragma once

#include "contact/enforcement/dormancy/sleep_state.hpp"
#include "contact/surface/face_access.hpp"

namespace brickwall::contact {

class SleepingBlocks {
public:
  SleepingBlocks() = default;
  SleepingBlocks(const exec_space& space, const std::string& label, int num_nodes);

  // At the start of a step: wakes the blocks that must be looked at. `motion` has seen this step. `is_unchanged`: nothing has moved
  // in it, nor in the last one; rows may then have become less, but not more.
  void wake(const exec_space& space, const CandidatePairs& pairs, const SurfaceMotion& motion,
            bool is_unchanged);

  // After the blocks that are awake have been looked at: puts to sleep those whose pairs are apart. `row_count` [node]
  // contacts of the present step; `clear` as of StationaryFlags, which is taken back from rows that sleep.
  template <class Kinematics>
  void putToSleep(const exec_space& space, const Kinematics& touch, const FaceAccess& faces,
                  const CandidatePairs& pairs, const SurfaceMotion& motion,
                  const View<const unsigned char*>& row_count,
                  const View<unsigned char*>& known_apart);

  const SleepState& state() const { return _state; }
  bool hasAsleep() const { return _num_awake < _num_blocks; }
  std::int64_t numAwake() const { return _num_awake; }
  std::int64_t numBlocks() const { return _num_blocks; }

private:
  SleepState _state;
  std::int64_t _num_blocks = 0, _num_awake = 0;
  std::int64_t _version = 0; // of the pairs that were seen last
  const unsigned char* _changed = nullptr; // of the same
};

// Kernel functor of putToSleep(): one block.
template <class Kinematics>
struct FindBounds {
  Kinematics touch;
  FaceAccess faces;
  CandidatePairs pairs;
  BodyMotions motions;
  double rounding;
  View<const unsigned char*> row_count;
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
    KeptBound bounds[max_bounds];
    int count = 0;
    for (std::int64_t row = begin; row < end; ++row)
      if (!isWithoutContact(row) || !includeRow(row, bounds, count)) {
        state.leaveAlone(block);
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
  KOKKOS_INLINE_FUNCTION bool includeRow(std::int64_t row, KeptBound (&bounds)[max_bounds],
                                         int& count) const {
    const std::int64_t end = pairs.end(row);
    if (pairs.begin(row) == end)
      return true;
    const int node = pairs.node(row);
    const auto around = surroundingsOf(touch, faces, node);
    const int own = motions.find(faces.surface.node_body(node));
    global_id body = -1;
    int other = -1, side = 1;
    KeptBound* bound = nullptr;
    for (std::int64_t p = pairs.begin(row); p < end; ++p) {
      const int face = pairs.faces(p);
      if (!faces.isOwn(face))
        return false;
      const Separation apart = separationOf(touch, faces, around, node, face);
      if (!(apart.holds() && apart.gap > rounding))
        return false;
      if (bound == nullptr || faces.surface.face_body(face) != body) {
        body = faces.surface.face_body(face);
        other = motions.find(body);
        if (own < 0 || other < 0)
          return false;
        side = own <= other ? 1 : -1;
        bound = boundOf(minOf(own, other), maxOf(own, other), bounds, count);
        if (bound == nullptr)
          return false;
      }
      bound->include(apart, side);
    }
    return true;
  }
  KOKKOS_INLINE_FUNCTION KeptBound* boundOf(int first, int second, KeptBound (&bounds)[max_bounds],
                                            int& count) const {
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
void SleepingBlocks::putToSleep(const exec_space& space, const Kinematics& touch,
                                const FaceAccess& faces, const CandidatePairs& pairs,
                                const SurfaceMotion& motion,
                                const View<const unsigned char*>& row_count,
                                const View<unsigned char*>& known_apart) {
  // Rows of one node a block that every step searches anew count as changed each time: the block would wake at once.
  const bool rows_last = CandidatePairs::rows_per_block > 1 || pairs.step_test.is_needed;
  if (_num_awake == 0 || pairs.version == 0 || !rows_last)
    return;
  if (_state.bounds.extent(0) == 0)
    _state.bounds =
        allocate<View<KeptBound*>>(space, _state.bounds.label(), max_bounds * _num_blocks);
  Kokkos::parallel_for("contact::SleepingBlocks::putToSleep", rangePolicy(space, _num_blocks),
                       FindBounds<Kinematics>{touch, faces, pairs, motion.bodies(),
                                              motion.rounding(), row_count, known_apart, _state});
}

} // namespace brickwall::contact
