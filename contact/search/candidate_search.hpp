// The interface for host codes: global and local search together. With a margin, lists are kept
// over several steps without missing a pair of any step (theory.md, section 2, eq. (3), and its
// proof there).
#pragma once

#include "contact/search/audit/pair_audit.hpp"
#include "contact/search/global_search.hpp"
#include "contact/search/local_search.hpp"

#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace brickwall::contact {

// The distance by which x lies outside of [low, high] along the axis where it is greatest; negative
// inside, infinite if x is not finite.
KOKKOS_INLINE_FUNCTION double excursionOutside(const Vec3& x, const Vec3& low, const Vec3& high) {
  double largest = maxOf(low[0] - x[0], x[0] - high[0]);
  for (int d = 1; d < 3; ++d)
    largest = maxOf(largest, maxOf(low[d] - x[d], x[d] - high[d]));
  const double zero = (x[0] - x[0]) + (x[1] - x[1]) + (x[2] - x[2]); // or NaN
  return zero == 0 ? largest : HUGE_VAL;
}
// The same for a row of sweptBoxes() and both configurations.
KOKKOS_INLINE_FUNCTION double excursionOutside(const View<const double* [6]>& boxes,
                                               std::int64_t node, const Vec3& x_old,
                                               const Vec3& x_new) {
  const Vec3 low = {boxes(node, 0), boxes(node, 1), boxes(node, 2)};
  const Vec3 high = {boxes(node, 3), boxes(node, 4), boxes(node, 5)};
  return maxOf(excursionOutside(x_old, low, high), excursionOutside(x_new, low, high));
}

class CandidateSearch {
public:
  // Collective; `comm` is copied, so that no message meets one of the host's. `margin` (length, the
  // same on all ranks): boxes are inflated by half of it, and ghosts and pairs are kept until nodes
  // have left their swept boxes by half of it; with 0 every step searches. Throws InputError on all
  // ranks for a tolerance or a margin that is negative or not finite, or a configuration or margin
  // that differs between ranks.
  CandidateSearch(MPI_Comm comm, const SearchConfig& config, double margin = 0);
  CandidateSearch(const CandidateSearch&) = delete;
  CandidateSearch& operator=(const CandidateSearch&) = delete;

  // Collective. Ghosts and candidate pairs of this step; valid until the next call. With a margin
  // the pairs include those of a search in this step, and others, which CandidatePairs::step_test
  // distinguishes; the order of rows is that of the last search. Ghosts have the coordinates of
  // this step; all other data are those of the last search. A step without a search reads the
  // coordinates once, reduces one number over ranks and sends one message per partner. Between
  // calls only coordinates may change, in any way, unless forget() is called. Throws PhysicsError
  // and InputError as GlobalSearch::findGhosts(); steps without a search notice other counts, Views
  // that are too short, and other Views with other content.
  // `motion`, from a host that reads the coordinates in any case, is the greatest
  // excursionOutside() of this rank's nodes from sweptBoxes(), in either configuration of the step;
  // any number if there are no such boxes. Without it, update() measures the nodes that
  // `stationary` [node] does not flag. A flag that is not 0 states that both configurations of the
  // node equal coordinates_new of the last update(). `meanwhile` may be called, once: it launches
  // work that does not need the pairs, in another queue, while the device may still be busy with
  // what was launched before.
  const CandidatePairs& update(const exec_space& space, const SweptBoxes& surface,
                               std::optional<double> motion = {},
                               const std::function<void()>& meanwhile = {},
                               const View<const unsigned char*>& stationary = {});
  // [node][low xyz, high xyz] of the last search while its lists may be kept, otherwise empty.
  View<const double* [6]> sweptBoxes() const {
    return _has_lists && _margin > 0 ? _searched_at : View<double* [6]>();
  }

  // Collective. The same without pairs, for hosts that need only the ghosts.
  const GhostFaces& updateGhosts(const exec_space& space, const SweptBoxes& surface,
                                 std::optional<double> motion = {},
                                 const View<const unsigned char*>& stationary = {});

  // To be called, on one rank or more, when something of the surface besides its coordinates has
  // changed: the next update() searches on all ranks, whatever the motion, and sorts the surface
  // again.
  void forget() {
    _has_lists = false;
    _global.forget();
  }

