// Local search: which own and ghost faces may each owned node touch in this step (node box overlaps face box).
#pragma once

#include "contact/search/cluster/cluster_pairs.hpp"
#include "contact/search/global_search.hpp"
#include "contact/search/spatial/bvh_query.hpp"

namespace brickwall::contact {

class LocalSearch {
public:
  explicit LocalSearch(const SearchConfig& config) : _config(config) {}
  // As GlobalSearch.
  void configure(const SearchConfig& config) { _config = config; }

  // The candidate pairs of this step; valid until the next call. A node's own faces (those that list its global id
  // as a corner) are never listed; with drop_same_body neither are faces of the node's body. `global` has found the
  // ghosts of this step with the same configuration; its boxes and, for `cluster`, its order are used. Not collective.
  const CandidatePairs& findCandidatePairs(const exec_space& space, const Surface& surface,
                                           const GlobalSearch& global);

  const CandidatePairs& pairs() const { return _pairs; }
  // What pairs() tell their users from now on.
  void setStepTest(const StepTest& test) { _pairs.step_test = test; }
  // Work of the last search; 0 but for `cluster`.
  const PairCounts& counts() const { return _clusters.counts(); }

private:
  void findByBoxes(const exec_space& space, const Surface& surface, const GhostFaces& ghosts,
                   const SurfaceBoxes& boxes);

  SearchConfig _config;
  CandidatePairs _pairs;
  ClusterPairs _clusters; // `cluster`
  // `paper` and `reference`
  View<Box*> _face_boxes; // [own faces, then ghosts], when there are ghosts
  Bvh _tree;
  QueryOrder _order;
  QueryResults _results;
  View<std::int64_t*> _offsets{"contact::LocalSearch::offsets", 0}; // [node + 1]
};

} // namespace brickwall::contact
