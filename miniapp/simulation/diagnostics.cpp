#include "miniapp/simulation/diagnostics.hpp"

#include "contact/base/hash.hpp"
#include "contact/base/mpi.hpp"
#include "contact/enforcement/reports/history_checksum.hpp"
#include "mechanics/ledger/small_strain.hpp"
#include "miniapp/scene/entity_names.hpp"

#include <algorithm>
#include <iomanip>
#include <sstream>

namespace brickwall::miniapp {

namespace {

// Materials at small strain are not objective: their stress exerts a moment when the body rotates.
bool isObjective(const Config& config) {
  return std::none_of(config.materials.begin(), config.materials.end(), [](const auto& material) {
    return material.material.model == mechanics::MaterialModel::linear;
  });
}

struct HashNode {
  View<const global_id*> ids;
  View<const unsigned char*> is_owned;
  View<const double*[3]> displacement, velocity;
  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t node, std::uint64_t& sum) const {
    if (!is_owned(node))
      return;
    Hash hash;
    hash.take(ids(node));
    for (int i = 0; i < 3; ++i) {
      hash.take(displacement(node, i));
      hash.take(velocity(node, i));
    }
    sum += hash.value();
  }
};

// A node of mass m and speed v is stopped by the force sqrt(k m) v = sqrt(s) m v/dt with k = s
// m/dt^2 and s = contact.penalty. Half of the range of forces suffices for s (range/(2 F))^2, where
// F is the force found.
std::string remedyFor(double excess, const Simulation& simulation) {
  std::ostringstream message;
  for (const StepCut& cut : simulation.steps().cuts())
    if (cut.reason == StepCut::Reason::tunnelling) {
      message << "The step was cut from " << cut.from
              << " so that nodes are stopped within contact.tolerance: raise contact.tolerance or "
                 "slow the bodies down";
      return message.str();
    }
  const double part = minOf(0.5 / excess, 1.0);
  message.precision(1);
  message << "The stiffness of contact is k = contact.penalty m/dt^2: lengthen the step "
             "(time.safety, the size of the smallest elements), or soften contact by "
             "contact.penalty = "
          << simulation.config().contact.penalty * part * part;
  return message.str();
}

std::string describeLargestForce(const Simulation& simulation) {
  const contact::LargestForce largest = simulation.contact()->largestForce();
  if (!(largest.force > 0))
    return "";
  const auto body = [&](global_id id) {
    return bodyName(simulation.comm(), simulation.config(), simulation.scene().part, id);
  };
  const EntityNames names(simulation.comm(), simulation.scene().part);
  const double range = contact::largestPairForce(simulation.forceQuantum());
  std::ostringstream message;
  message << "; the largest, " << largest.force << ", is that of "
          << (largest.is_of_edges ? names.edge(largest.node) : names.node(largest.node)) << " of "
          << body(largest.node_body) << " and "
          << (largest.is_of_edges ? names.edge(largest.face) : names.face(largest.face)) << " of "
          << body(largest.face_body) << ". The range ends at " << range
          << ", a multiple of (lambda + 2 mu) h^2 of the strongest element";
  if (largest.force < HUGE_VAL)
    message << ". " << remedyFor(largest.force / range, simulation);
  return message.str();
}

struct LargestNorm {
  View<const double* [3]> vectors;
  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t node, double& largest) const {
    const double value = norm(rowOf(vectors, node));
    largest = maxOf(largest, value < HUGE_VAL ? value : HUGE_VAL); // NaN counts as infinite
  }
};

double largestNorm(const Simulation& simulation, const View<const double* [3]>& vectors) {
  double largest = 0;
  Kokkos::parallel_reduce("miniapp::largestNorm",
                          rangePolicy(simulation.space(), simulation.scene().mesh.num_nodes),
                          LargestNorm{vectors}, Kokkos::Max<double>(largest));
  return allReduce(simulation.comm(), maxOf(largest, 0.0), MPI_MAX);
}