  // Sets the tolerances of SearchConfig from the next update() on, the same on all ranks. It
  // searches if they have changed; it throws InputError on all ranks if one is negative, not finite
  // or differs between ranks.
  void setTolerances(double node_tolerance, double face_tolerance);

  const GhostFaces& ghosts() const { return _global.ghosts(); }
  const CandidatePairs& pairs() const { return _local.pairs(); }

  // Collective. Restores the lists and counts of an earlier run: `surface` as for update(), but
  // with the low and the high corners of that run's sweptBoxes() as coordinates_old and
  // coordinates_new. With empty coordinates there were no lists to keep, and the next update()
  // searches.
  void restore(const exec_space& space, const SweptBoxes& surface, std::int64_t searches,
               std::int64_t updates);

  // Collective; as GlobalSearch, for the ghosts of the last update().
  void reverseSum(const exec_space& space, const View<const int* [4]>& face_to_nodes,
                  const View<const std::int64_t* [12]>& ghost_values,
                  const View<std::int64_t* [3]>& node_values) {
    _global.reverseSum(space, face_to_nodes, ghost_values, node_values);
  }
  void forward(const exec_space& space, const SweptBoxes& surface,
               const View<const double* [3]>& node_values, const View<double* [12]>& ghost_values) {
    _global.forward(space, surface, node_values, ghost_values);
  }
  void selectGhosts(const exec_space& space, const View<const unsigned char*>& flags) {
    _global.selectGhosts(space, flags);
  }
  const GhostSelection& selection() const { return _global.selection(); }
  void reverseSumSelected(const exec_space& space, const View<const int* [4]>& face_to_nodes,
                          const View<const std::int64_t* [12]>& ghost_values,
                          const View<std::int64_t* [3]>& node_values) {
    _global.reverseSumSelected(space, face_to_nodes, ghost_values, node_values);
  }
  void forwardSelected(const exec_space& space, const SweptBoxes& surface,
                       const View<const double* [3]>& node_values,
                       const View<double* [12]>& ghost_values) {
    _global.forwardSelected(space, surface, node_values, ghost_values);
  }

  // Collective. The number of pairs over all ranks that pairs() lacks, by comparison with all pairs
  // (pair_audit.hpp); `surface` as in the last update().
  std::int64_t countMissedPairs(const exec_space& space, const SweptBoxes& surface) const {
    return contact::countMissedPairs(space, _comm, surface, ghosts(), pairs(), _config);
  }

  // Those of which the last search sent ghosts, by rank.
  const PartnerLists& facesToSend() const { return _global.facesToSend(); }
  // The faces of this rank that the last search sent as ghosts, with their destinations, copied to
  // the host. Not collective.
  std::vector<SentFace> sentFaces(const exec_space& space, const SweptBoxes& surface) const {
    return _global.sentFaces(space, surface);
  }

  SearchStatistics statistics() const { return _global.statistics(); } // of the last search
  std::int64_t updates() const { return _updates; } // since the start
  std::int64_t searches() const {
    return _searches;
  } // number of updates that searched and threw nothing
  // The number of searches that exchanged the rank boxes of all ranks, since the construction.
  std::int64_t rankBoxExchanges() const { return _global.numRankBoxExchanges(); }
  double margin() const { return _margin; }

private:
  void applyTolerances();
  // Brings the lists of the last search to this step, or calls search().
  template <class Search>
  void keepOrSearch(const exec_space& space, const SweptBoxes& surface,
                    std::optional<double> motion, const View<const unsigned char*>& stationary,
                    const Search& search);
  bool mayKeepLists(const exec_space& space, const SweptBoxes& surface,
                    std::optional<double> motion, const View<const unsigned char*>& stationary);

  Communicator _comm;
  SearchConfig _config; // of a step, without the margin
  double _margin;
  double _allowed_motion = 0; // of a node out of its swept box of the last search, along any axis
  GlobalSearch _global;
  LocalSearch _local;
  bool _has_lists = false, _has_pairs = false; // of the last search
  // Swept boxes of the last search: [node][low xyz, high xyz].
  View<double* [6]> _searched_at { "contact::CandidateSearch::searched_at", 0 };
  std::int64_t _updates = 0, _searches = 0;
};

} // namespace brickwall::contact
