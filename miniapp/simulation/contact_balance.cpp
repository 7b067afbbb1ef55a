#include "miniapp/simulation/contact_balance.hpp"

#include "contact/base/mpi.hpp"
#include "contact/base/to_device.hpp"
#include "io/mesh/partition.hpp"

#include <algorithm>
#include <utility>

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

bool ContactBalance::isDue(double work, double work_at_home) {
  const std::vector<MaxAndSum> all = maxAndSum(_comm, {work, work_at_home, _time, _cost});
  _imbalance = imbalanceOf(_comm, all[0]);
  _at_home = imbalanceOf(_comm, all[1]);
  const double time = all[2].max, cost = all[3].max;
  _time = 0;
  const double rate = all[1].max > 0 ? time / all[1].max : 0;
  if (_are_home)
    _rate_at_home = rate;
  else if (!std::exchange(_is_measured, true) && tolerated * rate > _rate_at_home) {
    const bool is_first = !std::exchange(_has_failed, true);
    _overhead = is_first ? tolerated * std::max(_overhead, _at_home) : HUGE_VAL;
    return true;
  }
  const double now = _are_home ? _imbalance : _overhead * _imbalance;
  const double best = std::min(_overhead * _reached, _are_home ? HUGE_VAL : _at_home);
  _lost += time * std::max(0.0, 1 - best / now);
  return _lost > cost && !(_are_home && isHomeBetter());
}

void ContactBalance::haveDistributed(double seconds, double imbalance, bool are_home) {
  _cost = seconds;
  _time = _lost = 0;
  _reached = std::max(tolerated, imbalance);
  _is_measured = !_are_home;
  _are_home = are_home;
  ++_distributions;
}

} // namespace brickwall::miniapp
