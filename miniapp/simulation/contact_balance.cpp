#include "miniapp/simulation/contact_balance.hpp"

#include "contact/base/mpi.hpp"
#include "contact/base/to_device.hpp"
#include "io/mesh/partition.hpp"

#include <algorithm>

namespace brickwall::miniapp {

namespace {

double imbalanceOf(MPI_Comm comm, const MaxAndSum& all) {
  return all.sum > 0 ? all.max * sizeOf(comm) / all.sum : 1;
}

} // namespace

double imbalanceOf(MPI_Comm comm, double work) {
  return imbalanceOf(comm, maxAndSum(comm, {work}).front());
}

double imbalanceOf(MPI_Comm comm, const std::vector<float>& work,
                   const std::vector<int>& rank_of_face) {
  std::vector<double> of_rank(sizeOf(comm), 0);
  for (std::size_t face = 0; face < work.size(); ++face)
    of_rank[rank_of_face[face]] += work[face];
  allReduce(comm, of_rank.data(), sizeOf(comm), MPI_SUM);
  return imbalanceOf(comm, of_rank[rankOf(comm)]);
}

std::vector<int> balancedRanks(MPI_Comm comm, const contact::Surface& surface,
                               const std::vector<float>& work) {
  const auto corners = toHost(surface.face_to_nodes);
  const auto x = toHost(surface.coordinates_new);
  const auto face_ids = toHost(surface.face_ids);
  std::vector<double> centres(3 * static_cast<std::size_t>(surface.num_faces), 0.0);
  for (int face = 0; face < surface.num_faces; ++face)
    for (int j = 0; j < 4; ++j)
      for (int d = 0; d < 3; ++d)
        centres[3 * static_cast<std::size_t>(face) + d] += 0.25 * x(corners(face, j), d);
  const std::vector<global_id> ids(face_ids.data(), face_ids.data() + surface.num_faces);
  return io::partitionPoints(comm, ids, centres, work);
}

bool ContactBalance::isDue(double work) {
  const std::vector<MaxAndSum> all = maxAndSum(_comm, {work, _time, _cost});
  _imbalance = imbalanceOf(_comm, all[0]);
  const double time = all[1].max, cost = all[2].max;
  _time = 0;
  const double rate = all[0].max > 0 ? time / all[0].max : 0;
  if (_are_home) {
    _rate_at_home = rate;
  } else if (_rate_at_home > 0) { // the least, since other programs disturb
    const double overhead = std::max(1.0, rate / _rate_at_home);
    _overhead = _is_measured ? std::min(_overhead, overhead) : overhead;
    _is_measured = true;
  }
  const double now = _are_home ? _imbalance : _overhead * _imbalance;
  const double best = std::min(_overhead * _reached, _are_home ? HUGE_VAL : _at_home);
  _lost += time * std::max(0.0, 1 - best / now);
  return _lost > cost;
}

void ContactBalance::haveDistributed(double seconds, double imbalance, double at_home,
                                     bool are_home) {
  _cost = seconds;
  _time = _lost = 0;
  _reached = std::max(tolerated, imbalance);
  _at_home = at_home;
  _are_home = are_home;
  _is_measured = are_home;
  ++_distributions;
}

} // namespace brickwall::miniapp
