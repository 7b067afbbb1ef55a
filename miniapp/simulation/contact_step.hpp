// Contact within a time step: the surface follows the mesh, the search finds candidates, the
// enforcement turns them into forces. Also the tolerance of the search, the tunnelling guard,
// counts for reports, and what restart files hold of contact.
#pragma once

#include "contact/enforcement/edge_edge/edge_contact.hpp"
#include "contact/enforcement/enforcement.hpp"
#include "contact/enforcement/reports/largest_force.hpp"
#include "contact/search/candidate_search.hpp"
#include "miniapp/simulation/contact_balance.hpp"
#include "miniapp/simulation/contact_ledger.hpp"
#include "miniapp/simulation/host_counts.hpp"
#include "miniapp/simulation/step_controller.hpp"
#include "miniapp/simulation/surface_coupling.hpp"
#include "miniapp/simulation/tunnelling_guard.hpp"

#include <mpi.h>

#include <array>
#include <functional>
#include <memory>
#include <vector>

namespace brickwall::miniapp {

// What contact carries from step to step, for restart files. Scalars are those of all ranks.
struct ContactRestart {
  double search_tolerance = 0; // length
  double reference_step = 0; // time
  double deepest[2] = {0, 0}; // in the last step, of nodes and of edges, length
  double penetration = 0, known_penetration = 0; // largest, over the square root of the face's area
  double previous_dt = 0; // of the last step, time
  bool has_forces = false, edges_have_forces = false; // in the last step
  std::int64_t lost = 0, missed_pairs = 0, searches = 0, updates = 0; // since the start
  std::array<LimbSum, 3> ledger; // ContactLedger::totals()
  // of this rank's part
  std::vector<contact::ContactRecord> nodes, edges;
  std::vector<contact::JointRecord> joints;
  // [surface node][low xyz, high xyz] of the last search, length; empty if no lists are kept
  std::vector<double> swept_boxes;
};

class ContactStep {
public:
  // The surface is at X + `displacement`; `dt` is the reference step of contact. `config` and
  // `scene` must outlive the object. Throws InputError on all ranks if bodies overlap too deeply.
  // Collective.
  ContactStep(const exec_space& space, MPI_Comm comm, const Config& config, const Scene& scene,
              const mechanics::BoundaryConditions& boundary,
              const View<const double* [3]>& displacement, double dt, const Quantum& force_quantum,
              const LimbScale& energy_scale);

  // Moves faces to other ranks if the work of ranks has differed long enough
  // (search.decomposition). The surface is at X + `displacement`. Between steps; collective.
  void balance(std::int64_t step, const View<const double* [3]>& displacement);

  // The same at once: primary face f goes to rank_of_face[f], or to the rank of its element if that
  // is empty on all ranks. Nothing is done on one rank, or with the decomposition "primary".
  void distribute(const std::vector<int>& rank_of_face,
                  const View<const double* [3]>& displacement);

  // The surface after a drift: x^n := x^{n+1}, x^{n+1} := X + `displacement`.
  void moveSurface(const View<const double* [3]>& displacement) {
    _coupling.gatherCoordinates(_space, displacement);
    _has_moved.set(_space);
  }
  // The same after a drift that replaces the last one: x^n stays.
  void moveSurfaceAgain(const View<const double* [3]>& displacement) {
    _coupling.gatherAgain(_space, displacement);
  }

  // Whether the tolerance of the search is larger than that of the deck.
  bool hasGrownTolerance() const { return _search_tolerance != _box_tolerance; }
  // Adapts the tolerance of the search to the deepest contact of the last step. Collective.
  void growSearchTolerance(const contact::EnforcementSums& sums);
  // The surface stays where it is until enforce() if they `are_final`. `meanwhile`: see
  // CandidateSearch::update(). Collective.
  void findCandidates(bool are_final, const std::function<void()>& meanwhile);
  // Counts pairs that the lists of candidates lack by testing all pairs. Collective.
  void auditCandidates();

  // The fastest pair among the candidates; pairs slower than `limit` may be ignored. `mean`: the
  // motion of most nodes in this step (contact::FastestPair). Collective.
  contact::PairMotion fastestPair(const Vec3& mean, double limit);
  // Shortens the reference step for `pair`, which was found after a drift of length `dt` from the
  // positions at `clock`. Returns the longest admissible drift (TunnellingGuard::shorten).
  double shortenForPair(const contact::PairMotion& pair, double dt, const Clock& clock);

  // Contact forces of the step, added to `forces` as totals. `forces` holds the totals of all other
  // forces. Returns this rank's sums, which completeSums() completes after a later wait of the
  // host. Collective.
  contact::EnforcementSums enforce(const contact::StepLengths& steps,
                                   const mechanics::NodalForces& forces,
                                   const mechanics::NodalState& state,
                                   const mechanics::BoundaryConditions& boundary,
                                   mechanics::SharedNodeSum& shared);
  void completeSums(contact::EnforcementSums& sums) {
    _enforcement->completeSums(_space, _edges.get(), sums);
  }
  // Stores the forces of the last enforce() in `forces`, whose columns of contact are zero unless
  // willStoreAllForces(). Collective.
  void storeForces(const mechanics::NodalForces& forces) {
    if (hasForces() || willStoreAllForces()) // otherwise the columns are zero
      _coupling.storeContactForces(_space, _enforcement->touched(), _enforcement->forces(), forces);
  }
  bool willStoreAllForces() const { return _coupling.storesAllNext(); }
  // Whether any rank had contact forces in the last step.
  bool hasForces() const { return _enforcement->hasForces(); }
  // This rank's share of contact in the energy balance. Once per step.
  mechanics::ContactEnergySums energies(const contact::EnforcementSums& sums) {
    return _ledger.add(sums);
  }
  // Sets the counts of HostCount.
  void countDeepContacts(const contact::EnforcementSums& sums, mechanics::StepCounts& counts) const;

