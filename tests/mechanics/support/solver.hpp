// The time loop of mechanics without contact, for tests: mesh, state, forces, loads, boundary
// conditions and ledger of one block.
#pragma once

#include "contact/base/to_device.hpp"
#include "mechanics/ledger/energy.hpp"
#include "mechanics/loads/pressure_load.hpp"
#include "mechanics/mesh/skin.hpp"
#include "mechanics/stability/stable_time_step.hpp"
#include "mechanics/step/central_difference.hpp"
#include "tests/mechanics/support/block_mesh.hpp"

#include <functional>
#include <memory>

namespace brickwall::mechanics::testing {

struct Solver {
  exec_space space;
  MPI_Comm comm;
  BlockMesh blocks;
  NodalState state;
  NodalForces forces;
  LedgerScales scales;
  std::unique_ptr<InternalForce> internal;
  std::unique_ptr<BoundaryConditions> boundary;
  std::vector<PressureLoad> loads;
  EnergyLedger ledger;
  double time = 0;
  double pushed_until = 0; // end of the time covered by the loads' impulses
  BulkViscosity viscosity;
  std::function<ContactEnergySums()> contact; // adds totals to the contact_force columns

  Solver(MPI_Comm comm_in, const Block& block, const Material& material, Vec3 gravity = {},
         const Placement& place = asIs, ElementKind kind = ElementKind::one_point)
      : comm(comm_in) {
    blocks = makeBlocks(space, comm, {block}, {material}, place,
                        comm == MPI_COMM_SELF ? onOneRank : slices);
    state = stateAtRest(space, comm, blocks);
    const Quantum quantum = Quantum::forForceScale(forceScale(space, comm, blocks.mesh));
    forces = zeroedForces(blocks.mesh, quantum);
    scales = ledgerScales(space, comm, blocks.mesh);
    internal =
        std::make_unique<InternalForce>(space, comm, blocks.mesh, kind, quantum, scales.energy);
    fix({}, gravity);
  }
  void fix(const std::vector<PrescribedMotion>& motions, Vec3 gravity = {},
           double mass_damping = 0) {
    boundary = std::make_unique<BoundaryConditions>(space, blocks.mesh.num_nodes, motions, gravity,
                                                    mass_damping);
  }
  void makeViscous(const BulkViscosity& b) {
    viscosity = b;
    forces = zeroedForces(blocks.mesh, forces.quantum, b.any());
  }
  auto field(const std::function<Vec3(const Vec3&)>& of_position) const {
    return nodalField(space, blocks.mesh, of_position);
  }
  std::vector<int> nodesWhere(const std::function<bool(const Vec3&)>& chosen) const {
    std::vector<int> nodes;
    const auto X = toHost(blocks.mesh.reference_coordinates);
    for (int node = 0; node < blocks.mesh.num_nodes; ++node)
      if (chosen(rowOf(X, node)))
        nodes.push_back(node);
    return nodes;
  }
  void press(const Pressure& pressure, const std::function<bool(const Vec3&)>& chosen) {
    const Skin skin = findSkin(space, comm, blocks.mesh, blocks.shared);
    const auto faces = toHost(skin.face_to_nodes);
    const auto X = toHost(blocks.mesh.reference_coordinates);
    std::vector<int> nodes;
    for (int f = 0; f < skin.num_faces; ++f) {
      bool all = true;
      for (int c = 0; c < 4; ++c)
        all = all && chosen(rowOf(X, faces(f, c)));
      for (int c = 0; all && c < 4; ++c)
        nodes.push_back(faces(f, c));
    }
    loads.emplace_back(space, MPI_COMM_WORLD, blocks.mesh, pressure, nodes);
  }
  void evaluateAndKick(double kick_dt, double dt) {
    zeroForces(space, forces);
    const auto result =
        internal->add(space, state.displacement, state.velocity, viscosity, forces, true);
    std::int64_t misfits = 0;
    for (const PressureLoad& load : loads)
      misfits +=
          load.add(space, blocks.mesh, state.displacement, {pushed_until, time + 0.5 * dt}, forces);
    pushed_until = time + 0.5 * dt;
    blocks.sum.sum(space, forces.values);
    const ContactEnergySums in_contact = contact ? contact() : ContactEnergySums();
    const KickSums sums =
        kick(space, blocks.mesh, *boundary, {time, time + dt}, kick_dt, forces, state, scales);
    ledger.bookStep(comm, kick_dt, dt, result, in_contact, sums, {misfits});
  }
  void start(double dt) {
    ledger = EnergyLedger(comm, scales, boundary->gravity(),
                          totalMass(space, comm, blocks.mesh, state.mass),
                          motionOf(space, blocks.mesh, state, scales));
    evaluateAndKick(0.5 * dt, dt);
  }
  // A drift of length dt, then the kick to the step of length `next`.
  void step(double dt, double next) {
    drift(space, dt, state);
    time += dt;
    evaluateAndKick(0.5 * (dt + next), next);
  }
  void step(double dt) { step(dt, dt); }
  void steps(int count, double dt) {
    for (int s = 0; s < count; ++s)
      step(dt);
  }
  // Starts with `share` of the stable step, which is returned.
  double startAt(double share) {
    const double dt = share * stableStep();
    start(dt);
    return dt;
  }
  double run(double share, int count) {
    const double dt = startAt(share);
    steps(count, dt);
    return dt;
  }

  // Fixes the face z = 0, drives the edge y = 0, z = 1 along x and presses on the face y = 0, under
  // gravity.
  void driveAndPress(PulseKind pulse, double mass_damping = 0) {
    PrescribedMotion base, side;
    base.nodes = nodesWhere([](const Vec3& x) { return x.z < 1e-9; });
    side.nodes = nodesWhere([](const Vec3& x) { return x.z > 1 - 1e-9 && x.y < 1e-9; });
    side.component[1] = side.component[2] = false;
    side.velocity = {0.02, 0, 0};
    side.shape = {PulseKind::half_sine, 3.0};
    fix({base, side}, {0, 0, -0.001}, mass_damping);
    Pressure pressure;
    pressure.peak = 0.01;
    pressure.shape = {pulse, 4.0};
    press(pressure, [](const Vec3& x) { return x.y < 1e-9; });
  }

  // Global id and stress sigma_xx of each element of this rank.
  std::vector<std::pair<global_id, double>> axialStresses() const {
    ElementFields fields;
    internal->computeFields(space, state.displacement, fields);
    const auto stress = toHost(fields.stress);
    const auto ids = toHost(blocks.mesh.elem_ids);
    std::vector<std::pair<global_id, double>> result;
    for (int elem = 0; elem < blocks.mesh.num_elems; ++elem)
      result.emplace_back(ids(elem), stress(elem, 0));
    return result;
  }

  double stableStep() { return stableTimeStep(space, comm, blocks.mesh, {viscosity}).dt; }
};

inline Block bar(int n, double length = 1) {
  return {{n, 1, 1}, {length, length / n, length / n}};
}

} // namespace brickwall::mechanics::testing
