// Edge-to-edge contact of convex edges that cross between their nodes (edge_edge_kinematics.hpp),
// with the same search and the same interactions as node-to-face contact.
#pragma once

#include "contact/enforcement/dormancy/idle_rows.hpp"
#include "contact/enforcement/edge_edge/edge_surface.hpp"
#include "contact/enforcement/reports/largest_force.hpp"
#include "contact/enforcement/selection/interaction_set.hpp"
#include "contact/enforcement/selection/row_work.hpp"
#include "contact/enforcement/selection/touched_nodes.hpp"
#include "contact/search/audit/pair_motion.hpp"
#include "contact/search/candidate_search.hpp"
#include "contact/surface/features/feature_edges.hpp"

#include <cstdint>
#include <functional>

namespace brickwall::contact {

class EdgeContact {
public:
  // Collective. `edges`: findFeatureEdges() of `surface`; `node_mass`, `energy_scale`: see
  // Enforcement; `search`, `margin`: see CandidateSearch. Throws InputError as Enforcement.
  EdgeContact(const exec_space& space, MPI_Comm comm, const Surface& surface,
              const FeatureEdges& edges, const View<const double*>& node_mass,
              const SearchConfig& search, double margin, const EnforcementConfig& config,
              const Quantum& quantum, const LimbScale& energy_scale);

  // As CandidateSearch.
  void setTolerance(double tolerance) { _search.setTolerances(tolerance, tolerance); }

  // Collective. Finds edges that may cross in this step; `surface` as at construction, with the
  // coordinates of this step.
  void findCandidates(const exec_space& space, const Surface& surface) {
    gatherCoordinates(space, surface);
    findCandidates(space);
  }
  // The two parts of it, for work between them. The first does not wait for a device, and from its
  // second call on leaves out nodes that `stationary` flags as SurfaceMotion::twice.
  void gatherCoordinates(const exec_space& space, const Surface& surface,
                         const View<const unsigned char*>& stationary = {});
  void findCandidates(const exec_space& space);

  // The parts of Enforcement::enforce(), which calls them. `motion`, that of the host's surface,
  // must include this step if skip_stationary is set. select() works in a queue of its own
  // (queueBeside()), and the host must have waited for what it reads; the function that it returns
  // waits for it and completes the selection. Then ranks agree on whether edges
  // of any rank have forces; if not, the other functions do nothing. collectForces() is collective:
  // it adds the forces of all edges to `nodes` [surface node][xyz] in quanta, as partial sums.
  // proposeChanges(), collectProposals(), which is like collectForces() and leaves no proposals,
  // and correctForces() are collective; `has_changed` [surface node], hasProposals(), sendNotes()
  // and takeInvalid(): see InteractionSet.
  // addTouched() comes first and is collective: it adds the surface nodes that contacts of this
  // rank act on, and those of edges whose ghosts contacts of other ranks act on.
  std::function<ContactSums()> select(const exec_space& space, double dt,
                                      const SurfaceMotion& motion);
  void setHasForcesAnywhere(bool has_forces) { _has_forces_anywhere = has_forces; }
  void collectForces(const exec_space& space, const View<std::int64_t* [3]>& nodes);
  void proposeChanges(const exec_space& space, const StepLengths& steps,
                      const View<double* [3]>& node_accelerations,
                      const View<const unsigned char*>& has_changed);
  bool hasProposals(const exec_space& space) {
    return !canSkipCorrection() && _set.hasProposals(space);
  }
  void collectProposals(const exec_space& space, const View<std::int64_t* [3]>& nodes);
  // marks [surface node] = 1 at the nodes to which collectForces() and collectProposals() add.
  void markTouched(const exec_space& space, const View<unsigned char*>& marks) const;
  void correctForces(const exec_space& space, const StepLengths& steps,
                     const View<double* [3]>& node_responses);
  void sendNotes(const exec_space& space) {
    if (!canSkipCorrection())
      _set.sendNotes(space);
  }
  std::int64_t takeInvalid(const exec_space& space) { return _set.takeInvalid(space); }
  void addTouched(const exec_space& space, TouchedNodes& of_surface);
  void advance(double dt) { _set.advance(dt); }

