// Local search: finds the own and ghost faces that each owned node may touch in this step (node box
// overlaps face box).
#pragma once

#include "contact/base/region.hpp"
#include "contact/search/global_search.hpp"

#include <functional>

namespace brickwall::contact {

// The local search of a global search, whose boxes, order and configuration it uses.
class LocalSearch {
public:
  // `global` must outlive the local search.
  explicit LocalSearch(GlobalSearch& global) : _global(global) {}

  // The candidate pairs of this step; valid until the next call. A node's own faces (those that
  // list its global id as a corner) are never listed; with drop_same_body neither are faces of the
  // node's body. The global search has found the ghosts of this step. Not collective.
  // `meanwhile`: see SearchPhases.
  const CandidatePairs& findCandidatePairs(const exec_space& space, const SweptBoxes& surface,
                                           const std::function<void()>& meanwhile = {}) {
    const Region region("contact::findCandidatePairs");
    const Region timer("contact::search::local_search");
    _global._phases->meanwhile = meanwhile;
    _global._phases->findPairs(space, surface, _global.ghosts(), _global.config());
    return pairs();
  }

  const CandidatePairs& pairs() const { return _global._phases->pairs(); }
  // The step test that pairs() carry from now on.
  void setStepTest(const StepTest& test) { _global._phases->pairs().step_test = test; }

private:
  GlobalSearch& _global;
};

} // namespace brickwall::contact
