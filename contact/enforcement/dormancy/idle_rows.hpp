// Rows of candidates that a step need not test: those of stationary nodes whose pairs were apart,
// and those of dormant blocks.
#pragma once

#include "contact/enforcement/dormancy/sleeping_blocks.hpp"
#include "contact/enforcement/dormancy/stationary_nodes.hpp"

namespace brickwall::contact {

// For kernels.
struct IdleState {
  StationaryFlags stationary;
  SleepState sleep;
  bool has_asleep = false; // otherwise `sleep` is not read

  KOKKOS_INLINE_FUNCTION bool sleeps(std::int64_t block) const {
    return has_asleep && sleep.sleeps(block);
  }
};

class IdleRows {
public:
  IdleRows() = default;
  // See StationaryNodes.
  IdleRows(const exec_space& space, const std::string& label, const SweptBoxes& surface,
           const View<const int*>& point_to_node = {})
      : _stationary(label, surface, point_to_node), _sleeping(space, label, surface.num_nodes) {}

  // At the start of a step; `motion` must include it. Ghosts of other ranks may have moved.
  void update(const exec_space& space, const SweptBoxes& surface, const SurfaceMotion& motion,
              const CandidatePairs& pairs, bool has_ghosts) {
    _stationary.update(space, surface, motion, pairs.step_test);
    _sleeping.wake(space, pairs, motion, isUnchanged() && !has_ghosts);
  }
  // After the other rows have been tested; `row_count` [node]: contacts of the present step.
  template <class Kinematics>
  void putToSleep(const exec_space& space, const Kinematics& kinematics, const FaceAccess& faces,
                  const CandidatePairs& pairs, const SurfaceMotion& motion,
                  const View<const int*>& row_count) {
    _sleeping.putToSleep(space, kinematics, faces, pairs, motion, row_count,
                         _stationary.flags().known_apart);
  }

  IdleState state() const {
    return {_stationary.flags(), _sleeping.state(), _sleeping.mayHaveAsleep()};
  }
  // Whether no pair can have come into contact, if there are no ghosts.
  bool areAll() const { return isUnchanged() || _sleeping.areAllAsleep(); }
  bool isUnchanged() const { return _stationary.isUnchanged(); } // see StationaryNodes
  const SleepingBlocks& sleeping() const { return _sleeping; }

private:
  StationaryNodes _stationary;
  SleepingBlocks _sleeping;
};

} // namespace brickwall::contact
