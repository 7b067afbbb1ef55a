// The coupled simulation: explicit time steps of deformable bricks with contact.
#pragma once

#include "mechanics/force/internal_force.hpp"
#include "mechanics/ledger/energy.hpp"
#include "mechanics/loads/boundary_conditions.hpp"
#include "mechanics/loads/pressure_load.hpp"
#include "mechanics/mesh/nodal_state.hpp"
#include "mechanics/step/free_bricks/free_bricks.hpp"
#include "mechanics/step/resting_bodies.hpp"
#include "miniapp/scene/scene.hpp"
#include "miniapp/simulation/contact_step.hpp"
#include "miniapp/simulation/step_checksums.hpp"
#include "miniapp/simulation/step_controller.hpp"

#include <mpi.h>

#include <memory>
#include <vector>

namespace brickwall::miniapp {

// Results of a step's stages that later stages, reports and the next step read. Sums and counts are
// those of this rank.
struct StepState {
  bool is_guarded = false; // some nodes are fast, so the state before the drift is kept
  bool free_bricks_have_drifted = true; // otherwise they drift in kickVelocities()
  bool has_all_forces = true; // false: those of free bricks were not stored
  std::int64_t resting_elems = 0;
  bool awaits_sums = false; // `internal` is under way
  mechanics::InternalForceResult internal;
  mechanics::TimeSpan load_span, previous_load_span; // spans of the last two kicks
  contact::EnforcementSums contact;
  mechanics::KickSums kick;
  std::int64_t load_misfits = 0; // forces of loads on this rank beyond the fixed-point range
};

// The state before a drift that the tunnelling guard may undo.
struct StateBeforeDrift {
  Clock clock;
  View<double* [3]> displacement; // u^n [node][xyz], length
};

// What a simulation carries from step to step, for restart files; everything else follows from the
// deck and the mesh (miniapp/restart/README.md lists both).
struct SimulationRestart {
  // the same on all ranks
  StepRestart steps;
  mechanics::EnergyLedger ledger;
  mechanics::TimeSpan load_span, previous_load_span;
  mechanics::KindFlags forces_act = {};
  std::int64_t guarded_steps = 0, skipped_element_steps = 0; // of all ranks
  // The tunnelling guard may repeat the last kick, which needs its forces.
  bool keeps_forces = false;
  // of this rank's nodes
  std::vector<double> displacement, velocity; // [node][xyz]: u^n, v^{n+1/2}
  // [node][column] in quanta; empty unless keeps_forces
  std::vector<std::int64_t> forces;
  std::vector<std::int64_t> slip; // [node] words of ContactStep::slipOnMesh(), or empty
  ContactRestart contact;
};

class Simulation {
public:
  // Positions and velocities are the initial ones, forces are zero. `config` and `scene` must
  // outlive the simulation. Collective.
  Simulation(MPI_Comm comm, const Config& config, const Scene& scene);

  // Forces of the initial state and the half step v^{1/2} = v^0 + dt/2 a^0. Collective.
  void start() { runStages(false); }
  // One step t^n -> t^{n+1}. Throws PhysicsError on all ranks; the state is then that of the
  // previous step. Collective.
  void step() { runStages(true); }
  bool isDone() const { return _steps.isDone(); }
  // To be called after each part of a step.
  void observe(const StepObserver& observer) { _observer = observer; }

  // What this rank asks of all ranks from the next step on, and what any rank has asked for in the
  // last step: they agree in its one reduction of energies.
  void request(const Requests& of_this_rank) { _requests = of_this_rank; }
  Requests requests() const {
    return {balance().host_counts[stop_requests] > 0,
            balance().host_counts[checkpoint_requests] > 0};
  }

  // Between steps, after start(). Collective.
  SimulationRestart restartData() const;
  // In place of start(), which an earlier run has done. Collective.
  void restore(const SimulationRestart& data);
  // Between steps, with contact: ContactStep::distribute(), for tests. Collective.
  void distributeContact(const std::vector<int>& rank_of_face) {
    _contact->distribute(rank_of_face, _state.displacement);
  }
  void extendTo(double end) { _steps.extendTo(end); } // see StepController