// Loads beyond the range of forces, or else sums of the ledger beyond theirs, which have room for
// 2^20 times the energy of an element at the speed of waves (mechanics/ledger/ledger_sums.hpp).
// Collective.
std::string describeMisfits(const Simulation& simulation) {
  const auto misfits = allReduce(simulation.comm(), simulation.lastStep().load_misfits, MPI_SUM);
  std::ostringstream message;
  if (misfits > 0) {
    message << misfits
            << " nodal forces of [[load.pressure]] are not finite or beyond the fixed-point range, "
               "which ends at "
            << fixed_point_limit * simulation.forceQuantum().value
            << ", a multiple of (lambda + 2 mu) h^2 of the strongest element. Lower the peak, or "
               "mind the units";
    return message.str();
  }
  double wave_speed = HUGE_VAL;
  for (const MaterialConfig& material : simulation.config().materials)
    wave_speed = minOf(wave_speed, material.material.dilatationalSpeed());
  const double fastest = largestNorm(simulation, simulation.state().velocity);
  const double farthest = largestNorm(simulation, simulation.state().displacement);
  const double extent = largestNorm(simulation, simulation.scene().mesh.reference_coordinates);
  message << "an energy, a momentum or a force is not finite or beyond the range of the exact "
             "sums, which have room for at least 1000 times the speed of waves and 1000 times the "
             "largest coordinate of the mesh; the fastest node moves at "
          << fastest << ", " << fastest / wave_speed
          << " times the least speed of waves, and the farthest has moved by " << farthest << ", "
          << farthest / extent << " times the largest coordinate";
  return message.str();
}

} // namespace

ContactCounts contactCounts(const Simulation& simulation) {
  ContactCounts counts;
  const ContactStep* contact = simulation.contact();
  if (!contact)
    return counts;
  const contact::CandidateSearch& search = contact->search();
  const contact::EnforcementSums& step = simulation.lastStep().contact;
  std::int64_t sums[4] = {search.ghosts().count, search.pairs().count, step.active(),
                          contact->lost()};
  allReduce(simulation.comm(), sums, 4, MPI_SUM);
  counts.searches = search.searches();
  counts.updates = search.updates();
  counts.rank_box_exchanges = search.rankBoxExchanges();
  counts.distributions = contact->distributions();
  counts.ghost_faces = sums[0];
  counts.candidate_pairs = sums[1];
  counts.active = sums[2];
  counts.lost = sums[3];
  counts.missed_pairs = contact->missedPairs();
  counts.largest_penetration = allReduce(simulation.comm(), contact->penetration(), MPI_MAX);
  counts.max_penetration = allReduce(simulation.comm(), step.maxPenetration(), MPI_MAX);
  return counts;
}

void reduceOverRanks(MPI_Comm comm, std::vector<RankValue>& values) {
  std::vector<double> here;
  for (const RankValue& value : values)
    here.push_back(value.here);
  const std::vector<MaxAndSum> reduced = maxAndSum(comm, here);
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i].max = reduced[i].max;
    values[i].mean = reduced[i].sum / sizeOf(comm);
  }
}

std::vector<RankValue> countsOfRank(const Simulation& simulation) {
  std::vector<RankValue> counts;
  const auto add = [&](const char* what, std::int64_t count) {
    counts.push_back({what, static_cast<double>(count)});
  };
  const Scene& scene = simulation.scene();
  const ContactStep* contact = simulation.contact();
  add("elements", scene.part.numElems());
  add("faces", contact ? contact->surface().num_faces : scene.skin.num_faces);
  if (contact) {
    const contact::EdgeContact* edges = contact->edges();
    add("ghost_faces", contact->search().ghosts().count);
    add("candidate_pairs", contact->search().pairs().count);
    add("edge_pairs", edges ? edges->search().pairs().count : 0);
    add("active_contacts", simulation.lastStep().contact.active());
    add("active_edges", simulation.lastStep().contact.edges.active);
    counts.push_back({"work", contact->workOfRank(contact->workOfNodes())});
  }
  return counts;
}

std::int64_t numSearches(const Simulation& simulation) {
  return simulation.contact() ? simulation.contact()->search().searches() : 0;
}

GaugeValues gauges(Simulation& simulation) {
  const mechanics::EnergyBalance& balance = simulation.balance();
  GaugeValues values;
  values[gauge_energy] = balance.energy_error;
  values[gauge_momentum] = balance.momentum_error;
  values[gauge_angular_momentum] =
      isObjective(simulation.config()) ? balance.angular_momentum_error : 0;
  values[gauge_contact] = balance.contact_error;
  values[gauge_hourglass] = balance.hourglassShare();
  values[gauge_penetration] =
      simulation.contact() ? simulation.contact()->agreeOnPenetration(balance.host_counts) : 0;
  return values;
}

