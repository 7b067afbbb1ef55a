#include "miniapp/simulation/element_balance.hpp"

#include "contact/base/mpi.hpp"
#include "contact/base/to_device.hpp"
#include "io/mesh/partition.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace brickwall::miniapp {

namespace {

// [elem] 1: in a body at rest.
std::vector<char> restingElements(const Simulation& simulation) {
  const auto& mesh = simulation.scene().mesh;
  std::vector<char> rests(mesh.num_elems, 0);
  const auto flags = toHost(simulation.restingBodies().flags());
  for (std::size_t row = 0; row < flags.extent(0); ++row)
    if (flags(row))
      std::fill_n(rests.begin() + mesh.bodies[row].first, mesh.bodies[row].count, 1);
  return rests;
}

std::vector<double> presentCentroids(const Simulation& simulation) {
  const io::MeshPart& part = simulation.scene().part;
  const auto u = toHost(simulation.state().displacement);
  std::vector<double> centroids(3 * part.elem_ids.size(), 0.0);
  for (std::size_t i = 0; i < part.elem_nodes.size(); ++i)
    for (std::size_t d = 0; d < 3; ++d) {
      const auto node = static_cast<std::size_t>(part.elem_nodes[i]);
      centroids[3 * (i / 8) + d] += 0.125 * (part.coordinates[3 * node + d] + u(node, d));
    }
  return centroids;
}

} // namespace

// `work` becomes that of this rank.
std::vector<float> ElementBalance::workOfElements(Simulation& simulation, const PartSeconds& spent,
                                                  double& work) const {
  const std::vector<char> rests = restingElements(simulation);
  std::vector<double> of_contact(rests.size(), 0.0);
  // Contact on other ranks is balanced by itself.
  if (simulation.contact() && simulation.config().search.decomposition == Decomposition::primary) {
    ContactStep& contact = *simulation.contact();
    const std::vector<float> of_face = contact.workOfFaces(contact.workOfNodes());
    const auto face_to_elem = toHost(simulation.scene().skin.face_to_elem);
    for (std::size_t face = 0; face < of_face.size(); ++face)
      if (!rests[face_to_elem(face)])
        of_contact[face_to_elem(face)] += of_face[face];
  }
  const double contact_work = std::accumulate(of_contact.begin(), of_contact.end(), 0.0);
  const auto moving = static_cast<double>(std::count(rests.begin(), rests.end(), 0));
  double sums[2] = {spent.elements, moving};
  allReduce(_comm, sums, 2, MPI_SUM);
  const double per_elem = sums[1] > 0 ? sums[0] / sums[1] : 0;
  double per_contact =
      allReduce(_comm, contact_work > 0 ? spent.contact / contact_work : HUGE_VAL, MPI_MIN);
  if (per_contact == HUGE_VAL)
    per_contact = 0;
  work = per_elem * moving + per_contact * contact_work;
  // If nothing moves or no time has been measured, ranks get equal numbers of elements.
  const double weight = per_elem > 0 ? per_elem : 1;
  std::vector<float> of_elem(rests.size());
  for (std::size_t elem = 0; elem < of_elem.size(); ++elem)
    of_elem[elem] = static_cast<float>(weight * (rests[elem] ? work_at_rest : 1) +
                                       per_contact * of_contact[elem]);
  return of_elem;
}

std::optional<std::vector<int>> ElementBalance::newRanks(Simulation& simulation,
                                                         const PartSeconds& now) {
  const std::int64_t step = simulation.clock().step;
  if (_config.rebalance == Rebalance::never || sizeOf(_comm) == 1 || step == 0 ||
      step % _config.interval != 0)
    return {};
  double work = 0;
  const std::vector<float> of_elem = workOfElements(
      simulation, {0, now.elements - _before.elements, now.contact - _before.contact}, work);
  _decision.addTime(now.step - _before.step);
  _before = now;
  const bool is_due = _decision.isDue(work, work);
  if (!_rebalancings.empty() && _rebalancings.back().imbalance_after == 0)
    _rebalancings.back().imbalance_after = _decision.imbalance();
  if (!is_due && _config.rebalance == Rebalance::automatic)
    return {};
  _rebalancings.push_back({step, 0, _decision.imbalance(), 0});
  std::vector<int> ranks = io::partitionPoints(_comm, simulation.scene().part.elem_ids,
                                               presentCentroids(simulation), of_elem);
  _expected_imbalance = imbalanceOf(_comm, of_elem, ranks);
  return ranks;
}

void ElementBalance::haveMoved(double seconds, const PartSeconds& now) {
  _decision.haveDistributed(seconds, _expected_imbalance);
  _rebalancings.back().seconds = seconds;
  _before = now;
}

} // namespace brickwall::miniapp
