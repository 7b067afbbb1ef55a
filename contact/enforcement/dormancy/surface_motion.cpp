#include "contact/enforcement/dormancy/surface_motion.hpp"

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
constexpr int piece_length = simd_width > 1 ? 256 : 16;

// A sum that is not above (side -1) or not below (side 1) the exact one.
KOKKOS_INLINE_FUNCTION double addBound(double sum, double step, int side) {
  if (step == 0)
    return sum;
  return sum + step + side * 4 * DBL_EPSILON * (std::fabs(sum) + std::fabs(step));
}

// Flags the nodes that have not moved since `last` nor in this step, updates `last` for the others,
// and includes their motions in the boxes `step` [body][low xyz, high xyz]. Returns the number of
// nodes that moved.
std::int64_t measureMotion(const exec_space& space, const Surface& surface,
                           const View<int*>& piece_begin, const View<int*>& piece_body,
                           const View<double* [3]>& last, const View<unsigned char*>& stationary,
                           const View<double* [6]>& step) {
  const auto x_old = surface.coordinates_old, x_new = surface.coordinates_new;
  std::int64_t num_moving = 0;
  Kokkos::parallel_reduce(
      "contact::SurfaceMotion::measureMotion",
      rangePolicy(space, static_cast<std::int64_t>(piece_body.extent(0))),
      KOKKOS_LAMBDA(const std::int64_t piece, std::int64_t& moving) {
        double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
        const int end = piece_begin(piece + 1);
        for (int node = piece_begin(piece); node < end; ++node) {
          bool is_stationary = true;
          for (int d = 0; d < 3; ++d) {
            const double x = x_new(node, d), before = last(node, d), by = x - before;
            is_stationary &= sameBits(x, before);
            low[d] = minOf(low[d], by);
            high[d] = maxOf(high[d], by);
          }
          if (is_stationary)
            for (int d = 0; d < 3; ++d)
              is_stationary &= sameBits(x_new(node, d), x_old(node, d));
          else
            for (int d = 0; d < 3; ++d)
              last(node, d) = x_new(node, d);
          stationary(node) = is_stationary;
          moving += !is_stationary;
        }
        const int body = piece_body(piece);
        for (int d = 0; d < 3; ++d) {
          Kokkos::atomic_fetch_min(&step(body, d), low[d]);
          Kokkos::atomic_fetch_max(&step(body, 3 + d), high[d]);
        }
      },
      num_moving);
  return num_moving;
}

// Adds the boxes `step` to `sums` if `is_added`, and empties them. Returns the largest component of
// the sums.
double addMotions(const exec_space& space, bool is_added, const View<double* [6]>& step,
                  const View<double* [6]>& sums) {
  double largest_sum = 0;
  Kokkos::parallel_reduce(
      "contact::SurfaceMotion::addMotions",
      rangePolicy(space, static_cast<std::int64_t>(step.extent(0))),
      KOKKOS_LAMBDA(const std::int64_t body, double& largest) {
        for (int d = 0; d < 3; ++d) {
          if (is_added) {
            sums(body, d) = addBound(sums(body, d), step(body, d), -1);
            sums(body, 3 + d) = addBound(sums(body, 3 + d), step(body, 3 + d), 1);
          }
          step(body, d) = HUGE_VAL;
          step(body, 3 + d) = -HUGE_VAL;
          largest = maxOf(largest, maxOf(std::fabs(sums(body, d)), std::fabs(sums(body, 3 + d))));
        }
      },
      Kokkos::Max<double>(largest_sum));
  return maxOf(largest_sum, 0.0);
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
  std::sort(bodies.begin(), bodies.end());
  bodies.erase(std::unique(bodies.begin(), bodies.end()), bodies.end());
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
  _bodies.bodies = toDevice(space, label + "::bodies", bodies);
  _bodies.sums = _sums;
  Kokkos::deep_copy(space, _last, static_cast<double>(NAN));
  accumulateMotion(space); // empties the boxes
  Kokkos::deep_copy(space, _sums, 0.0);
  space.fence();
}

void SurfaceMotion::update(const exec_space& space, const Surface& surface) {
  _num_moving =
      measureMotion(space, surface, _piece_begin, _piece_body, _last, _stationary_flags, _step);
  accumulateMotion(space);
  if (!_has_last) {
    _extent = measureExtent(space, surface);
    _rounding = rounding_share * _extent;
  }
  _has_last = true;
}

void SurfaceMotion::accumulateMotion(const exec_space& space) {
  _rounding = rounding_share * (_extent + addMotions(space, _has_last, _step, _sums));
}

} // namespace brickwall::contact
