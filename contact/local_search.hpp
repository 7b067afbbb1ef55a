// Local search: which own and ghost faces may each owned node touch in this step (node box overlaps face box).
#pragma once

#include "contact/bvh_query.hpp"
#include "contact/construct_boxes.hpp"
#include "contact/search_config.hpp"
#include "contact/surface.hpp"

namespace brickwall::contact {

class LocalSearch {
public:
  explicit LocalSearch(const SearchConfig& config) : _config(config) {}

  // The candidate pairs of this step; valid until the next call. A node's own faces (those that list its global id
  // as a corner) are never listed; with drop_same_body neither are faces of the node's body. `boxes` are those that the
  // global search made of `surface`, `ghosts` what it found. Not collective.
  const CandidatePairs& findCandidatePairs(const exec_space& space, const Surface& surface,
                                           const GhostFaces& ghosts, const SurfaceBoxes& boxes);

  const CandidatePairs& pairs() const { return _pairs; }
  // What pairs() tell their users from now on.
  void setStepTest(const StepTest& test) { _pairs.step_test = test; }

private:
  SearchConfig _config;
  View<Box*> _face_boxes; // [own faces, then ghosts], when there are ghosts
  Bvh _tree;
  QueryOrder _order;
  QueryResults _results;
  View<std::int64_t*> _offsets{"contact::LocalSearch::offsets", 0}; // [node + 1]
  CandidatePairs _pairs;
};

} // namespace brickwall::contact
