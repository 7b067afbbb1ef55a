// Friction acts on a node and on a point of the face that are a penetration apart: normal forces
// balance the couple, and a rotation of both bodies together is no slip.
#include "tests/contact/enforcement/support/edge_run.hpp"
#include "tests/contact/enforcement/support/resultant.hpp"

#include <gtest/gtest.h>

namespace brickwall::contact::testing {
namespace {

constexpr double mu = 0.4, depth = 0.1;
const Vec3 skew = (1 / std::sqrt(14.0)) * Vec3{1, -3, 2};

EnforcementConfig rough() {
  EnforcementConfig c = config();
  c.friction = mu;
  c.max_activation_depth = depth; // the bodies are small: a deeper node has entered elsewhere
  return c;
}

// A warped face of edge length 2, and a small cube with one corner about `depth` behind it, all
// rotated. The cube moved by `slide` along the face and straight inwards.
Scene cornerInWarpedFace(const Vec3& slide) {
  constexpr double warp = 0.2, x = 0.3, y = -0.2;
  Scene scene;
  scene.addBrick({2, 2, 1}, {1, 1, 1}, 1, [&](const Vec3& p) {
    const Vec3 q = p - Vec3{1, 1, 1};
    return q + Vec3{0, 0, warp * q.x * q.y};
  });
  const int cube = scene.addBrick({0.4, 0.4, 0.4}, {1, 1, 1}, 1, [&](const Vec3& p) {
    return Vec3{x + (p.x - p.y) / std::sqrt(2.0), y + (p.x + p.y - 2 * p.z) / std::sqrt(6.0),
                warp * x * y - depth + (p.x + p.y + p.z) / std::sqrt(3.0)};
  });
  scene.cameBy(cube, slide + Vec3{0, 0, -1.5 * depth});
  const Turn turn{skew, {0.5, 0.2, 0.1}, 0.7};
  for (Vec3& place : scene.x_old)
    place = turn(place);
  turn.all(scene);
  return scene;
}

// Crossing ridges, the upper one rotated away from the right angle, all rotated in space; apart by
// 0.01.
Scene turnedRidges() {
  Scene scene = crossedRidges(0.01, 1);
  Turn{{0, 0, 1}, {}, 0.4}.body(scene, 1);
  Turn{skew, {0.5, 0.2, 0.1}, 0.7}.all(scene);
  scene.step();
  return scene;
}
Vec3 turnedAlong(const Vec3& a) {
  return Turn{skew, {}, 0.7}(a);
}

FrictionSpring onlyFriction(const ContactHistory& history) {
  EXPECT_EQ(history.count, 1);
  return toHost(history.friction)(0);
}

void expectBalanced(const Scene& scene, const std::vector<std::array<std::int64_t, 3>>& force,
                    const FrictionSpring& friction, double P) {
  const Resultant r = resultantOf(scene, force);
  EXPECT_EQ(r.sum, (std::array<std::int64_t, 3>{0, 0, 0}));
  EXPECT_LT(norm(r.moment), momentOfRounding(r, 1));
  // Without the balancing forces it would be P t:
  EXPECT_GT(P * norm(friction.force) * quantum().inverse, 1e6 * momentOfRounding(r, 1));
}

TEST(FrictionCouple, IsBalancedForANodeOnATiltedWarpedFaceInStickAndSlip) {
  for (const double slide : {0.01, 0.1}) {
    auto run = alone(cornerInWarpedFace({slide, 0.5 * slide, 0}), rough(), 0.5);
    const auto force = run->step();
    const FrictionSpring friction = onlyFriction(run->enforcement.history());
    const bool slips = norm(friction.force) < norm(friction.trial);
    EXPECT_EQ(slips, slide > 0.05);
    expectBalanced(run->scene, force, friction, 0.9 * depth);
  }
}

TEST(FrictionCouple, IsBalancedForCrossingEdgesInStickAndSlip) {
  for (const double slide : {0.005, 0.1}) {
    EdgeRun run(turnedRidges(), MPI_COMM_SELF, onOneRank, rough());
    run.step();
    run.move(1, turnedAlong({slide, 0.5 * slide, -0.05}));
    const auto force = run.step();
    ASSERT_EQ(run.sums.active, 1);
    const FrictionSpring friction = onlyFriction(run.edges->history());
    const bool slips = norm(friction.force) < norm(friction.trial);
    EXPECT_EQ(slips, slide > 0.05);
    expectBalanced(run.scene, force, friction, 0.04);
  }
}

// To first order in the angle a: r = -P n and the tangents t rotate by (1 - R^T) = a K - a^2/2 K^2,
// of which the first term contributes nothing and the second at most a^2 P.
template <class Motion>
void expectNoSlip(double P, const Motion& motionOf) {
  constexpr double angle = 1e-3;
  const Vec3 axes[4] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, skew};
  for (const Vec3& axis : axes) {
    const double whole = norm(motionOf(Turn{axis, {0.4, -2, 3}, angle}));
    const double half = norm(motionOf(Turn{axis, {0.4, -2, 3}, 0.5 * angle}));
    EXPECT_LT(whole, angle * angle * P);
    EXPECT_LT(half, 0.25 * angle * angle * P);
  }
}

TEST(FrictionCouple, RotationOfBothBodiesIsNoSlipOfANodeOnAFace) {
  expectNoSlip(0.9 * depth, [](const Turn& turn) {
    auto run = alone(cornerInWarpedFace({0.01, 0, 0}), rough(), 0.5);
    run->step();
    run->scene.step();
    turn.all(run->scene);
    run->step();
    return onlyFriction(run->enforcement.history()).motion;
  });
}

TEST(FrictionCouple, RotationOfBothBodiesIsNoSlipOfCrossingEdges) {
  expectNoSlip(0.04, [](const Turn& turn) {
    EdgeRun run(turnedRidges(), MPI_COMM_SELF, onOneRank, rough());
    run.step();
    run.move(1, turnedAlong({0.005, 0, -0.05}));
    run.step();
    run.scene.step();
    turn.all(run.scene);
    run.step();
    return onlyFriction(run.edges->history()).motion;
  });
}

} // namespace
} // namespace brickwall::contact::testing
