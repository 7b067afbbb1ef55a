// The coupled simulation: explicit time steps of bricks that search for contact and push each other.
#pragma once

#include "contact/candidate_search.hpp"
#include "contact/edge_contact.hpp"
#include "contact/penalty.hpp"
#include "mechanics/boundary_conditions.hpp"
#include "mechanics/energy.hpp"
#include "mechanics/internal_force.hpp"
#include "mechanics/nodal_state.hpp"
#include "mechanics/pressure_load.hpp"
#include "mechanics/stable_time_step.hpp"
#include "miniapp/contact_ledger.hpp"
#include "miniapp/scene.hpp"
#include "miniapp/surface_coupling.hpp"

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
  double max_penetration = 0; // of the square root of a face's area
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
  // Steps in all until the end time (or the deck's number of steps).
  std::int64_t plannedSteps() const { return _planned_steps; }
  bool done() const { return _clock.step >= plannedSteps(); }

  const mechanics::EnergyBalance& balance() const { return _ledger.balance(); }
  const mechanics::NodalState& state() const { return _state; }
  const mechanics::NodalForces& forces() const { return _forces; }
  const mechanics::BoundaryConditions& boundary() const { return _boundary; }
  mechanics::InternalForce& internalForce() { return *_internal_force; }
  // Null without contact.
  const contact::Enforcement* enforcement() const { return _enforcement.get(); }
  // Counts of the last step. Collective.
  ContactCounts contactCounts() const;
  bool dropsSameBody() const { return _drops_same_body; }
  std::int64_t numCongruentElems() const; // of all ranks; collective

private:
  void moveNodes();
  // Every check_interval steps: compares dt with the stable step of the deformed bodies and shortens it for good where
  // needed. Collective.
  void adaptTimeStep();
  void watchCompression();
  void shortenStepIfUnstable(); // collective
  void findContactCandidates();
  void computeForces(double time);
  void enforceContact(double dt);
  void sumSharedNodes();
  void kickVelocities(double dt_kick, double time_of_velocity);
  void bookEnergies(double dt_kick);
  void stepBack(double dt_kick);
  double stableStepAtStart() const; // collective
  void planSteps(double longest);
  void setUpContact();
  std::string describeFailure();

  MPI_Comm _comm;
  const Config& _config;
  const Scene& _scene;
  exec_space _space;

  Clock _clock;
  std::int64_t _planned_steps = 0;
  double _step_share = 1; // chi: dt over the elements' stable step
  // The rate is that which the step allows for; at first one that costs few per cent of the step.
  mechanics::StepViscosity _step_viscosity = {{}, 0.01, 1};
  mechanics::NodalState _state;
  mechanics::NodalForces _forces;
  mechanics::BoundaryConditions _boundary;
  mechanics::SharedNodeSum _shared;
  std::unique_ptr<mechanics::InternalForce> _internal_force;
  std::vector<mechanics::PressureLoad> _loads;
  mechanics::LedgerScales _scales;
  mechanics::EnergyLedger _ledger;

  bool _drops_same_body = true;
  std::unique_ptr<SurfaceCoupling> _coupling; // these are null without contact
  std::unique_ptr<contact::CandidateSearch> _search;
  std::unique_ptr<contact::Enforcement> _enforcement;
  std::unique_ptr<contact::EdgeContact> _edges; // null also without convex edges
  ContactLedger _contact_ledger;
  std::int64_t _lost = 0; // this rank's, since the start

  // of the step under way
  mechanics::InternalForceResult _internal;
  contact::EnforcementSums _contact;
  mechanics::KickSums _kick;
  std::int64_t _load_failures = 0;
};

} // namespace brickwall::miniapp
