#include "contact/enforcement/dormancy/surface_motion.hpp"

#include "contact/base/lanes.hpp"
#include "contact/base/mpi.hpp"
#include "contact/base/to_device.hpp"
#include "contact/base/vec3.hpp"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <vector>

namespace brickwall::contact {
namespace {

// Relative to the largest coordinate. Gaps are computed from unit vectors whose rounding is up to
// 1/sine times that of coordinates, and the sines used are at least 0.05.
constexpr double rounding_share = 1024 * DBL_EPSILON;
constexpr int piece_length = fills_lanes ? 256 : 4 * vector_lanes;

// A sum that is not above (side -1) or not below (side 1) the exact one.
KOKKOS_INLINE_FUNCTION double addBound(double sum, double step, int side) {
  if (step == 0)
    return sum;
  return sum + step + side * 4 * DBL_EPSILON * (std::fabs(sum) + std::fabs(step));
}

// Flags the nodes that have not moved since `last` nor in this step, updates `last` for the others,
// includes their motions in the boxes `step` [body][low xyz, high xyz] and counts them in `moving`
// [body]. On a device a thread takes a piece of a body with its lanes.
struct MeasureMotion {
  static constexpr int team_size = host_accessible ? 1 : 8;
  using Policy = Kokkos::TeamPolicy<exec_space, Kokkos::LaunchBounds<team_size * vector_lanes, 4>,
                                    launch_by_argument>;
  using Member = Policy::member_type;

  View<const double*[3]> x_old, x_new;
  View<const int*> piece_begin, piece_body;
  View<double* [3]> last;
  View<unsigned char*> stationary;
  View<double* [6]> step;
  View<int*> moving;

  struct Motion {
    double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL};
    double minus_high[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL};
    int num_moving = 0;
  };

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t piece) const {
    Motion motion;
    const int end = piece_begin(piece + 1);
    for (int node = piece_begin(piece); node < end; ++node)
      include(node, motion);
    add(piece, motion);
  }
  KOKKOS_INLINE_FUNCTION void operator()(const Member& team) const {
    const std::int64_t piece =
        std::int64_t(team.league_rank()) * team.team_size() + team.team_rank();
    if (piece >= static_cast<std::int64_t>(piece_body.extent(0)))
      return;
    OfLanes<Motion> of_lane;
    const int begin = piece_begin(piece), end = piece_begin(piece + 1);
    forLanes(team, [&](const int lane) {
      of_lane[lane] = Motion();
      for (int node = begin + lane; node < end; node += vector_lanes)
        include(node, of_lane[lane]);
    });
    Motion motion;
    for (int d = 0; d < 3; ++d) {
      motion.low[d] = leastOfLanes(team, [&](const int lane) { return of_lane[lane].low[d]; });
      motion.minus_high[d] =
          leastOfLanes(team, [&](const int lane) { return of_lane[lane].minus_high[d]; });
    }
    motion.num_moving = static_cast<int>(
        sumOfLanes(team, [&](const int lane) { return of_lane[lane].num_moving; }));
    Kokkos::single(Kokkos::PerThread(team), [&] { add(piece, motion); });
  }

private:
  KOKKOS_INLINE_FUNCTION void include(int node, Motion& motion) const {
    bool is_stationary = true;
    for (int d = 0; d < 3; ++d) {
      const double x = x_new(node, d), before = last(node, d), by = x - before;
      is_stationary &= sameBits(x, before);
      motion.low[d] = minOf(motion.low[d], by);
      motion.minus_high[d] = minOf(motion.minus_high[d], -by);
    }
    if (is_stationary)
      for (int d = 0; d < 3; ++d)
        is_stationary &= sameBits(x_new(node, d), x_old(node, d));
    else
      for (int d = 0; d < 3; ++d)
        last(node, d) = x_new(node, d);
    const bool was_stationary = stationary(node) != 0;
    stationary(node) = is_stationary ? (was_stationary ? SurfaceMotion::twice : 1) : 0;
    motion.num_moving += !is_stationary;
  }
  KOKKOS_INLINE_FUNCTION void add(std::int64_t piece, const Motion& motion) const {
    const int body = piece_body(piece);
    for (int d = 0; d < 3; ++d) {
      Kokkos::atomic_fetch_min(&step(body, d), motion.low[d]);
      Kokkos::atomic_fetch_max(&step(body, 3 + d), -motion.minus_high[d]);
    }
    if (motion.num_moving > 0)
      Kokkos::atomic_add(&moving(body), motion.num_moving);
  }
};

template <bool by_lanes, class Measure>
void measureMotion(const exec_space& space, const Measure& measure) {
  const auto num_pieces = static_cast<std::int64_t>(measure.piece_body.extent(0));
  if (num_pieces == 0)
    return;
  if constexpr (by_lanes) {
    const auto teams = dividedUp(num_pieces, Measure::team_size);
    Kokkos::parallel_for(
        "contact::SurfaceMotion::measureMotion",
        typename Measure::Policy(space, static_cast<int>(teams), Measure::team_size, vector_lanes),
        measure);
  } else {
    Kokkos::parallel_for("contact::SurfaceMotion::measureMotion", rangePolicy(space, num_pieces),
                         measure);
  }
}