  MPI_Comm comm() const { return _comm; }
  const exec_space& space() const { return _space; }
  const Config& config() const { return _config; }
  const Scene& scene() const { return _scene; }
  const StepController& steps() const { return _steps; }
  const Clock& clock() const { return _steps.clock(); }
  const StepState& lastStep() const { return _step; }
  const mechanics::EnergyBalance& balance() const { return _ledger.balance(); }
  const mechanics::NodalState& state() const { return _state; }
  // Forces of the last step at all nodes; computes those that the step did not store.
  const mechanics::NodalForces& forces();
  // Those that the step stored: without free bricks, and before the part that computes them those
  // of the last step.
  const mechanics::NodalForces& storedForces() const { return _forces; }
  Quantum forceQuantum() const { return _forces.quantum; }
  const mechanics::BoundaryConditions& boundary() const { return _boundary; }
  const mechanics::InternalForce& internalForce() const { return *_internal_force; }
  const mechanics::FreeBricks& freeBricks() const { return _free_bricks; }
  const mechanics::RestingBodies& restingBodies() const { return _resting; }
  const ContactStep* contact() const { return _contact.get(); } // null without contact
  ContactStep* contact() { return _contact.get(); }
  // Steps in which the tunnelling guard tested pairs because some nodes were fast.
  std::int64_t guardedSteps() const { return _guarded_steps; }
  std::int64_t skippedElementSteps() const { return _skipped_element_steps; } // this rank's

private:
  // The stages of a step. Those that involve MPI are collective.
  void runStages(bool moves);
  void balanceContact();
  void moveNodes();
  void findContactCandidates();
  void guardAgainstTunnelling();
  void auditCandidates();
  void adaptTimeStep();
  void computeInternalForces();
  void limitStepForCompression();
  void addLoads(mechanics::TimeSpan span);
  void sumSharedNodes();
  void takeSums();
  void enforceContact();
  void kickVelocities(double dt_kick);
  void bookEnergies();

  // Parts of stages.
  void finish(StepPart part) const;
  void saveStateForGuard();
  void shortenDrift(double longest);
  void drift();
  void launchInternalForces(const exec_space& space);
  void stepFreeBricks(double dt_kick, const mechanics::TimeSpan& next_drift);
  void stepBack();
  mechanics::TimeSpan nextLoadSpan() const;
  const mechanics::NodeSelection& movingNodes() const;

  // Set-up.
  void allocateForces();
  void findFreeBricks();
  void findRestingBodies();

  MPI_Comm _comm;
  const Config& _config;
  const Scene& _scene;
  exec_space _space;
  exec_space _beside = queueBeside(_space); // internal forces are computed beside the search

  StepController _steps;
  mechanics::NodalState _state;
  mechanics::NodalForces _forces;
  mechanics::BoundaryConditions _boundary;
  mechanics::SharedNodeSum _shared;
  std::unique_ptr<mechanics::InternalForce> _internal_force;
  std::vector<mechanics::PressureLoad> _loads;
  mechanics::FreeBricks _free_bricks; // none with contact or viscosity
  mechanics::NodeSelection _other_nodes; // all but those of free bricks
  mechanics::RestingBodies _resting; // none without contact
  std::unique_ptr<ContactStep> _contact;
  mechanics::LedgerScales _scales;
  mechanics::EnergyLedger _ledger;

  QueueMark _has_drifted, _has_forces; // in _space; of the internal forces in _beside
  StepState _step;
  StepObserver _observer; // or empty
  Requests _requests; // of this rank
  StateBeforeDrift _before_drift;
  mechanics::DriftAhead _ahead; // made by the last kick, unless its length is 0
  std::int64_t _guarded_steps = 0;
  std::int64_t _skipped_element_steps = 0; // of bodies at rest, on this rank
};

} // namespace brickwall::miniapp
