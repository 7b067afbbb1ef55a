// The closest-point projection, without a launch, against exact answers.
#include "contact/surface/projection.hpp"

#include <gtest/gtest.h>

#include <random>

namespace brickwall::contact {
namespace {

Vec3 pointOf(const Quad& f, double xi, double eta) {
  return 0.25 * ((1 - xi) * (1 - eta) * f.corner[0] + (1 + xi) * (1 - eta) * f.corner[1] +
                 (1 + xi) * (1 + eta) * f.corner[2] + (1 - xi) * (1 + eta) * f.corner[3]);
}
Vec3 normalOf(const Quad& f, double xi, double eta) {
  const Vec3 t_xi =
      (1 - eta) * (f.corner[1] - f.corner[0]) + (1 + eta) * (f.corner[2] - f.corner[3]);
  const Vec3 t_eta =
      (1 - xi) * (f.corner[3] - f.corner[0]) + (1 + xi) * (f.corner[2] - f.corner[1]);
  const Vec3 n = cross(t_xi, t_eta);
  return (1 / norm(n)) * n;
}
Quad unitSquare() {
  return {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}};
}

TEST(Projection, PointAboveAFlatSquareIsExact) {
  const FacePoint p = project(unitSquare(), {0.25, 0.75, 0.5});
  ASSERT_TRUE(p.valid);
  EXPECT_EQ(p.gap, 0.5);
  EXPECT_EQ(p.normal.x, 0);
  EXPECT_EQ(p.normal.y, 0);
  EXPECT_EQ(p.normal.z, 1);
  EXPECT_EQ(p.excess, -0.5);
  EXPECT_EQ(p.weight[0], 0.75 * 0.25);
  EXPECT_EQ(p.weight[1], 0.25 * 0.25);
  EXPECT_EQ(p.weight[2], 0.25 * 0.75);
  EXPECT_EQ(p.weight[3], 0.75 * 0.75);
}

TEST(Projection, NormalOfAFlatFaceIsExactlyFlatAtAnyPlace) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int trial = 0; trial < 1000; ++trial) {
    const double z = 1 / 3.0 + trial;
    Quad f = unitSquare();
    for (Vec3& corner : f.corner)
      corner = {corner.x + 0.1 * uniform(random) + 1e3, corner.y + 0.1 * uniform(random) - 7, z};
    const FacePoint p = project(f, {1000.5, -6.5, z - 0.01});
    ASSERT_TRUE(p.valid);
    EXPECT_EQ(p.normal.x, 0);
    EXPECT_EQ(p.normal.y, 0);
    EXPECT_EQ(p.normal.z, 1);
    EXPECT_EQ(p.gap, (z - 0.01) - z);
  }
}

// A point g n above a warped face is projected back. Warp w and gap g stay well inside the radius
// of curvature, about 1/w, so the closest point is unique. Newton's method ends with an error of
// about the condition of the Hessian (< 10) times the rounding of coordinates of size 10: 1e-13 is
// generous by a factor of ten.
TEST(Projection, RandomWarpedQuadsGiveBackParametersAndGap) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int trial = 0; trial < 20000; ++trial) {
    Quad f = unitSquare();
    for (Vec3& corner : f.corner)
      corner += Vec3{0.2 * uniform(random) + 3, 0.2 * uniform(random), 0.2 * uniform(random)};
    const double xi = 1.05 * uniform(random), eta = 1.05 * uniform(random);
    const double gap = 0.2 * uniform(random);
    const Vec3 normal = normalOf(f, xi, eta);
    const FacePoint p = project(f, pointOf(f, xi, eta) + gap * normal);
    ASSERT_TRUE(p.valid) << trial;
    EXPECT_NEAR(p.gap, gap, 1e-13);
    EXPECT_NEAR(p.excess, std::max(std::fabs(xi), std::fabs(eta)) - 1, 1e-13);
    EXPECT_NEAR(norm(p.normal - normal), 0, 1e-13);
    EXPECT_NEAR(p.weight[0] + p.weight[1] + p.weight[2] + p.weight[3], 1, 1e-15);
  }
}

// Flat convex faces far from parallelograms, with each corner as the first: on trapezoids and kites
// plain Newton steps from the centre leave the face. Also warped, and a little beyond the edges.
TEST(Projection, EveryPointOfATrapezoidOrKiteIsFound) {
  const Vec3 shapes[][4] = {{{0, 0, 0}, {4, 0, 0}, {2.5, 1, 0}, {1.5, 1, 0}},
                            {{0, 0, 0}, {12, 0, 0}, {1, 1, 0}, {0, 1, 0}},
                            {{0, 0, 0}, {1, -0.1, 0}, {6, 0, 0}, {1, 0.1, 0}},
                            {{0, 0, 0}, {0.5, 0, 0}, {1. / 3, 1. / 3, 0}, {0, 0.5, 0}},
                            {{0, 0, 0}, {1, 0, 0}, {0.52, 0.52, 0}, {0, 1, 0}}};
  for (const auto& shape : shapes)
    for (int first = 0; first < 4; ++first)
      for (const double warp : {0.0, 0.02}) {
        Quad f;
        for (int j = 0; j < 4; ++j) {
          f.corner[j] = shape[(j + first) % 4];
          f.corner[j].z += j % 2 == 0 ? warp : -warp;
        }
        for (int i = -52; i <= 52; ++i)
          for (int k = -52; k <= 52; ++k) {
            const double xi = 0.02 * i, eta = 0.02 * k;
            const FacePoint p = project(f, pointOf(f, xi, eta));
            ASSERT_TRUE(p.valid && p.has_parameters) << first << " " << xi << " " << eta;
            EXPECT_NEAR(p.xi, xi, 1e-9);
            EXPECT_NEAR(p.eta, eta, 1e-9);
            EXPECT_NEAR(p.gap, 0, 1e-12);
          }
      }
}

