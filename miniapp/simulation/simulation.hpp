// The coupled simulation: explicit time steps of bricks that search for contact and push each other.
#pragma once

#include "contact/enforcement/edge_edge/edge_contact.hpp"
#include "contact/enforcement/enforcement.hpp"
#include "contact/search/candidate_search.hpp"
#include "mechanics/force/internal_force.hpp"
#include "mechanics/ledger/energy.hpp"
#include "mechanics/ledger/small_strain.hpp"
#include "mechanics/loads/boundary_conditions.hpp"
#include "mechanics/loads/pressure_load.hpp"
#include "mechanics/mesh/nodal_state.hpp"
#include "mechanics/stability/largest_frequency.hpp"
#include "mechanics/stability/stable_time_step.hpp"
#include "mechanics/step/free_bricks/free_bricks.hpp"
#include "mechanics/step/resting_bodies.hpp"
#include "miniapp/scene/scene.hpp"
#include "miniapp/simulation/contact_ledger.hpp"
#include "miniapp/simulation/surface_coupling.hpp"
#include "miniapp/simulation/tunnelling_guard.hpp"

#include <mpi.h>

#include <memory>
#include <string>
#include <vector>

namespace brickwall::miniapp {

// Where the run stands and how long its steps are.
struct Clock {
  std::int64_t step = 0; // steps done
  double time = 0; // t^n of the positions
  double dt = 0; // of the next drift
  double dt_before = 0; // of the last drift; 0 before the first

  void advance() {
    dt_before = dt;
    time += dt;
    ++step;
  }
};

// A step that was shortened, with all that follow it.
struct StepCut {
  enum class Reason { stability, tunnelling };
  Reason reason = Reason::stability;
  std::int64_t step = 0; // the first of the new length
  double time = 0; // at its begin
  double from = 0, to = 0; // dt
};

// Counts of the last step over all ranks.
struct ContactCounts {
  std::int64_t searches = 0; // since the start
  std::int64_t updates =
      0; // since the start: steps that searched or kept the lists of the last search
  std::int64_t ghost_faces = 0;
  std::int64_t candidate_pairs = 0;
  std::int64_t active = 0;
  std::int64_t lost = 0; // since the start: loaded contacts deeper than the search reaches
  std::int64_t missed_pairs = 0; // since the start, of the steps that were audited
  double max_penetration = 0; // of the square root of a face's area
  double largest_penetration = 0; // since the start
};

// Sums modulo 2^64 of hashes (contact/base/hash.hpp).
struct Checksums {
  std::uint64_t nodes = 0; // displacement and velocity of every node
  std::uint64_t contacts =
      0; // of nodes with faces and of edges (contact/enforcement/reports/history_checksum.hpp)
  std::int64_t interactions = 0;
};

// Of mechanics::StepCounts::host: ranks with a penetration beyond a limit.
enum HostCount : int { deeper_than_warned, deeper_than_allowed, deeper_than_boxes };
static_assert(deeper_than_boxes < mechanics::num_host_counts);

// What the bound of whole bodies is worth (time.bound).
struct StepGain {
  double step = 1; // the step over that by the worst element by itself, both at rest
  int products = 0; // with the stiffness, to find it; 0: the element bound
  std::int64_t body_types = 0;
};

// One bound of the step: dt = share times the stable step under the load, until that is less than dt/largest_share.
struct StepLimit {
  // The rate is that which the step allows for; at first one that costs few per cent of the step.
  mechanics::StabilityTerms load = {{}, 0.01, 0};
  mechanics::ElementsAtRest elements; // under the load, as the run begins
  mechanics::RestFrequency rest; // of the bodies under the load's contact
  double share = 1, largest_share = 1;
};

class Simulation {
public:
  // Collective. `scene` must outlive the simulation. Positions and velocities are the initial ones, forces zero.
  Simulation(MPI_Comm comm, const Config& config, const Scene& scene);

  // Forces of the initial state and the half step v^{1/2} = v^0 + dt/2 a^0. Collective.
  void start();
  // One step t^n -> t^{n+1}. Collective. Throws PhysicsError on all ranks; the state is then that of the step before.
  void step();

  const Config& config() const { return _config; }
  const Clock& clock() const { return _clock; }
  const std::vector<StepCut>& stepCuts() const { return _step_cuts; }
  const StepGain& stepGain() const { return _step_gain; }
  // Steps whose pairs were looked at because some nodes moved fast.
  std::int64_t guardedSteps() const { return _guarded_steps; }
  // Speed of a node against a face up to which steps of the present length are not cut; infinite without a guard.
  double sureSpeed() const { return _guard.tolerableMotion(_clock.dt, true) / _clock.dt; }
  std::int64_t searches() const { return _search ? _search->searches() : 0; } // since the start
  // Steps in all until the end time (or the deck's number of steps).
  std::int64_t plannedSteps() const { return _planned_steps; }
  bool done() const { return _clock.step >= plannedSteps(); }

