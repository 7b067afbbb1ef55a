// Brickwall's search as the peer benchmark runs it: one object for the steps of a surface, and its
// pairs by global ids.
#pragma once

#include "contact/search/global_search.hpp"
#include "contact/search/local_search.hpp"
#include "verification/performance/peers/peers.hpp"

namespace brickwall::peers {

class OwnSearch {
public:
  OwnSearch(MPI_Comm comm, const contact::SearchConfig& config)
      : _global(comm, config), _local(_global) {}

  // Collective. One step from coordinates to candidate pairs: boxes, ghosts, local search. Fences.
  void search(const exec_space& space, const contact::Surface& surface);

  // Pairs of the last search in any order, and the pairs of each node with the faces it belongs to.
  // The search excludes the latter by connectivity; peers find them, since their boxes always
  // overlap.
  std::vector<IdPair> pairsWithOwnFaces(const contact::Surface& surface) const;

  const contact::GlobalSearch& global() const { return _global; }
  const contact::CandidatePairs& candidates() const { return _local.pairs(); }

private:
  contact::GlobalSearch _global;
  contact::LocalSearch _local;
};

// The differences of one set of pairs from another.
struct PairDifference {
  std::int64_t missing = 0, extra = 0, repeated = 0;
};

// Collective. Compares `found` with `expected` over all ranks; sorts both. A pair that `found`
// lists twice counts as repeated.
PairDifference comparePairs(MPI_Comm comm, std::vector<IdPair>& expected,
                            std::vector<IdPair>& found);

} // namespace brickwall::peers