  contact::Surface surface() const { return _coupling.surface(); }
  std::int64_t distributions() const { return _balance.distributions(); } // of faces over ranks
  const contact::CandidateSearch& search() const { return _search; }
  const contact::Enforcement& enforcement() const { return *_enforcement; }
  const contact::EdgeContact* edges() const { return _edges.get(); } // null without convex edges
  const TunnellingGuard& guard() const { return _guard; }
  contact::LargestForce largestForce() const; // collective
  // For output, after a step; collective. Sets `of_mesh`, words [mesh node][W] of the status and
  // the gap (Enforcement) and, with W = 5, of the slip in the last step (contact::slipMotion()); 0
  // where there is no contact. Slip and normal forces are 0 as well after a search without
  // enforce(), which a failure has prevented. Equal on all ranks that share a node.
  void statusOnMesh(mechanics::SharedNodeSum& shared, const View<std::int64_t**>& of_mesh);
  // Totals of contact::normalForces() [mesh node][xyz], quanta.
  View<std::int64_t* [3]> normalForces(const Quantum& quantum, mechanics::SharedNodeSum& shared);
  // Adds the slip of the step that has succeeded (contact::addSlip()), if the deck chooses the
  // field.
  void addSlip();
  // Its sum since the start as words [mesh node][1], equal on all ranks that share a node; without
  // rows if the deck does not choose the field. Collective.
  View<std::int64_t**> slipOnMesh();
  void setSlip(const View<const std::int64_t**>& of_mesh); // the way back; collective
  // The number of candidate pairs of each face of this rank's elements.
  std::vector<std::int64_t> candidatesOfFaces();
  std::int64_t lost() const { return _lost; } // this rank's
  // The work of contact in the last step in WorkUnits: of surface nodes, [surface node][1] as
  // partial sums; from those, of this rank and of each face of this rank's elements. The last is
  // collective.
  View<std::int64_t**> workOfNodes() const;
  double workOfRank(const View<std::int64_t**>& of_nodes) const;
  std::vector<float> workOfFaces(const View<std::int64_t**>& of_nodes);
  std::int64_t missedPairs() const { return _missed_pairs; } // of all ranks
  double penetration() const { return _penetration; } // this rank's
  // The largest penetration of all ranks: exact if it exceeds a limit for the first time by the
  // `host_counts` of the step, otherwise a lower bound. Collective.
  double agreeOnPenetration(const std::int64_t* host_counts);

  // For restart files; `sums` are those of the last step. Collective.
  ContactRestart restartData(const contact::EnforcementSums& sums) const;
  // The surface is at X + `displacement`. Sets the sums of the last step that the next one reads.
  // Collective.
  void restore(const ContactRestart& data, const View<const double* [3]>& displacement,
               contact::EnforcementSums& sums);

private:
  void makeEnforcement();
  bool mayBeDistributed() const;
  void distributeAtStart(const View<const double* [3]>& displacement);
  std::vector<int> ranksOfFaces(const std::vector<float>& work) const;
  void setSearchTolerance(double tolerance);
  // Lists of the search in these swept boxes [surface node][low xyz, high xyz]; none without rows.
  void searchIn(const View<const double* [6]>& boxes, std::int64_t searches, std::int64_t updates);
  double toleranceFor(double deepest) const;
  // What enforce() and the search of edges read first; returns Enforcement::startMotion().
  View<const unsigned char*> measureSurface(const exec_space& space, bool is_final);

  Communicator _comm;
  const Config& _config;
  const Scene& _scene;
  exec_space _space;
  exec_space _beside = queueBeside(_space); // motion and edges are measured beside the search
  QueueMark _has_moved; // moveSurface()
  double _dt; // reference step at the start
  Quantum _force_quantum;
  LimbScale _energy_scale;
  double _box_tolerance; // of nodes and of faces, length: that of the deck
  double _search_tolerance; // that in use, not smaller
  SurfaceCoupling _coupling;
  contact::CandidateSearch _search;
  std::unique_ptr<contact::Enforcement> _enforcement;
  std::unique_ptr<contact::EdgeContact> _edges;
  contact::FastestPair _fastest_pair;
  TunnellingGuard _guard;
  ContactLedger _ledger;
  ContactBalance _balance;
  bool _has_forces_of_search = false; // enforce() has followed the last search
  // [surface node] since the start, length; 0 if not owned; empty if not chosen
  View<double*> _slip;
  mechanics::SharedNodeSum _slip_sum; // for output
  // since the start
  std::int64_t _lost = 0; // loaded contacts that exceeded the tolerance of the search, on this rank
  std::int64_t _missed_pairs = 0; // of the steps with an audit, over all ranks
  double _penetration = 0; // largest, on this rank
  double _known_penetration = 0; // largest that all ranks have agreed on
};

} // namespace brickwall::miniapp
