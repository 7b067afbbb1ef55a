#include "miniapp/simulation/step_checksums.hpp"

#include "contact/base/hash.hpp"
#include "contact/base/mpi.hpp"
#include "contact/surface/face_access.hpp"
#include "miniapp/simulation/diagnostics.hpp"
#include "miniapp/simulation/simulation.hpp"

namespace brickwall::miniapp {
namespace {

// Columns [first, first + count) of all owned nodes.
template <class Columns>
std::uint64_t hashNodes(const Simulation& simulation, const Columns& values, int first, int count) {
  const mechanics::HexMesh& mesh = simulation.scene().mesh;
  const auto ids = mesh.node_ids;
  const auto is_owned = mesh.node_is_owned;
  if (values.extent(0) == 0)
    return 0;
  std::uint64_t hashes = 0;
  Kokkos::parallel_reduce(
      "miniapp::StepChecksums::nodes", rangePolicy(simulation.space(), mesh.num_nodes),
      KOKKOS_LAMBDA(const std::int64_t node, std::uint64_t& sum) {
        if (!is_owned(node))
          return;
        Hash hash;
        hash.take(ids(node));
        for (int column = first; column < first + count; ++column)
          hash.take(values(node, column));
        sum += hash.value();
      },
      Kokkos::Sum<std::uint64_t>(hashes));
  return hashes;
}

std::uint64_t hashForces(const Simulation& simulation, mechanics::ForceKind kind) {
  const mechanics::NodalForces& forces = simulation.storedForces();
  const bool acts = forces.acts[kind] && static_cast<int>(forces.values.extent(1)) > 3 * kind;
  return acts ? hashNodes(simulation, forces.values, 3 * kind, 3) : 0;
}

std::uint64_t hashPairs(const Simulation& simulation) {
  const ContactStep* contact = simulation.contact();
  if (contact == nullptr)
    return 0;
  const contact::CandidatePairs pairs = contact->search().pairs();
  const contact::FaceAccess faces{contact->surface(), contact->search().ghosts()};
  std::uint64_t hashes = 0;
  Kokkos::parallel_reduce(
      "miniapp::StepChecksums::pairs", rangePolicy(simulation.space(), pairs.num_rows),
      KOKKOS_LAMBDA(const std::int64_t row, std::uint64_t& sum) {
        for (std::int64_t p = pairs.begin(row); p < pairs.end(row); ++p) {
          Hash hash;
          hash.take(faces.surface.node_ids(pairs.node(row)));
          hash.take(faces.id(pairs.faces(p)));
          sum += hash.value();
        }
      },
      Kokkos::Sum<std::uint64_t>(hashes));
  return hashes;
}

std::uint64_t hashEnergies(const mechanics::EnergyBalance& balance) {
  Hash hash;
  for (const double energy :
       {balance.kinetic, balance.stored_material, balance.stored_hourglass, balance.stored_half,
        balance.stored_contact, balance.stored_friction, balance.stored_edge, balance.total_half})
    hash.take(energy);
  for (const double work : balance.work)
    hash.take(work);
  hash.take(balance.momentum);
  hash.take(balance.angular_momentum);
  return hash.value();
}

// The part of this rank.
std::uint64_t hashOf(const Simulation& simulation, StepPart part) {
  switch (part) {
  case StepPart::displacement:
    return hashNodes(simulation, simulation.state().displacement, 0, 3);
  case StepPart::pairs:
    return hashPairs(simulation);
  case StepPart::forces:
    return hashForces(simulation, mechanics::internal_force) +
           hashForces(simulation, mechanics::external_force) +
           hashForces(simulation, mechanics::viscous_force);
  case StepPart::velocity:
    return hashNodes(simulation, simulation.state().velocity, 0, 3);
  default: // contacts
    return hashForces(simulation, mechanics::contact_force) + contactChecksums(simulation).contacts;
  }
}

} // namespace

const char* nameOf(StepPart part) {
  constexpr const char* names[] = {"displacement", "pairs",    "forces",
                                   "contacts",     "velocity", "energies"};
  return names[static_cast<int>(part)];
}

std::uint64_t checksumOf(const Simulation& simulation, StepPart part) {
  if (part == StepPart::energies) // the same on all ranks
    return hashEnergies(simulation.balance());
  // Signed sums wrap in MPI as unsigned ones do.
  const auto own = static_cast<std::int64_t>(hashOf(simulation, part));
  return static_cast<std::uint64_t>(allReduce(simulation.comm(), own, MPI_SUM));
}

} // namespace brickwall::miniapp
