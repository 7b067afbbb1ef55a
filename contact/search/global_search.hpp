// Contact global search (paper, Fig. 4): which off-rank faces may this rank's owned nodes touch in this step, and
// copies of them. Face f of rank r goes to rank q != r if and only if the box of f overlaps the box of a node that q
// owns.
#pragma once

#include "contact/search/cluster/block_ghost_search.hpp"
#include "contact/search/cluster/cluster_candidates.hpp"
#include "contact/search/cluster/surface_clusters.hpp"
#include "contact/search/exchange/face_migration.hpp"
#include "contact/search/exchange/node_box_exchange.hpp"
#include "contact/search/exchange/rank_boxes.hpp"
#include "contact/search/paper/face_ghost_search.hpp"
#include "contact/search/paper/ghosting_candidates.hpp"
#include "contact/surface/construct_boxes.hpp"
#include "contact/surface/search_config.hpp"
#include "contact/surface/surface.hpp"

#include <mpi.h>

#include <vector>

namespace brickwall::contact {

// A face of this rank of which another rank has a ghost.
struct SentFace {
  global_id face = 0;
  int destination = 0; // rank
};

class GlobalSearch {
public:
  // `comm` must outlive the search. Throws InputError for a negative or non-finite tolerance.
  GlobalSearch(MPI_Comm comm, const SearchConfig& config);

  // Collective. The ghost faces of this step, in the order that GhostFaces states; valid until the next call.
  // Throws PhysicsError on all ranks together, naming node and rank, when a coordinate is not finite.
  const GhostFaces& findGhosts(const exec_space& space, const Surface& surface);

  // Collective. Adds each ghost's values to the nodes of its owner's face: node_values(node of corner j, xyz) +=
  // ghost_values(ghost, 3 * j + xyz), for the ghosts of the last findGhosts(), in quanta. `face_to_nodes` [own face] may be other
  // numbers than the surface's. Integer sums: exact, any order.
  void reverseSum(const exec_space& space, const View<const int* [4]>& face_to_nodes,
                  const View<const std::int64_t* [12]>& ghost_values,
                  const View<std::int64_t* [3]>& node_values);

  // Collective. ghost_values(ghost, 3 * corner + xyz) = node_values(surface node of its owner, xyz), for the ghosts of
  // the last findGhosts().
  void forward(const exec_space& space, const Surface& surface,
               const View<const double* [3]>& node_values, const View<double* [12]>& ghost_values);

  // Collective among partners. Gives ghosts() the present coordinates, x^n and x^{n+1}, of their owners' surfaces, which are
  // otherwise as in the last findGhosts().
  void forwardCoordinates(const exec_space& space, const Surface& surface);

  // The faces that the last findGhosts() sent, by destination, within one in the order in which its ghosts lie there;
  // `surface` as it was given then. Not collective; copies what was sent to the host.
  std::vector<SentFace> sentFaces(const exec_space& space, const Surface& surface) const;

  // Boxes of the last findGhosts(), for the local search of methods `paper` and `reference`.
  const SurfaceBoxes& boxes() const { return _boxes; }
  // The surface in order and its boxes of the last findGhosts(), of method `cluster`.
  const SurfaceClusters& clusters() const { return _clusters; }
  SurfaceClusters& clusters() { return _clusters; }
  const GhostFaces& ghosts() const { return _migration.ghosts; }
  SearchStatistics statistics() const; // of the last findGhosts(), this rank's
  const SearchConfig& config() const { return _config; }
  // For the next findGhosts(); the method must stay. The same on all ranks.
  void configure(const SearchConfig& config) { _config = config; }

private:
  void findByClusters(const exec_space& space, const Surface& surface);
  void findByBoxes(const exec_space& space, const Surface& surface);
  const PartnerLists& facesToSend() const { // L_ges
    return _config.method == SearchMethod::cluster ? _block_search.faces_to_send
                                                   : _ghost_search.faces_to_send;
  }

  MPI_Comm _comm;
  SearchConfig _config;
  RankBoxes _rank_boxes; // phase 2
  FaceMigration _migration; // phase 6
  // `cluster`
  SurfaceClusters _clusters; // phase 1
  ClusterCandidates _cluster_candidates; // phase 3
  PartnerMessages _node_boxes; // phase 4
  BlockGhostSearch _block_search; // phase 5
  // `paper` and `reference`
  SurfaceBoxes _boxes; // phase 1
  GhostingCandidates _candidates; // phase 3
  RemoteNodeBoxes _remote_nodes; // phase 4
  FaceGhostSearch _ghost_search; // phase 5
};

} // namespace brickwall::contact
