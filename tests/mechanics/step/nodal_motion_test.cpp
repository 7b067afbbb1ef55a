// The last good state after a failed step: a step is undone up to rounding.
#include "mechanics/step/nodal_motion.hpp"
#include "tests/mechanics/support/solver.hpp"

#include <gtest/gtest.h>

namespace {

using namespace brickwall;
using namespace brickwall::mechanics;
using namespace brickwall::mechanics::testing;

auto copyOf(const View<double* [3]>& values) {
  const View<double* [3]> copy("copy", values.extent(0));
  Kokkos::deep_copy(copy, values);
  return copy;
}

double largestDifference(const View<double* [3]>& a, const View<double* [3]>& b) {
  const auto of_a = toHost(a), of_b = toHost(b);
  double largest = 0;
  for (std::size_t node = 0; node < a.extent(0); ++node)
    for (int d = 0; d < 3; ++d)
      largest = std::max(largest, std::fabs(of_a(node, d) - of_b(node, d)));
  return largest;
}

// A bar of length 1. One end is driven by pulses of speed 1 that begin and end within these steps,
// the other end is fixed.
void undoEachStep(PulseKind kind) {
  Solver bar(MPI_COMM_WORLD, mechanics::testing::bar(6), steelLike());
  const double dt = 0.5 * bar.stableStep();
  PrescribedMotion driven, held;
  driven.nodes = bar.nodesWhere([](const Vec3& X) { return X.x == 0; });
  driven.component[1] = false;
  driven.velocity = {1, 0, -0.5};
  driven.shape.kind = kind;
  driven.shape.duration = 7.3 * dt;
  driven.start = 3.6 * dt;
  held.nodes = bar.nodesWhere([](const Vec3& X) { return X.x > 0.99; });
  bar.fix({driven, held}, {0, 0, -0.1}, 0.2);
  bar.start(dt);
  for (int step = 0; step < 15; ++step) {
    const double time = bar.time;
    const auto u = copyOf(bar.state.displacement), v = copyOf(bar.state.velocity);
    bar.step(dt);
    const auto u_after = copyOf(bar.state.displacement), v_after = copyOf(bar.state.velocity);
    undoKickAndDrift(bar.space, bar.blocks.mesh, *bar.boundary, {time, bar.time}, dt, dt,
                     bar.forces, bar.state);
    EXPECT_LE(largestDifference(bar.state.velocity, v), 4e-15) << "in step " << step;
    EXPECT_LE(largestDifference(bar.state.displacement, u), 1e-15) << "in step " << step;
    Kokkos::deep_copy(bar.state.displacement, u_after);
    Kokkos::deep_copy(bar.state.velocity, v_after);
  }
}

TEST(UndoKickAndDrift, RestoresTheStateWithDrivenEnds) {
  for (const PulseKind kind : {PulseKind::step, PulseKind::half_sine, PulseKind::triangle})
    undoEachStep(kind);
}

} // namespace
