// The stable step of deformed bodies by the frequency of the bodies at rest: never above the true
// one, and not far below it.
#include "mechanics/element/symmetric_eigenvalue.hpp"
#include "mechanics/stability/largest_frequency.hpp"
#include "tests/mechanics/support/solver.hpp"

#include <gtest/gtest.h>

namespace {

using namespace brickwall;
using namespace brickwall::mechanics;
using namespace brickwall::mechanics::testing;

constexpr int unknowns = 108; // 3x2x2 elements

// 2/omega of K(u) by differences of the forces, symmetrised and divided by the masses.
double trueStep(Solver& solver, const View<double* [3]>& displacement) {
  static double K[unknowns][unknowns];
  constexpr double h = 1e-5;
  const auto u = toHost(displacement);
  const auto mass = toHost(solver.state.mass);
  for (int k = 0; k < unknowns; ++k) {
    const double at = u(k / 3, k % 3);
    for (const double sign : {1.0, -1.0}) {
      u(k / 3, k % 3) = at + sign * h;
      Kokkos::deep_copy(solver.state.displacement, u);
      zeroForces(solver.space, solver.forces);
      const auto result =
          solver.internal->add(solver.space, solver.state.displacement, solver.forces, false);
      EXPECT_EQ(result.failure.count, 0);
      const auto f = toHost(solver.forces.values);
      for (int r = 0; r < unknowns; ++r) {
        const double force = solver.forces.quantum.value *
                             static_cast<double>(f(r / 3, r % 3) + f(r / 3, 3 + r % 3));
        K[r][k] = (sign > 0 ? 0 : K[r][k]) -
                  sign * force / (2 * h * std::sqrt(mass(r / 3) * mass(k / 3)));
      }
    }
    u(k / 3, k % 3) = at;
  }
  for (int r = 0; r < unknowns; ++r)
    for (int c = 0; c < r; ++c)
      K[r][c] = K[c][r] = 0.5 * (K[r][c] + K[c][r]);
  return 2 / std::sqrt(largestEigenvalue(K));
}

Vec3 turned(const Vec3& x) { // by 50 degrees
  const double c = std::cos(0.87), s = std::sin(0.87);
  return {c * x.x - s * x.y, s * x.x + c * x.y, x.z};
}

struct Deformation {
  bool is_smooth;
  const char* name;
  std::function<Vec3(const Vec3&)> displacement;
};
Vec3 noise(const Vec3& x, double size) {
  const auto seed = static_cast<std::uint64_t>(1e4 * (x.x + 10 * x.y + 100 * x.z) + 0.5);
  return size * randomVector(3 * seed);
}
std::vector<Deformation> deformations(double size) {
  return {
      {true, "none", [](const Vec3&) { return Vec3{}; }},
      {true, "swollen", [=](const Vec3& x) { return size * x; }},
      {true, "shrunk", [=](const Vec3& x) { return -size * x; }},
      {true, "pulled",
       [=](const Vec3& x) {
         return Vec3{size * x.x, 0, 0};
       }},
      {true, "pushed",
       [=](const Vec3& x) {
         return Vec3{-size * x.x, 0, 0};
       }},
      {true, "sheared",
       [=](const Vec3& x) {
         return Vec3{2 * size * x.y, 0, 0};
       }},
      {true, "turned", [](const Vec3& x) { return turned(x) - x; }},
      {true, "turned and pushed",
       [=](const Vec3& x) {
         return turned({x.x, (1 - size) * x.y, x.z}) - x;
       }},
      {true, "bent",
       [=](const Vec3& x) {
         return size * Vec3{x.x * x.y, -0.5 * x.x * x.x, 0};
       }},
      {true, "twisted",
       [=](const Vec3& x) {
         return size * Vec3{0, -x.x * x.z, x.x * x.y};
       }},
      {false, "noisy", [=](const Vec3& x) { return noise(x, size); }},
      {false, "turned and noisy", [=](const Vec3& x) { return turned(x + noise(x, size)) - x; }},
  };
}

// Comparison of the step with the true one over all deformations.
void checkSteps(ElementKind kind, MaterialModel model, double distortion, double size) {
  const Block block{{3, 2, 2}, {3, 2, 2}};
  Solver solver(
      MPI_COMM_SELF, block, steelLike(model, 0.3), {},
      [&](const Vec3& x) { return x + noise(x, distortion); }, kind);
  const HexMesh& mesh = solver.blocks.mesh;
  const RestFrequency rest =
      largestFrequency(solver.space, MPI_COMM_SELF, mesh, solver.blocks.shared, solver.state.mass,
                       findBodyTypes(solver.space, MPI_COMM_SELF, mesh), kind, solver.stableStep())
          .bound;
  for (const Deformation& deformation : deformations(size)) {
    const auto u = nodalField(solver.space, mesh, deformation.displacement);
    const auto stepOf = [&](const RestFrequency& known, double enough) {
      return stableTimeStep(solver.space, MPI_COMM_SELF, mesh, u, {}, known, enough).dt;
    };
    const std::string what = std::string(deformation.name) + " by " + std::to_string(size) +
                             ", model " + std::to_string(static_cast<int>(model)) +
                             ", distortion " + std::to_string(distortion);
    const double exact = trueStep(solver, u), step = stepOf(rest, HUGE_VAL);
    EXPECT_LE(step, exact * (1 + 1e-6)) << what;
    EXPECT_GE(step, deformation.is_smooth ? (1 - 3 * size) * exact : 0.7 * exact) << what;
    EXPECT_LE(stepOf(rest, 0), step * (1 + 1e-12)) << what; // norms suffice
    EXPECT_GE(step, stepOf({}, HUGE_VAL)) << what;
    // norms do not suffice, so eigenvalues are used
    EXPECT_EQ(stepOf(rest, 1.01 * step), step) << what;
  }
}

TEST(DeformedStep, IsSafeAndCloseToTheTrueStep) {
  if (sizeOf(world) > 1)
    GTEST_SKIP() << "runs on one rank only";
  for (const ElementKind kind : {ElementKind::one_point, ElementKind::full})
    for (const MaterialModel model : all_models)
      for (const double distortion : {0.0, 0.1}) {
        checkSteps(kind, model, distortion, 0.01);
        checkSteps(kind, model, distortion, 0.05);
      }
}

TEST(DeformedStep, OfAnInvertedElementIsZero) {
  Solver solver(MPI_COMM_SELF, Block(), steelLike(), {});
  const auto u = solver.field([](const Vec3& x) { return Vec3{-2 * x.x, 0, 0}; });
  EXPECT_EQ(stableTimeStep(solver.space, MPI_COMM_SELF, solver.blocks.mesh, u, {}, {1, 1}, 0.1).dt,
            0);
}

} // namespace
