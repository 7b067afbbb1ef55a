// See surface_motion.hpp.
#include "contact/enforcement/dormancy/surface_motion.hpp"

#include "contact/base/to_device.hpp"
#include "contact/base/vec3.hpp"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <vector>

namespace brickwall::contact {
namespace {

// Of the greatest coordinate: gaps are found from unit vectors whose rounding is up to 1/sine of that of coordinates, and sines that
// are made use of are .05 at least.
constexpr double rounding_share = 1024 * DBL_EPSILON;
constexpr int piece_length = simd_width > 1 ? 256 : 16;

// A sum that is not above (side -1) or not below (side 1) the true one.
KOKKOS_INLINE_FUNCTION double addBound(double sum, double step, int side) {
  if (step == 0)
    return sum;
  return sum + step + side * 4 * DBL_EPSILON * (std::fabs(sum) + std::fabs(step));
}

} // namespace

SurfaceMotion::SurfaceMotion(const exec_space& space, const std::string& label,
                             const Surface& surface)
    : _num_nodes(surface.num_nodes),
      _last(allocate<View<double* [3]>>(space, label + "::last_coordinates", surface.num_nodes)),
      _flags(label + "::still_nodes", surface.num_nodes) {
  _still = _flags;
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
  addUp(space); // empties the boxes
  Kokkos::deep_copy(space, _sums, 0.0);
  space.fence();
}

void SurfaceMotion::update(const exec_space& space, const Surface& surface) {
  measure(space, surface);
  addUp(space);
  if (!_has_last)
    measureExtent(space, surface);
  _has_last = true;
}

void SurfaceMotion::measure(const exec_space& space, const Surface& surface) {
  const auto x_old = surface.coordinates_old, x_new = surface.coordinates_new;
  const auto last = _last;
  const auto still = _flags;
  const auto piece_begin = _piece_begin, piece_body = _piece_body;
  const auto step = _step;
  _num_moving = 0;
  Kokkos::parallel_reduce(
      "contact::SurfaceMotion::measure",
      rangePolicy(space, static_cast<std::int64_t>(piece_body.extent(0))),
      KOKKOS_LAMBDA(const std::int64_t piece, std::int64_t& moving) {
        double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
        const int end = piece_begin(piece + 1);
        for (int node = piece_begin(piece); node < end; ++node) {
          bool is_still = true;
          for (int d = 0; d < 3; ++d) {
            const double x = x_new(node, d), before = last(node, d), by = x - before;
            is_still &= sameBits(x, before);
            low[d] = minOf(low[d], by);
            high[d] = maxOf(high[d], by);
          }
          if (is_still)
            for (int d = 0; d < 3; ++d)
              is_still &= sameBits(x_new(node, d), x_old(node, d));
          else
            for (int d = 0; d < 3; ++d)
              last(node, d) = x_new(node, d);
          still(node) = is_still;
          moving += !is_still;
        }
        const int body = piece_body(piece);
        for (int d = 0; d < 3; ++d) {
          Kokkos::atomic_fetch_min(&step(body, d), low[d]);
          Kokkos::atomic_fetch_max(&step(body, 3 + d), high[d]);
        }
      },
      _num_moving);
}

// The sums take in the boxes of this call, which are emptied; of the first call there are none.
void SurfaceMotion::addUp(const exec_space& space) {
  const auto step = _step, sums = _sums;
  const bool has_last = _has_last;
  double farthest = 0;
  Kokkos::parallel_reduce(
      "contact::SurfaceMotion::addUp",
      rangePolicy(space, static_cast<std::int64_t>(step.extent(0))),
      KOKKOS_LAMBDA(const std::int64_t body, double& most) {
        for (int d = 0; d < 3; ++d) {
          if (has_last) {
            sums(body, d) = addBound(sums(body, d), step(body, d), -1);
            sums(body, 3 + d) = addBound(sums(body, 3 + d), step(body, 3 + d), 1);
          }
          step(body, d) = HUGE_VAL;
          step(body, 3 + d) = -HUGE_VAL;
          most = maxOf(most, maxOf(std::fabs(sums(body, d)), std::fabs(sums(body, 3 + d))));
        }
      },
      Kokkos::Max<double>(farthest));
  _rounding = rounding_share * (_extent + maxOf(farthest, 0.0));
}

void SurfaceMotion::measureExtent(const exec_space& space, const Surface& surface) {
  const auto x = surface.coordinates_new;
  double extent = 0;
  Kokkos::parallel_reduce(
      "contact::SurfaceMotion::extent", rangePolicy(space, _num_nodes),
      KOKKOS_LAMBDA(const std::int64_t node, double& most) {
        for (int d = 0; d < 3; ++d)
          most = maxOf(most, std::fabs(x(node, d)));
      },
      Kokkos::Max<double>(extent));
  _extent = maxOf(extent, 0.0);
  _rounding = rounding_share * _extent;
}

} // namespace brickwall::contact
