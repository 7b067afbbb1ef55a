// Rules of contact enforcement on one rank: selection, contact history, stiffness, error reports.
#include "tests/contact/enforcement/support/scene_run.hpp"

#include <gtest/gtest.h>

namespace brickwall::contact::testing {
namespace {

// A plate [0, 4] x [0, 4] x [-1, 0] and on it a block [1, 3] x [1, 3] x [-depth, 1 - depth] that
// moved down by `fall`.
Scene blockOnPlate(double depth, double fall) {
  Scene scene;
  scene.addBox({0, 0, -1}, {4, 4, 1}, {4, 4, 1});
  const int block = scene.addBox({1, 1, -depth}, {2, 2, 1}, {2, 2, 1});
  scene.cameBy(block, {0, 0, -fall});
  return scene;
}

TEST(Enforcement, ActivationUsesOnlyThePenetrationOfTheStep) {
  auto run = alone(blockOnPlate(0.05, 0.02));
  run->step();
  const auto contact = run->of(run->scene.nodeAt(1, {2, 2, -0.05}));
  ASSERT_EQ(contact.size(), 1u);
  EXPECT_NEAR(contact[0].depth, 0.02, 1e-15); // min(P, approach)
  EXPECT_NEAR(contact[0].offset, 0.03, 1e-15);
  EXPECT_NEAR(contact[0].closing, 0.02, 1e-15);
  EXPECT_EQ(contact[0].is_new, 1);
}

TEST(Enforcement, InitialOverlapGivesNoForceAndFurtherApproachDoes) {
  auto run = alone(blockOnPlate(0.05, 0));
  for (const auto& f : run->step())
    for (int d = 0; d < 3; ++d)
      EXPECT_EQ(f[d], 0);
  EXPECT_GT(run->sums.penetrating, 0);
  EXPECT_EQ(run->sums.interactions, 0);
  run->moveAndStep(1, {0, 0, -0.01});
  const auto contact = run->of(run->scene.nodeAt(1, {2, 2, -0.06}));
  ASSERT_EQ(contact.size(), 1u);
  EXPECT_NEAR(contact[0].offset, 0.05, 1e-15);
  EXPECT_NEAR(contact[0].depth, 0.01, 1e-15);
  // As the block leaves the overlap, the offset shrinks with it: the contact never pulls.
  run->moveAndStep(1, {0, 0, 0.02});
  EXPECT_EQ(run->sums.interactions, 0);
  run->moveAndStep(1, {0, 0, -0.01});
  EXPECT_NEAR(run->of(run->scene.nodeAt(1, {2, 2, -0.05}))[0].offset, 0.04, 1e-15);
}

TEST(Enforcement, GapGivesNoForceHoweverSmall) {
  auto run = alone(blockOnPlate(-1e-9, 0.02));
  run->step();
  EXPECT_EQ(run->sums.interactions, 0);
}

TEST(Enforcement, AStepWithoutPenetrationEndsTheHistory) {
  auto run = alone(blockOnPlate(0.02, 0.02));
  run->step();
  run->moveAndStep(1, {0, 0, 0.03});
  EXPECT_EQ(run->sums.interactions, 0);
  EXPECT_EQ(run->sums.lost, 0); // it has separated and is not lost
  run->moveAndStep(1, {0, 0, -0.05});
  const auto contact = run->of(run->scene.nodeAt(1, {2, 2, -0.04}));
  ASSERT_EQ(contact.size(), 1u);
  EXPECT_EQ(contact[0].is_new, 1);
  EXPECT_NEAR(contact[0].depth, 0.04, 1e-15);
}

// The block's nodes lie on nodes of the plate: four faces are equally near, and a slide of 0.03
// stays within the tolerance of the selected one.
TEST(Enforcement, NodeKeepsItsFaceWhileOnItAndContinuesOnTheNext) {
  auto run = alone(blockOnPlate(0.02, 0.02));
  run->step();
  const int node = run->scene.nodeAt(1, {2, 2, -0.02});
  const Interaction first = run->of(node)[0];
  for (const double slide : {0.01, -0.02}) { // to either side of the edge
    run->moveAndStep(1, {slide, 0, 0});
    EXPECT_EQ(run->of(node)[0].face, first.face);
    EXPECT_EQ(run->of(node)[0].is_new, 0);
  }
  // Ties go to the least face id, which is the face towards lower x and y: leave it, and press by
  // 0.03 more.
  run->moveAndStep(1, {0.5, 0, -0.03});
  const Interaction moved = run->of(node)[0];
  EXPECT_NE(moved.face, first.face);
  // The cap s m_red fell a little where weights beyond the edge raised sum N_j^2 to 1.01^2 +
  // 0.01^2: p rose at equal energy.
  EXPECT_NEAR(moved.depth, first.depth * std::sqrt((1 + 1.0202) / 2) + 0.03, 1e-15);
  EXPECT_NEAR(moved.offset, 0.05 - moved.depth, 1e-15);
  EXPECT_NEAR(moved.stiffness, first.stiffness * 2 / (1 + 1.0202), 1e-12);
}

TEST(Enforcement, ActivationSelectsTheLeastGlobalIdAmongEqualFaces) {
  auto run = alone(blockOnPlate(0.02, 0.02));
  run->step();
  const int node = run->scene.nodeAt(1, {2, 2, -0.02});
  global_id least = 1 << 30; // top faces around the plate's node (2, 2, 0)
  for (const auto& face : run->scene.faces)
    for (const int corner : face.nodes)
      if (corner == run->scene.nodeAt(0, {2, 2, 0}) && face.body == 0)
        least = std::min(least, face.id);
  EXPECT_EQ(run->of(node)[0].face, least);
}

// Matching meshes of one material: eps A = (s/dt^2) A/(2/mu) with A = 1, mu = rho h_n/2 = 1/2, and
// the reduced mass of two columns of mass rho A h/2 is the same: 1/(1/.5 + 1/.5) = 1/4.
TEST(Enforcement, StiffnessFollowsTheFormulaWithTheTributaryArea) {
  auto run = alone(blockOnPlate(0.02, 0.02));
  run->step();
  const double scale = config().penalty / (dt * dt);
  const auto stiffness = [&](double x, double y) {
    return run->of(run->scene.nodeAt(1, {x, y, -0.02}))[0].stiffness;
  };
  EXPECT_DOUBLE_EQ(stiffness(2, 2), scale / 4);
  EXPECT_DOUBLE_EQ(stiffness(1, 2), scale / 8);
  EXPECT_DOUBLE_EQ(stiffness(1, 1), scale / 16);
  // A face node has the stiffness of its own brick's area: the plate's inner node (2, 2, 0) against
  // the block's underside.
  EXPECT_DOUBLE_EQ(run->of(run->scene.nodeAt(0, {2, 2, 0}))[0].stiffness, scale / 4);
}

TEST(Enforcement, StiffnessOfALightNodeIsCappedByTheReducedMass) {
  Scene scene = blockOnPlate(0.02, 0.02);
  const int node = scene.nodeAt(1, {2, 2, -0.02});
  scene.mass[node] = 1e-3; // far less than mu A
  auto run = alone(scene);
  run->step();
  const double reduced = 1 / (1 / 1e-3 + 1 / 0.5); // the plate's node (2, 2, 0) has mass 1/2
  EXPECT_DOUBLE_EQ(run->of(node)[0].stiffness, config().penalty / (dt * dt) * reduced);
}

TEST(Enforcement, MassOfAFixedBodyHasNoEffect) {
  Scene scene = blockOnPlate(0.02, 0.02);
  scene.fix(0);
  auto run = alone(scene);
  run->step();
  EXPECT_DOUBLE_EQ(run->of(run->scene.nodeAt(1, {2, 2, -0.02}))[0].stiffness,
                   config().penalty / (dt * dt) / 4); // the area formula still includes mu of both
}

// Offset blocks with side faces coplanar with others: only vertical forces, bit for bit.
TEST(Enforcement, FrictionlessFlushFacesHaveNoTangentialForce) {
  Scene scene;
  scene.addBox({0, 0, -1 / 3.0}, {2, 1, 1 / 3.0}, {6, 3, 1});
  scene.addBox({2, 0, -1 / 3.0}, {2, 1, 1 / 3.0}, {6, 3, 1}); // head joint with the first, gap 0
  const int top =
      scene.addBox({1, 0, -0.01}, {2, 1, 1 / 3.0}, {6, 3, 1}); // its ends, front, back are flush
  scene.cameBy(top, {0, 0, -0.01});
  auto run = alone(scene);
  const auto force = run->step();
  std::int64_t lift = 0, down = 0;
  for (std::size_t i = 0; i < force.size(); ++i) {
    EXPECT_EQ(force[i][0], 0);
    EXPECT_EQ(force[i][1], 0);
    (run->scene.node_body[i] == top ? lift : down) += force[i][2];
  }
  EXPECT_GT(lift, 0);
  EXPECT_EQ(lift, -down);
}

// A running bond; every joint is closed by d in this step: bricks [0,2], [2,4] below; [1,3], [3,5]
// on them; [2,4] above.
Scene runningBond(double d) {
  Scene scene;
  const auto grown = [&](double x, double z) { // a brick that has grown by d/2 on all sides
    scene.addBrick({2, 1, 1}, {4, 2, 2}, 1, [&](const Vec3& p) {
      return Vec3{x + p.x + d * (p.x - 1) / 2, p.y, z + p.z + d * (p.z - 0.5)};
    });
  };
  for (const auto& [x, z] : {std::make_pair(0, 0), {2, 0}, {1, 1}, {3, 1}, {2, 2}})
    grown(x, z);
  for (std::size_t i = 0; i < scene.x_old.size(); ++i) { // at x^n it had its nominal size
    const Vec3 corner[5] = {{0, 0, 0}, {2, 0, 0}, {1, 0, 1}, {3, 0, 1}, {2, 0, 2}};
    const Vec3 c = corner[scene.node_body[i]] + Vec3{1, 0, 0.5};
    Vec3& x = scene.x_old[i];
    x = {c.x + (x.x - c.x) / (1 + d / 2), x.y, c.z + (x.z - c.z) / (1 + d)};
  }
  return scene;
}

TEST(Enforcement, EdgeNodesOfARunningBondHaveAContactWithEachNeighbour) {
  const double d = 0.01;
  auto run = alone(runningBond(d));
  run->step();
  const auto bodies = [&](int body, double x, double z) {
    std::vector<global_id> touched;
    for (const Interaction& i : run->of(run->scene.nodeAt(body, {x, 0.5, z})))
      touched.push_back(i.side);
    return touched;
  };
  using Bodies = std::vector<global_id>;
  // Lower right edge of brick 2: bed joint with brick 1, head joint with brick 3.
  EXPECT_EQ(bodies(2, 3 + d / 2, 1 - d / 2), (Bodies{1, 3}));
  // Upper right edge of brick 2: head joint with brick 3, bed joint with brick 4.
  EXPECT_EQ(bodies(2, 3 + d / 2, 2 + d / 2), (Bodies{3, 4}));
  // Mid top of brick 1, under the head joint of bricks 2 and 3: both.
  EXPECT_EQ(bodies(1, 3, 1 + d / 2), (Bodies{2, 3}));
  // Upper right edge of brick 0: head joint with brick 1, bed joint with brick 2.
  EXPECT_EQ(bodies(0, 2 + d / 2, 1 + d / 2), (Bodies{1, 2}));
  // Lower left edge of brick 4 in the middle of brick 2, away from joints; its lower middle node on
  // bricks 2 and 3.
  EXPECT_EQ(bodies(4, 2 - d / 2, 2 - d / 2), (Bodies{2}));
  EXPECT_EQ(bodies(4, 3, 2 - d / 2), (Bodies{2, 3}));
  for (const Interaction& i : run->of(run->scene.nodeAt(2, {3 + d / 2, 0.5, 1 - d / 2})))
    EXPECT_NEAR(i.depth, d, 1e-3 * d);
}

TEST(Enforcement, NodeUnderAHeadJointSharesItsAreaBetweenBothBricks) {
  const double d = 0.01;
  auto run = alone(runningBond(d));
  run->step();
  const auto shared = run->of(run->scene.nodeAt(1, {3, 0.5, 1 + d / 2})); // in contact with 2 and 3
  // in contact with 2
  const auto single = run->of(run->scene.nodeAt(1, {2.5 - d / 4, 0.5, 1 + d / 2}));
  ASSERT_EQ(shared.size(), 2u);
  ASSERT_EQ(single.size(), 1u);
  EXPECT_DOUBLE_EQ(shared[0].stiffness, shared[1].stiffness);
  EXPECT_NEAR(shared[0].stiffness, single[0].stiffness / 2, 1e-9 * single[0].stiffness);
  // Contacts of different directions do not share their area: a lower edge node has a bed joint and
  // a head joint, each with the area of half a row of faces, as its neighbour on the rim of the end
  // face has for the bed joint alone.
  const auto edge = run->of(run->scene.nodeAt(2, {3 + d / 2, 0.5, 1 - d / 2}));
  ASSERT_EQ(edge.size(), 2u);
  EXPECT_NEAR(edge[0].stiffness, single[0].stiffness / 2, 0.05 * single[0].stiffness);
}

// k is reduced, at equal stored energy, when a second brick comes to share the area; it is not
// raised again. A heavy node slides from the middle of a light face, where four nodes carry it, to
// a corner, where one does.
TEST(Enforcement, StiffnessIsThatOfActivationAndFollowsAFallingCapAtEqualEnergy) {
  Scene scene;
  scene.addBox({0, 0, -1}, {6, 6, 1}, {6, 6, 1});
  const int block = scene.addBox({0.5, 0.5, -0.02}, {4, 4, 1}, {2, 2, 1}, 100);
  scene.cameBy(block, {0, 0, -0.02});
  auto run = alone(scene);
  const int node = scene.nodeAt(block, {2.5, 2.5, -0.02});
  run->step();
  const Interaction before = run->of(node)[0];
  Interaction now = before;
  for (int step = 0; step < 5; ++step) {
    run->moveAndStep(block, {0.09, 0.09, 0});
    const Interaction last = now;
    now = run->of(node)[0];
    EXPECT_LE(now.stiffness, last.stiffness * (1 + 1e-15));
    EXPECT_NEAR(now.stiffness * now.depth * now.depth,
                before.stiffness * before.depth * before.depth, 1e-14);
  }
  const double cap = config().penalty / (dt * dt) / now.inverse_mass;
  EXPECT_DOUBLE_EQ(now.stiffness, cap);
  EXPECT_LT(now.stiffness, 0.5 * before.stiffness);
  EXPECT_LT(now.offset, 0); // the spring stores more than P, which is returned at the end
}

TEST(Enforcement, OwnBodyIsInContactOnlyWithSelfContact) {
  // Pairs of this test scene are between bodies, so the two bricks are declared one body.
  Scene scene = blockOnPlate(0.02, 0.02);
  auto run = alone(scene);
  const View<global_id*> one("test::one_body", run->part.surface().num_nodes);
  for (const bool allowed : {false, true}) {
    EnforcementConfig c = config();
    c.self_contact = allowed;
    Surface surface = run->part.surface();
    surface.node_body = one; // all zero
    const View<global_id*> face_body("test::one_body", surface.num_faces);
    surface.face_body = face_body;
    Enforcement enforcement(exec_space(), MPI_COMM_SELF, surface, run->part.nodeMass(), c,
                            quantum(), energyScale());
    const auto sums =
        enforcement.enforce(exec_space(), surface, run->part.ghosts(), run->part.pairs(), dt).nodes;
    EXPECT_EQ(sums.active > 0, allowed);
  }
}

TEST(Enforcement, LoadedContactThatLeavesTheCandidatesIsReported) {
  auto run = alone(blockOnPlate(0.02, 0.02), config(), 0.05);
  run->step();
  EXPECT_EQ(run->sums.problem(), "");
  EXPECT_NEAR(run->sums.max_penetration, 0.02, 1e-15); // faces of area 1
  run->moveAndStep(1, {0, 0, -0.2}); // still a candidate: the boxes contain x^n
  EXPECT_EQ(run->sums.lost, 0);
  EXPECT_NEAR(run->sums.max_penetration, 0.22, 1e-15);
  run->scene.step();
  run->step();
  EXPECT_GT(run->sums.lost, 0);
  EXPECT_NE(run->sums.problem().find("deeper"), std::string::npos);
}

TEST(Enforcement, ForceBeyondTheFixedPointRangeIsReported) {
  Scene scene = blockOnPlate(0.02, 0.02);
  for (double& m : scene.mass)
    m *= 1e12;
  for (auto& face : scene.faces)
    face.surface_mass *= 1e12;
  auto run = alone(scene);
  run->step();
  EXPECT_GT(run->sums.invalid, 0);
  EXPECT_NE(run->sums.problem(), "");
}

TEST(Enforcement, RunsWithoutFacesNodesAndPairs) {
  Scene scene = blockOnPlate(0.02, 0.02);
  // All elements on the last rank: the others are empty.
  const int last = sizeOf(MPI_COMM_WORLD) - 1;
  SceneRun run(scene, MPI_COMM_WORLD, [&](int) { return last; });
  auto one = alone(scene);
  EXPECT_EQ(run.step(), one->step());
  Scene apart = blockOnPlate(-2, 0);
  for (const auto& force : alone(apart)->step())
    EXPECT_EQ(force, (std::array<std::int64_t, 3>{0, 0, 0}));
}

// A row of nodes bounces on a fixed face: P and d follow the leapfrog integration of one oscillator
// up to rounding.
TEST(Enforcement, FreeNodeBouncesAsALeapfrogOscillator) {
  Scene scene;
  scene.addBox({-5, -5, -1}, {10, 10, 1}, {1, 1, 1});
  scene.fix(0);
  const int block = scene.addBox({-0.5, -0.5, 0.003}, {1, 1, 1}, {1, 1, 1});
  auto run = alone(scene);
  const int node = scene.nodeAt(block, {-0.5, -0.5, 0.003});
  // eps A = (s/dt^2) (1/4)/(1/mu_a + 1/mu_b), mu = 1/2 each; node mass 1/8.
  const double k = config().penalty / (dt * dt) * 0.25 / 4;
  double depth = -0.003, fall = 0.01, spring = 0;
  for (int step = 0; step < 40; ++step) {
    depth += fall;
    spring = depth > 0 ? depth : 0;
    run->scene.step();
    for (std::size_t i = 0; i < scene.x_new.size(); ++i)
      if (scene.node_body[i] == block && scene.x_new[i].z < 0.5)
        run->scene.x_new[i].z -= fall;
    const auto force = run->step();
    EXPECT_NEAR(static_cast<double>(force[node][2]) * quantum().value, k * spring, 1e-12);
    fall -= dt * dt * k * spring / (1.0 / 8);
  }
  EXPECT_LT(fall, 0);
  EXPECT_LT(depth, 0);
  EXPECT_EQ(run->sums.interactions, 0);
}

} // namespace
} // namespace brickwall::contact::testing
