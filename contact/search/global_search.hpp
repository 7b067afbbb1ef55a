// Contact global search (paper, Fig. 4): finds the faces of other ranks that this rank's owned
// nodes may touch in this step, and copies them. Face f of rank r is ghosted to rank q != r if and
// only if the box of f overlaps the box of a node that q owns.
#pragma once

#include "contact/search/exchange/ghost_exchange.hpp"
#include "contact/search/exchange/search_phases.hpp"
#include "contact/surface/check_surface.hpp"
#include "contact/surface/search_config.hpp"
#include "contact/surface/surface.hpp"

#include <mpi.h>

#include <cstdint>
#include <memory>
#include <vector>

namespace brickwall::contact {

// A face of this rank of which another rank has a ghost.
struct SentFace {
  global_id face = 0;
  int destination = 0; // rank
};

// The implementation of a method.
std::unique_ptr<SearchPhases> makeSearchPhases(SearchMethod method);

class GlobalSearch {
public:
  // Collective; `comm` is copied, so that no message meets one of the host's. Throws InputError on
  // all ranks for a tolerance that is negative or not finite, or a configuration that differs
  // between ranks.
  GlobalSearch(MPI_Comm comm, const SearchConfig& config)
      : GlobalSearch(Communicator(comm), config) {}
  GlobalSearch(const Communicator& comm, const SearchConfig& config); // shares the caller's

  // Collective. The ghost faces of this step, in the order that GhostFaces states; valid until the
  // next call. Throws on all ranks together: PhysicsError, naming node and rank, when a coordinate
  // is not finite; InputError for a surface that checkSurface() refuses, at the first call and
  // after forget(), or that has changed without forget(). A change in place of less than a
  // sixteenth of the rows may be noticed up to 15 calls later.
  const GhostFaces& findGhosts(const exec_space& space, const SweptBoxes& surface) {
    return findGhosts(space, surface, false);
  }
  // The same in two parts, between which the caller searches for pairs: where the first need not
  // wait for the device, on one rank, the second does so, and throws what findGhosts() would throw.
  const GhostFaces& launchGhosts(const exec_space& space, const SweptBoxes& surface) {
    return findGhosts(space, surface, true);
  }
  void finishGhosts(const exec_space& space, const SweptBoxes& surface);

  // Collective. Adds the values of each ghost to the nodes of its owner's face: node_values(node of
  // corner j, xyz) += ghost_values(ghost, 3 * j + xyz), for the ghosts of the last findGhosts(), in
  // quanta. `face_to_nodes` [own face] may number the nodes differently from the surface. Integer
  // sums: exact in any order.
  void reverseSum(const exec_space& space, const View<const int* [4]>& face_to_nodes,
                  const View<const std::int64_t* [12]>& ghost_values,
                  const View<std::int64_t* [3]>& node_values);

  // Collective. ghost_values(ghost, 3 * corner + xyz) = node_values(surface node of its owner,
  // xyz), for the ghosts of the last findGhosts().
  void forward(const exec_space& space, const SweptBoxes& surface,
               const View<const double* [3]>& node_values, const View<double* [12]>& ghost_values);

  // Collective. Selects the ghosts whose flags [ghost] are not 0: forwardSelected() and
  // reverseSumSelected() are forward() and reverseSum() for these, until the next findGhosts().
  void selectGhosts(const exec_space& space, const View<const unsigned char*>& flags) {
    _selection.select(space, _comm, _phases->facesToSend(), _migration, flags);
  }
  const GhostSelection& selection() const { return _selection; }
  void reverseSumSelected(const exec_space& space, const View<const int* [4]>& face_to_nodes,
                          const View<const std::int64_t* [12]>& ghost_values,
                          const View<std::int64_t* [3]>& node_values) {
    _selection.reverseSum(space, _comm, face_to_nodes, ghost_values, node_values);
  }
  void forwardSelected(const exec_space& space, const SweptBoxes& surface,
                       const View<const double* [3]>& node_values,
                       const View<double* [12]>& ghost_values) {
    _selection.forward(space, _comm, surface.face_to_nodes, node_values, ghost_values);
  }

  // Collective among partners. Copies the present coordinates x^n and x^{n+1} of the owners'
  // surfaces to ghosts(); all else of the surfaces must be as in the last findGhosts().
  void forwardCoordinates(const exec_space& space, const SweptBoxes& surface);

  // Own faces of which the last findGhosts() sent ghosts, by rank.
  const PartnerLists& facesToSend() const { return _phases->facesToSend(); }
  // The faces that the last findGhosts() sent, by destination, and for each destination in the
  // order of its ghosts; `surface` as in that call. Not collective; copies the faces sent to the
  // host.
  std::vector<SentFace> sentFaces(const exec_space& space, const SweptBoxes& surface) const;

  const GhostFaces& ghosts() const { return _migration.ghosts; }
  SearchStatistics statistics() const; // of the last findGhosts() on this rank
  // How often the surface was put in order since the start; 0 for methods that keep the order of
  // the host.
  std::int64_t numOrderings() const { return _phases->numOrderings(); }
  std::int64_t numRankBoxExchanges() const { return _num_rank_box_exchanges; } // since the start
  const SearchConfig& config() const { return _config; }
  // From the next findGhosts() on, which throws as the constructor does; all else of the
  // configuration stays.
  void setTolerances(double node_tolerance, double face_tolerance) {
    _config.node_tolerance = node_tolerance;
    _config.face_tolerance = face_tolerance;
    _has_agreed = false;
  }
  // Allows the next findGhosts() another surface, on one rank or more.
  void forget() {
    _check.forget();
    _phases->forget();
  }
  // Not collective. Whether `surface` has the counts of the last findGhosts(), Views that are long
  // enough and, where these are other Views, the same content.
  bool isSame(const exec_space& space, const SweptBoxes& surface) {
    return _check.isSame(space, surface);
  }

private:
  friend class LocalSearch;

  const GhostFaces& findGhosts(const exec_space& space, const SweptBoxes& surface,
                               bool pairs_follow);
  void updateRankBoxes(const exec_space& space, const SweptBoxes& surface, bool may_wait_later);
  void exchangeBoxes(const SweptBoxes& surface, const OwnRankBoxes& own);
  void checkInput(const exec_space& space, const SweptBoxes& surface, bool is_same);

  Communicator _comm;
  SearchConfig _config;
  bool _has_agreed = false; // on _config
  SurfaceCheck _check;
  std::unique_ptr<SearchPhases> _phases; // never null
  RankBoxes _rank_boxes; // phase 2
  bool _awaits_boxes = false; // finishGhosts() reads them
  std::int64_t _num_rank_box_exchanges = 0;
  FaceMigration _migration; // phase 6
  GhostSelection _selection;
};

} // namespace brickwall::contact