TEST(Projection, TriangleWithAnyRepeatedCornerIsExact) {
  const Vec3 a = {0, 0, 1}, b = {2, 0, 1}, c = {0, 2, 1};
  const Quad faces[4] = {{{a, a, b, c}}, {{a, b, b, c}}, {{a, b, c, c}}, {{b, c, a, b}}};
  for (const Quad& f : faces) {
    const FacePoint p = project(f, {0.5, 0.25, 0.5});
    ASSERT_TRUE(p.valid);
    EXPECT_EQ(p.gap, -0.5);
    EXPECT_EQ(p.normal.z, 1);
    EXPECT_LT(p.excess, 0);
    Vec3 closest;
    for (int j = 0; j < 4; ++j)
      closest += p.weight[j] * f.corner[j];
    EXPECT_NEAR(norm(closest - Vec3{0.5, 0.25, 1}), 0, 1e-15);
    EXPECT_FALSE(project(f, {2, 2, 0.5}).activeWithin(0.1));
    EXPECT_TRUE(project(f, {1.05, 1, 0.5}).activeWithin(0.1)); // just beyond the long edge
  }
}

TEST(Projection, PointsFarAsideAreNotOnTheFace) {
  for (const Vec3& point : {Vec3{5, 0.5, 0}, Vec3{0.5, -9, 0.1}, Vec3{1.2, 1.2, -0.1}})
    EXPECT_FALSE(project(unitSquare(), point).activeWithin(0.1));
}

TEST(Projection, DegenerateFacesAndNonFinitePointsAreNotValid) {
  const Vec3 a = {1, 2, 3}, b = {2, 2, 3};
  EXPECT_FALSE(project(Quad{{a, a, a, a}}, {0, 0, 0}).activeWithin(0.1));
  EXPECT_FALSE(project(Quad{{a, b, b, a}}, {0, 0, 0}).activeWithin(0.1));
  EXPECT_FALSE(project(Quad{{a, b, a, b}}, {1.5, 2, 3}).activeWithin(0.1));
  EXPECT_FALSE(project(unitSquare(), {NAN, 0, 0}).activeWithin(0.1));
}

// Where Newton's method fails (strong warp, point near the centre of curvature) the four triangles
// must still give a consistent result: the weights reproduce a point whose distance along the
// normal is the gap.
TEST(Projection, AnyAnswerIsConsistentOnWildFaces) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  int answered = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    Quad f = unitSquare();
    for (Vec3& corner : f.corner)
      corner += Vec3{0.6 * uniform(random), 0.6 * uniform(random), 0.8 * uniform(random)};
    const Vec3 point = {0.5 + uniform(random), 0.5 + uniform(random), uniform(random)};
    const FacePoint p = project(f, point);
    if (!p.activeWithin(0))
      continue;
    ++answered;
    Vec3 closest;
    for (int j = 0; j < 4; ++j)
      closest += p.weight[j] * f.corner[j];
    EXPECT_NEAR(norm(p.normal), 1, 1e-14);
    EXPECT_NEAR(norm(point - (closest + p.gap * p.normal)), 0, 1e-6) << trial;
  }
  EXPECT_GT(answered, 2000);
}

TEST(MeanPlane, NeverRejectsAPenetratingPoint) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform(-1, 1);
  constexpr double tolerance = 0.1;
  for (int trial = 0; trial < 20000; ++trial) {
    Quad f = unitSquare();
    for (Vec3& corner : f.corner)
      corner += Vec3{0.2 * uniform(random), 0.2 * uniform(random), 0.3 * uniform(random)};
    const Vec3 point = {0.5 + 0.7 * uniform(random), 0.5 + 0.7 * uniform(random),
                        0.3 * uniform(random)};
    const FacePoint p = project(f, point);
    if (p.activeWithin(tolerance) && p.gap < -1e-15) {
      EXPECT_FALSE(meanPlane(f).surelyOutside(point, tolerance, 0)) << trial;
    }
  }
}

TEST(MeanPlane, RejectsEveryPointInFrontOfAFlatFace) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const MeanPlane plane = meanPlane(unitSquare());
  for (int trial = 0; trial < 1000; ++trial) {
    const double gap = 0.5 * uniform(random);
    const Vec3 point = {0.5 + uniform(random), 0.5 + uniform(random), gap};
    EXPECT_EQ(plane.surelyOutside(point, 0.05, 0), gap > 0) << trial;
  }
}

TEST(MeanPlane, HasTheAreaOfAQuadAndOfATriangle) {
  EXPECT_EQ(meanPlane(unitSquare()).area, 1);
  const Vec3 a = {0, 0, 0}, b = {2, 0, 0}, c = {0, 1, 0};
  EXPECT_EQ(meanPlane(Quad{{a, b, c, c}}).area, 1);
  EXPECT_EQ(meanPlane(Quad{{a, a, b, c}}).area, 1);
}

} // namespace
} // namespace brickwall::contact