  const mechanics::EnergyBalance& balance() const { return _ledger.balance(); }
  // For limits, after a step. The penetration is exact where it is beyond a limit that has not been told of, else a lower
  // bound. Collective.
  GaugeValues gauges();
  // What linear materials leave out of the strain (mechanics/ledger/small_strain.hpp); looked at every check_interval steps and at the end,
  // 0 in others and without such materials. Collective.
  mechanics::NeglectedStrain neglectedStrain() const;
  const mechanics::NodalState& state() const { return _state; }
  // Of the last step, of all nodes.
  const mechanics::NodalForces& forces();
  const mechanics::BoundaryConditions& boundary() const { return _boundary; }
  mechanics::InternalForce& internalForce() { return *_internal_force; }
  // Null without contact.
  const contact::Enforcement* enforcement() const { return _enforcement.get(); }
  // Counts of the last step. Collective.
  ContactCounts contactCounts() const;
  // Of all bits of the state at the last step, over all ranks; equal on any layout. Collective.
  Checksums checksums() const;
  bool dropsSameBody() const { return _drops_same_body; }
  std::int64_t numCongruentElems() const; // of all ranks; collective
  std::int64_t numLatticeElems() const; // swept plane by plane; of all ranks; collective
  // Of bodies that nothing has moved yet, and what they have skipped since the start; of all ranks; collective.
  std::int64_t numRestingElems() const;
  std::int64_t skippedElementSteps() const;
  std::int64_t numFreeElems() const; // of bricks that step by themselves; of all ranks; collective

private:
  void moveNodes();
  void saveStateForGuard();
  // Where a pair of this step moves by more than contact reaches: takes the drift back, shortens the step for good, drifts
  // and searches again; or throws PhysicsError, on all ranks, in the state of the step before. Collective.
  void guardAgainstTunnelling();
  void takeBackDrift();
  void shortenDrift(double longest);
  void shortenSteps(double longest, StepCut::Reason reason);
  // Every check_interval steps: compares dt with the stable step of the deformed bodies and shortens it for good where
  // needed. Collective.
  void adaptTimeStep();
  void limitStepForCompression();
  bool checksStableStep(std::int64_t step) const;
  void shortenStepIfUnstable(); // collective
  void findContactCandidates();
  void auditCandidates(); // collective
  double reachOf(double deepest) const;
  void growSearchTolerance(); // collective
  void allocateForces();
  void findFreeBricks();
  void findRestingBodies();
  const mechanics::NodeSelection& movingNodes() const;
  void stepFreeBricks(double dt_kick, const mechanics::TimeSpan& next_drift);
  void computeInternalForces();
  void addLoads(const mechanics::TimeSpan& span);
  mechanics::TimeSpan nextLoadSpan() const;
  void enforceContact(double dt);
  void sumSharedNodes();
  void setContactPower(); // collective
  void kickVelocities(double dt_kick);
  void bookEnergies(double dt_kick);
  void stepBack(double dt_kick);
  void setStepLimits(); // collective
  void findLargestFrequency(StepLimit& limit);
  double longestStepAtRest();
  double longestStepAtStart();
  void planSteps(double longest);
  void setUpContact();
  std::string describeFailure(); // collective, as both
  std::string describeLargestForce();
  std::string cureOf(double excess) const;

  MPI_Comm _comm;
  const Config& _config;
  const Scene& _scene;
  exec_space _space;

  Clock _clock;
  std::int64_t _planned_steps = 0;
  bool _is_objective =
      true; // no material at small strain, whose stress makes a moment when it turns
  std::vector<StepLimit>
      _step_limits; // of free bodies; with contact also of bodies pressed all over
  StepGain _step_gain;
  mechanics::NodalState _state;
  mechanics::NodalForces _forces;
  mechanics::BoundaryConditions _boundary;
  mechanics::SharedNodeSum _shared;
  std::unique_ptr<mechanics::InternalForce> _internal_force;
  mechanics::FreeBricks _free_bricks; // none with contact or viscosity
  mechanics::RestingBodies _resting; // none without contact
  std::int64_t _resting_elems = 0, _skipped_element_steps = 0; // here, in this step and in all
  mechanics::NodeSelection _other_nodes;
  bool _free_have_drifted = true, _has_all_forces = true; // in the step under way
  std::vector<mechanics::PressureLoad> _loads;
  mechanics::TimeSpan _load_span, _load_span_before; // that the last two kicks have covered
  mechanics::LedgerScales _scales;
  mechanics::EnergyLedger _ledger;

  bool _drops_same_body = true;
  double _box_tolerance = 0, _reach = 0; // of nodes and of faces, length: of the deck; now
  std::unique_ptr<SurfaceCoupling> _coupling; // these are null without contact
  std::unique_ptr<contact::CandidateSearch> _search;
  std::unique_ptr<contact::Enforcement> _enforcement;
  std::unique_ptr<contact::EdgeContact> _edges; // null also without convex edges
  ContactLedger _contact_ledger;
  TunnellingGuard _guard; // off without contact
  std::int64_t _lost = 0; // this rank's, since the start
  std::int64_t _missed_pairs = 0; // of all ranks, since the start
  double _penetration = 0; // largest since the start, this rank's
  double _known_penetration = 0; // the largest of all ranks that they have agreed on

  std::vector<StepCut> _step_cuts;
  std::int64_t _guarded_steps = 0;
  bool _is_watched = false; // the step under way: some nodes are fast, u^n is kept
  Clock _kept_clock;
  View<double* [3]> _kept_displacement;

  // of the step under way
  mechanics::InternalForceResult _internal;
  contact::EnforcementSums _contact;
  mechanics::KickSums _kick;
  std::int64_t _load_failures = 0;
};

} // namespace brickwall::miniapp