// Largest coordinate in magnitude.
double measureExtent(const exec_space& space, const Surface& surface) {
  const auto x = surface.coordinates_new;
  double extent = 0;
  Kokkos::parallel_reduce(
      "contact::SurfaceMotion::measureExtent", rangePolicy(space, surface.num_nodes),
      KOKKOS_LAMBDA(const std::int64_t node, double& largest) {
        for (int d = 0; d < 3; ++d)
          largest = maxOf(largest, std::fabs(x(node, d)));
      },
      Kokkos::Max<double>(extent));
  return maxOf(extent, 0.0);
}

} // namespace

// Adds the boxes `step` to `sums` if `is_added`, and empties `step` and `moving`.
struct AddMotions {
  View<double*[6]> step, sums;
  View<int*> moving;
  View<unsigned char*> is_at_rest;
  bool is_added;

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t body,
                                         SurfaceMotion::AddedMotions& all) const {
    all.num_moving += moving(body);
    is_at_rest(body) = moving(body) == 0;
    moving(body) = 0;
    for (int d = 0; d < 3; ++d) {
      if (is_added) {
        sums(body, d) = addBound(sums(body, d), step(body, d), -1);
        sums(body, 3 + d) = addBound(sums(body, 3 + d), step(body, 3 + d), 1);
      }
      step(body, d) = HUGE_VAL;
      step(body, 3 + d) = -HUGE_VAL;
      const double of_sums = maxOf(std::fabs(sums(body, d)), std::fabs(sums(body, 3 + d)));
      all.largest = maxOf(all.largest, of_sums);
    }
  }
};

SurfaceMotion::SurfaceMotion(const exec_space& space, const std::string& label,
                             const Surface& surface)
    : _num_nodes(surface.num_nodes),
      _last(allocate<View<double* [3]>>(space, label + "::last_coordinates", surface.num_nodes)),
      _stationary_flags(label + "::stationary_nodes", surface.num_nodes) {
  _stationary = _stationary_flags;
  const auto body = toHost(surface.node_body);
  std::vector<global_id> bodies;
  for (int node = 0; node < surface.num_nodes; ++node)
    if (node == 0 || body(node) != body(node - 1))
      bodies.push_back(body(node));
  bodies = sortedDistinct(std::move(bodies));
  std::vector<int> begin, of_body;
  for (int node = 0; node < surface.num_nodes; ++node)
    if (node == 0 || body(node) != body(node - 1) || node - begin.back() == piece_length) {
      begin.push_back(node);
      of_body.push_back(static_cast<int>(
          std::lower_bound(bodies.begin(), bodies.end(), body(node)) - bodies.begin()));
    }
  begin.push_back(surface.num_nodes);
  _piece_begin = toDevice(space, label + "::piece_begin", begin);
  _piece_body = toDevice(space, label + "::piece_body", of_body);
  _step = View<double* [6]>(label + "::motion_of_step", bodies.size());
  _sums = View<double* [6]>(label + "::motion_of_bodies", bodies.size());
  _moving = View<int*>(label + "::moving_nodes", bodies.size());
  _is_at_rest = View<unsigned char*>(label + "::is_at_rest", bodies.size());
  _bodies = {toDevice(space, label + "::bodies", bodies), _sums, _is_at_rest};
  Kokkos::deep_copy(space, _last, static_cast<double>(NAN));
  launchSums(space); // empties the boxes
  Kokkos::deep_copy(space, _sums, 0.0);
  _added.read(space);
}

void SurfaceMotion::start(const exec_space& space, const Surface& surface) {
  measureMotion<!fills_lanes>(space, MeasureMotion{surface.coordinates_old, surface.coordinates_new,
                                                   _piece_begin, _piece_body, _last,
                                                   _stationary_flags, _step, _moving});
  launchSums(space);
  _has_started = true;
}

void SurfaceMotion::update(const exec_space& space, const Surface& surface) {
  if (!_has_started)
    start(space, surface);
  _has_started = false;
  const AddedMotions added = _added.read(space);
  if (!_has_last)
    _extent = measureExtent(space, surface);
  _has_last = true;
  _num_moving = added.num_moving;
  _rounding = rounding_share * (_extent + added.largest);
}

void SurfaceMotion::launchSums(const exec_space& space) {
  Kokkos::parallel_reduce("contact::SurfaceMotion::addMotions",
                          rangePolicy(space, static_cast<std::int64_t>(_sums.extent(0))),
                          AddMotions{_step, _sums, _moving, _is_at_rest, _has_last},
                          _added.next(space));
}

} // namespace brickwall::contact
