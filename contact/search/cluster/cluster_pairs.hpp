// Local search of the cluster method: every cluster of nodes traverses the tree of faces and that
// of the ghosts once.
#pragma once

#include "contact/base/sum_over.hpp"
#include "contact/search/cluster/groups_to_search.hpp"
#include "contact/search/cluster/surface_clusters.hpp"

#include <functional>
#include <optional>

namespace brickwall::contact {

struct FindRows;

// The result of a search on this rank.
struct PairCounts {
  std::int64_t pairs = 0;
  std::int64_t overflowed = 0; // clusters whose rows exceeded their capacity
  std::int64_t largest = 0; // most pairs of one cluster, among those with long rows or ghosts
  std::int64_t skipped = 0; // rows that FindRowsOfGroups leaves to FindRows
  std::int64_t blocks = 0; // of the face tree that were tested or found near by groups

  KOKKOS_INLINE_FUNCTION PairCounts& operator+=(const PairCounts& b) {
    pairs += b.pairs;
    overflowed += b.overflowed;
    largest = maxOf(largest, b.largest);
    skipped += b.skipped;
    blocks += b.blocks;
    return *this;
  }
};

// Groups of nodes that the threads of a search on a device take one after another.
struct GroupQueue {
  View<std::int64_t*> num_taken{"contact::GroupQueue::num_taken", 1}; // in all searches
  std::int64_t taken_before = 0; // the next search
};

class ClusterPairs {
public:
  // As LocalSearch::findCandidatePairs(); `clusters` were updated with `surface`. A cluster writes
  // its rows to the part of pairs.faces that it used in the last search. Its capacity is four faces
  // per node at first, later an eighth more than it needed; clusters that exceed it get a new part
  // and are searched again. On a device 32 clusters of one node search together (group_rows.hpp),
  // and `meanwhile`, if any, is called before the host waits for them. Returns the number of blocks
  // of the face tree that were tested.
  std::int64_t find(const exec_space& space, const SweptBoxes& surface, const GhostFaces& ghosts,
                    const SurfaceClusters& clusters, const SearchConfig& config,
                    const std::function<void()>& meanwhile, CandidatePairs& pairs);

  // Where 32 clusters search together, launches the search of the groups that are near no partner,
  // beside what is launched in `space` next. The next find() searches the others only, unless
  // forgetBegun() is called before.
  void begin(const exec_space& space, const SweptBoxes& surface, const SurfaceClusters& clusters,
             const SearchConfig& config, const GroupsNearPartners& near_partners,
             CandidatePairs& pairs);
  void forgetBegun();

private:
  // Lays out the rows of a search, which get another version.
  void startRows(const exec_space& space, const SurfaceClusters& clusters, CandidatePairs& pairs);
  FindRows findRows(const SweptBoxes& surface, const GhostFaces& ghosts, const BoxTree& ghost_tree,
                    const SurfaceClusters& clusters, const SearchConfig& config,
                    const CandidatePairs& pairs) const;
  void startAnew(const exec_space& space, const SurfaceClusters& clusters, CandidatePairs& pairs);
  void growCapacity(const exec_space& space, int num_clusters, CandidatePairs& pairs);

  LaunchedSums<PairCounts> _counts;
  GroupQueue _queue;
  GroupsToSearch _groups; // of the next find(): not all from begin() on
  std::optional<exec_space> _beside; // of the groups that begin() takes
  QueueMark _has_boxes, _has_begun;
  BoxForest _ghost_forest;
  View<int*> _capacity{"contact::ClusterPairs::capacity", 0}; // [cluster] entries of pairs.faces
  View<std::int64_t*> _places{"contact::ClusterPairs::places", 0}; // [cluster + 1]
  View<int*> _num_kept_hits{"contact::ClusterPairs::num_kept_hits", 0}; // KeptHits
  View<unsigned*> _kept_hits{"contact::ClusterPairs::kept_hits", 0};
  std::int64_t _used = 0; // entries of pairs.faces that belong to a cluster
  std::int64_t _ordering = -1; // of the clusters for which the rows are laid out
};

} // namespace brickwall::contact
