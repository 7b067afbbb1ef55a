// Pulses and their means over steps: against quadrature, and sums over steps against the closed
// form of any pulse.
#include "tests/mechanics/support/solver.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace brickwall::mechanics {
namespace {

constexpr double unit_roundoff = 1.1102230246251565e-16;

// Pulses of unit duration and peak.
struct Case {
  PulseShape shape;
  double impulse;
};
std::vector<Case> allPulses() {
  const auto friedlander = [](double b) {
    return Case{{PulseKind::friedlander, 1, 0.5, b}, 1 / b - (1 - std::exp(-b)) / (b * b)};
  };
  return {{{PulseKind::step, 1}, 1},
          {{PulseKind::half_sine, 1}, 2 / M_PI},
          {{PulseKind::sin_squared, 1}, 0.5},
          {{PulseKind::triangle, 1, 0.25}, 0.5},
          {{PulseKind::triangle, 1, 0.0}, 0.5},
          {{PulseKind::triangle, 1, 1.0}, 0.5},
          {{PulseKind::friedlander, 1, 0.5, 0.0}, 0.5},
          friedlander(1.7),
          friedlander(30)};
}

double valueOf(const PulseShape& shape, double t) {
  return shape.mean({t, t});
}

// The definitions, evaluated by the mathematical library in long double.
long double exactValue(const PulseShape& shape, long double s) {
  const long double exact_pi = 3.14159265358979323846264338327950288L,
                    sine = std::sin(exact_pi * s);
  switch (shape.kind) {
  case PulseKind::half_sine:
    return sine;
  case PulseKind::sin_squared:
    return sine * sine;
  case PulseKind::triangle:
    return s < shape.rise ? s / shape.rise : (1 - s) / (1 - shape.rise);
  case PulseKind::friedlander:
    return (1 - s) * std::exp(-shape.decay * s);
  default:
    return 1;
  }
}

// Integral from a to b by Simpson's rule on 1600 intervals between the kinks; its error is at most
// (b - a)^4 30^3/(2880 1600^4) = 2e-12.
long double exactIntegral(const PulseShape& shape, long double a, long double b) {
  const long double kink = shape.rise;
  if (shape.kind == PulseKind::triangle && a < kink && kink < b)
    return exactIntegral(shape, a, kink) + exactIntegral(shape, kink, b);
  constexpr int n = 1600;
  const long double h = (b - a) / n;
  // The value at a kink is that of the piece that ends there.
  const auto at = [&](int i, long double part) {
    const long double s = a + (i + part) * h;
    return exactValue(shape, shape.kind == PulseKind::triangle && b <= kink && s >= kink
                                 ? std::nextafter(kink, -1.0L)
                                 : s);
  };
  long double sum = 0;
  for (int i = 0; i < n; ++i)
    sum += (at(i, 0) + 4 * at(i, 0.5L) + at(i, 1)) * (h / 6);
  return sum;
}

TEST(PulseShape, MeansAreThoseOfQuadrature) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> anywhere(-0.5, 1.5), exponent(-12, 0);
  for (const Case& c : allPulses())
    for (int i = 0; i < 200; ++i) {
      const double begin = anywhere(random), end = begin + 1.5 * std::exp2(exponent(random));
      const double a = std::max(begin, 0.0), b = std::min(end, 1.0);
      const double exact =
          a < b ? static_cast<double>(exactIntegral(c.shape, a, b) / (end - begin)) : 0;
      EXPECT_NEAR(c.shape.mean({begin, end}), exact, 2e-12)
          << static_cast<int>(c.shape.kind) << " from " << begin << " to " << end;
    }
}

TEST(PulseShape, InstantsHaveTheValueOfTheShape) {
  for (const Case& c : allPulses())
    for (const double s : {0.0, 0.1, 0.24, 0.26, 0.5, 0.9})
      EXPECT_NEAR(valueOf(c.shape, s), static_cast<double>(exactValue(c.shape, s)),
                  8 * unit_roundoff);
  for (const Case& c : allPulses()) {
    EXPECT_EQ(valueOf(c.shape, -1e-9), 0);
    EXPECT_EQ(valueOf(c.shape, 1 + 1e-9), 0);
  }
  EXPECT_EQ(valueOf(PulseShape(), -5), 1);
  EXPECT_EQ(valueOf({PulseKind::step}, 1e9), 1);
  EXPECT_EQ(PulseShape{PulseKind::step}.mean({-1, 3}), 0.75);
}