std::string largeStrainWarning(const Simulation& simulation) {
  const Clock& clock = simulation.clock();
  const bool is_evaluated = simulation.isDone() || simulation.steps().checksStability(clock.step);
  if (!is_evaluated || isObjective(simulation.config()))
    return "";
  const mechanics::NeglectedStrain neglected =
      mechanics::neglectedStrain(simulation.space(), simulation.comm(), simulation.scene().mesh,
                                 simulation.state().displacement);
  if (!(neglected.strain > mechanics::large_neglected_strain))
    return "";
  std::ostringstream message;
  message << EntityNames(simulation.comm(), simulation.scene().part).element(neglected.elem)
          << " of a linear material has rotated or deformed so far that the neglected part of its "
             "strain, H^T H/2, is "
          << std::setprecision(2) << neglected.strain << " in step " << clock.step << " (time "
          << std::setprecision(6) << clock.time
          << "): the models \"svk\" and \"neo_hookean\" describe finite rotations";
  return message.str();
}

Checksums contactChecksums(const Simulation& simulation) {
  Checksums sums;
  const auto add = [&](const View<const global_id*>& ids, const contact::ContactHistory& history) {
    sums.contacts += contact::historyChecksum(simulation.space(), ids, history);
    sums.interactions += history.count;
  };
  if (const ContactStep* contact = simulation.contact()) {
    add(contact->surface().node_ids, contact->enforcement().history());
    if (contact->edges())
      add(contact->edges()->nodeIds(), contact->edges()->history());
  }
  return sums;
}

Checksums checksums(const Simulation& simulation) {
  const exec_space& space = simulation.space();
  const mechanics::HexMesh& mesh = simulation.scene().mesh;
  std::uint64_t nodes = 0;
  Kokkos::parallel_reduce("miniapp::checksums::nodes", rangePolicy(space, mesh.num_nodes),
                          HashNode{mesh.node_ids, mesh.node_is_owned,
                                   simulation.state().displacement, simulation.state().velocity},
                          Kokkos::Sum<std::uint64_t>(nodes));
  const Checksums of_contacts = contactChecksums(simulation);
  // Signed sums wrap in MPI as unsigned ones do.
  std::int64_t sums[3] = {static_cast<std::int64_t>(nodes),
                          static_cast<std::int64_t>(of_contacts.contacts),
                          of_contacts.interactions};
  allReduce(simulation.comm(), sums, 3, MPI_SUM);
  return {static_cast<std::uint64_t>(sums[0]), static_cast<std::uint64_t>(sums[1]), sums[2]};
}

SpecialElements specialElements(const Simulation& simulation) {
  const mechanics::InternalForce& internal = simulation.internalForce();
  const std::int64_t in_lattices =
      simulation.config().viscosity.any() ? 0 : internal.numLatticeElems();
  std::int64_t sums[5] = {internal.numCongruentElems(), in_lattices,
                          simulation.freeBricks().numElems(), simulation.restingBodies().numElems(),
                          simulation.skippedElementSteps()};
  allReduce(simulation.comm(), sums, 5, MPI_SUM);
  return {sums[0], sums[1], sums[2], sums[3], sums[4]};
}

double sureSpeed(const Simulation& simulation) {
  const double dt = simulation.clock().dt;
  return simulation.contact() ? simulation.contact()->guard().tolerableMotion(dt, true) / dt
                              : HUGE_VAL;
}

std::string describeFailure(const Simulation& simulation) {
  const MPI_Comm comm = simulation.comm();
  const Clock& clock = simulation.clock();
  const auto failure = mechanics::agreeOnFailure(simulation.space(), comm, simulation.scene().mesh,
                                                 simulation.lastStep().internal.failure);
  contact::EnforcementSums sums = simulation.lastStep().contact;
  contact::sumOverRanks(comm, sums.nodes);
  contact::sumOverRanks(comm, sums.edges);
  std::ostringstream message;
  message << "the computation broke down in step " << clock.step << " (time " << clock.time
          << "): ";
  if (failure.count > 0)
    message
        << EntityNames(comm, simulation.scene().part).element(failure.first_elem) << " "
        << mechanics::describe(failure)
        << "; in strongly deformed bodies a smaller time.check_interval or time.safety may help";
  else if (sums.failures() > 0)
    message << (sums.nodes.failures() > 0 ? sums.nodes : sums.edges).problem()
            << (sums.nodes.invalid + sums.edges.invalid > 0 ? describeLargestForce(simulation)
                                                            : "");
  else
    message << describeMisfits(simulation);
  return message.str();
}

} // namespace brickwall::miniapp