  void setReferenceStep(double dt) { _set.setReferenceStep(dt); } // see Enforcement
  // The fastest pair of edges among the candidates of this step (pair_motion.hpp). Collective.
  PairMotion fastestPair(const exec_space& space, MPI_Comm comm, const Vec3& mean, double limit);
  // The largest force of the last step (largest_force.hpp). Collective.
  LargestForce largestForce(const exec_space& space, MPI_Comm comm) const {
    return largestEdgeForce(space, comm, _edges, _num_corners, _set.history());
  }
  // Missed pairs of edges (CandidateSearch::countMissedPairs). Collective.
  std::int64_t countMissedPairs(const exec_space& space) const {
    return _search.countMissedPairs(space, _edges);
  }

  bool hasForces() const {
    return _set.hasForces();
  } // in the present step, from contacts of this rank
  std::int64_t numEdges() const { return _edges.num_faces; } // of this rank
  const CandidateSearch& search() const { return _search; }
  const SleepingBlocks& sleeping() const { return _idle.sleeping(); } // see Enforcement
  const ContactHistory& history() const { return _set.history(); }
  // See Enforcement; the work of an edge stands at one of its nodes.
  void addWork(const exec_space& space, const View<std::int64_t**>& work) const;
  // Ids of the nodes that the history names: corners, then edges with ids of their own.
  View<const global_id*> nodeIds() const { return _edges.node_ids; }
  // As those of Enforcement.
  ContactCarry carry(const exec_space& space) const {
    return _set.carry(space, _edges.node_ids, _has_forces_anywhere);
  }
  void restore(const exec_space& space, const ContactCarry& carry);

private:
  FaceAccess access() const { return {_edges, _search.ghosts()}; }
  bool canSkipAll() const;
  void findTouched(const exec_space& space);
  bool canSkipCorrection() const {
    return !_has_forces_anywhere || (!hasOtherRanks() && !_set.hasForces());
  }
  void addToNodes(const exec_space& space, const ContactForces& of_corners,
                  const View<std::int64_t* [3]>& nodes);
  // Collective. The vectors of all corners, own and of ghosts.
  void toCorners(const exec_space& space, const View<double* [3]>& of_nodes,
                 const View<double* [3]>& own, View<double* [12]>& of_ghosts);
  // whether there are ghosts of other ranks' edges, or of these edges on other ranks
  bool hasOtherRanks() const;

  // Surface nodes: the corners of the listed faces, then one for each edge, which stands for its
  // box: x^n is the box's low corner, x^{n+1} its high one. Faces: the edges.
  SweptBoxes _edges;
  exec_space _beside; // the queue of select()
  int _num_corners = 0;
  View<const int*> _corner_to_node; // [corner] node of the host's surface
  View<const int* [4]> _edge_to_nodes; // [edge][corner] likewise
  View<double*[3]> _old, _new; // coordinates of _edges
  Kokkos::View<double, staging_space>
      _excursion[2]; // of corners and edges, see gatherCoordinates()
  View<double*> _corner_mass; // [corner]
  View<EdgeRecord*> _records, _ghost_records; // [own edge], [ghost]
  CandidateSearch _search;
  InteractionSet _set;
  IdleRows _idle;
  bool _has_gathered = false; // coordinates of a step
  bool _has_touched = false; // in the last step, with a force or without
  bool _has_forces_anywhere = false; // in the present step, on any rank
  EnforcementConfig _config;
  TouchedNodes _touched; // of corners
  FastestPair _fastest_pair;
  View<double* [3]> _accelerations; // [corner]
  View<unsigned char*> _has_changed; // [corner]
  View<unsigned char*> _ghost_in_use; // [ghost] it has an interaction in this step
  View<double* [12]> _ghost_accelerations;
  View<double* [3]> _responses; // [corner]
  View<double* [12]> _ghost_responses;
};

} // namespace brickwall::contact