// Step lengths without a finite binary representation, summed as by the clock; kicks reach from
// midpoint to midpoint. Each mean errs by some roundings of its part of the pulse, each step by the
// rounding of the times at its ends, 2^-53 t/dt of it.
TEST(PulseShape, ImpulsesOfKicksSumToTheClosedForm) {
  constexpr double dt = 0.0123;
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> exponent(-3, 3), any(0, 1);
  for (const Case& c : allPulses())
    for (int i = 0; i < 60; ++i) {
      PulseShape shape = c.shape;
      shape.duration = dt * std::pow(10, exponent(random));
      const double start = i == 0 ? 0 : dt * std::pow(1000, any(random)) * any(random);
      long double impulse = 0;
      double until = 0, t = 0;
      for (bool first = true; until < start + shape.duration; first = false) {
        const double end = t + 0.5 * dt;
        impulse += (first ? 0.5 : 1) * dt * shape.mean({until - start, end - start});
        until = end;
        t += dt;
      }
      const double exact = shape.duration * c.impulse;
      EXPECT_NEAR(static_cast<double>(impulse), exact,
                  shape.duration * unit_roundoff * (32 + 2 * until / dt))
          << static_cast<int>(shape.kind) << " of " << shape.duration / dt << " steps from "
          << start / dt;
    }
}

TEST(PulseShape, MeansOfResolvedPulsesAreTheValueToSecondOrder) {
  for (const Case& c : allPulses()) {
    const double t = 0.37, value = valueOf(c.shape, t);
    const auto error = [&](double h) {
      return std::fabs(c.shape.mean({t - 0.5 * h, t + 0.5 * h}) - value);
    };
    if (c.shape.kind == PulseKind::step || c.shape.kind == PulseKind::triangle ||
        c.shape.decay == 0) // linear there
      EXPECT_LE(error(0.02), 8 * unit_roundoff);
    else
      EXPECT_NEAR(std::log2(error(0.02) / error(0.01)), 2, 0.01); // next term: (30 h)^2/80 of it
  }
}

// Displacements are sums of steps times means over [t^n, t^{n+1}], as exact as the impulses of
// kicks.
TEST(PrescribedMotion, HasTheDisplacementOfItsPulse) {
  for (const Case& c : allPulses())
    for (const double steps : {0.01, 0.2, 0.8, 1.0, 7.3, 40.0}) {
      testing::Solver solver(MPI_COMM_WORLD, testing::bar(3), testing::steelLike());
      const double dt = 0.5 * solver.stableStep();
      PrescribedMotion motion;
      motion.nodes = solver.nodesWhere([](const Vec3& X) { return X.x == 0; });
      motion.velocity = {1e-3, 2e-3, 0};
      motion.shape = c.shape;
      motion.shape.duration = steps * dt;
      motion.start = 2.7 * dt;
      solver.fix({motion});
      solver.start(dt);
      const int needed = static_cast<int>(steps) + 5;
      for (int step = 0; step < needed; ++step)
        solver.step(dt);
      const double far = steps * dt * c.impulse;
      const auto u = toHost(solver.state.displacement);
      for (const int node : motion.nodes) {
        const double rounded = steps * dt * unit_roundoff * (32 + 4 * needed);
        EXPECT_NEAR(u(node, 0), 1e-3 * far, 1e-3 * rounded) << steps;
        EXPECT_NEAR(u(node, 1), 2e-3 * far, 2e-3 * rounded) << steps;
        EXPECT_EQ(u(node, 2), 0);
      }
    }
}

// A dead pressure on one end of a bar. A front that arrives later at other positions gives every
// position the same impulse.
TEST(Pressure, HasTheImpulseOfItsPulse) {
  for (const Case& c : allPulses())
    for (const double steps : {0.003, 0.5, 3.3})
      for (const double speed : {HUGE_VAL, 0.05}) {
        testing::Solver solver(MPI_COMM_WORLD, testing::cube(2), testing::steelLike());
        const double dt = 0.5 * solver.stableStep();
        Pressure pressure;
        pressure.peak = 1e-3;
        pressure.follower = false;
        pressure.shape = c.shape;
        pressure.shape.duration = steps * dt;
        pressure.start = 1.9 * dt;
        pressure.gaussian = speed < HUGE_VAL;
        pressure.radius = 1e30; // practically uniform
        pressure.speed = speed / dt;
        solver.press(pressure, [](const Vec3& X) { return X.x == 0; });
        solver.start(dt);
        for (int step = 0; step < 40; ++step) // at a distance of sqrt(2) it arrives 28 steps later
          solver.step(dt);
        const double exact = 1e-3 * steps * dt * c.impulse;
        // Each of 16 corner loads of a step is rounded to a quantum.
        const double tolerance =
            1e-3 * steps * dt * unit_roundoff * 128 + 41 * 16 * dt * solver.forces.quantum.value;
        const Vec3 impulse = solver.ledger.balance().impulse_external;
        EXPECT_NEAR(impulse.x, exact, tolerance) << static_cast<int>(c.shape.kind) << " " << steps;
        EXPECT_NEAR(impulse.y, 0, tolerance);
      }
}

} // namespace
} // namespace brickwall::mechanics
