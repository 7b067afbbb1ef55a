// The time loop of the mechanics alone, for tests: mesh, state, forces, loads, boundaries and ledger of one block.
#pragma once

#include "mechanics/ledger/energy.hpp"
#include "mechanics/loads/pressure_load.hpp"
#include "mechanics/mesh/skin.hpp"
#include "mechanics/stability/stable_time_step.hpp"
#include "mechanics/step/central_difference.hpp"
#include "tests/mechanics/support/block_mesh.hpp"

#include <functional>
#include <memory>

namespace brickwall::mechanics::testing {

const MPI_Comm world = MPI_COMM_WORLD;

inline int slices(global_id elem) {
  return static_cast<int>(elem / 3 % sizeOf(world));
}

// A mesh with everything that the time loop of the mechanics alone needs.
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
  double pushed_until = 0; // what the loads have given
  BulkViscosity viscosity;
  std::function<ContactEnergySums()> contact; // adds totals to the contact_force columns

  Solver(MPI_Comm comm_in, const Block& block, const Material& material, Vec3 gravity = {},
         const Placement& place = asIs, ElementKind kind = ElementKind::one_point)
      : comm(comm_in) {
    blocks = makeBlocks(space, comm, {block}, {material}, place,
                        comm == MPI_COMM_SELF ? Partition([](global_id) { return 0; }) : slices);
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
  std::vector<int> nodesWhere(const std::function<bool(const Vec3&)>& chosen) const {
    std::vector<int> nodes;
    const auto X =
        Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), blocks.mesh.reference_coordinates);
    for (int node = 0; node < blocks.mesh.num_nodes; ++node)
      if (chosen(rowOf(X, node)))
        nodes.push_back(node);
    return nodes;
  }
  void press(const Pressure& pressure, const std::function<bool(const Vec3&)>& chosen) {
    const Skin skin = findSkin(space, comm, blocks.mesh, blocks.shared);
    const auto faces = Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), skin.face_to_nodes);
    const auto X =
        Kokkos::create_mirror_view_and_copy(Kokkos::HostSpace(), blocks.mesh.reference_coordinates);
    std::vector<int> nodes;
    for (int f = 0; f < skin.num_faces; ++f) {
      bool all = true;
      for (int c = 0; c < 4; ++c)
        all = all && chosen(rowOf(X, faces(f, c)));
      for (int c = 0; all && c < 4; ++c)
        nodes.push_back(faces(f, c));
    }
    loads.emplace_back(space, blocks.mesh, pressure, nodes);
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
    if (contact)
      ledger.setContactPower(
          forcePower(space, comm, blocks.mesh, forces, state, contact_force, scales));
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
  void step(double dt) {
    drift(space, dt, state);
    time += dt;
    evaluateAndKick(dt, dt);
  }
  double stableStep() { return stableTimeStep(space, comm, blocks.mesh, {viscosity}).dt; }
};

inline Block bar(int n, double length = 1) {
  Block block;
  block.elements[0] = n;
  block.size = {length, length / n, length / n};
  return block;
}

} // namespace brickwall::mechanics::testing
