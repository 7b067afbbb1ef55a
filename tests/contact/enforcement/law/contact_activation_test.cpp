// Activation, end and continuation of contacts: nodes that have not entered through a face,
// contacts that ended through it, wedges between faces, and edges that turn parallel.
#include "tests/contact/enforcement/support/edge_run.hpp"
#include "tests/contact/enforcement/support/lone_faces.hpp"
#include "tests/contact/enforcement/support/resultant.hpp"

#include <gtest/gtest.h>

namespace brickwall::contact::testing {
namespace {

double storedIn(const ContactSums& sums) {
  return sums.terms.sum[spring_stored].value(energyScale());
}

// Whether the tip of a corner is in contact that moved into a plate by 0.01. Its three edges are
// `slim` off its axis, which is tilted by `tilt` towards `azimuth` (radians).
bool isTipInContact(double slim, double tilt, double azimuth) {
  Scene scene;
  scene.addBox({-4, -4, -1}, {8, 8, 1}, {1, 1, 1});
  Vec3 edge[3];
  for (int i = 0; i < 3; ++i) {
    const double around = 2 * M_PI * i / 3 - azimuth;
    const Vec3 upright = {std::sin(slim) * std::cos(around), std::sin(slim) * std::sin(around),
                          std::cos(slim)};
    edge[i] = {std::cos(tilt) * upright.x + std::sin(tilt) * upright.z, upright.y,
               std::cos(tilt) * upright.z - std::sin(tilt) * upright.x};
  }
  const Vec3 tip = {0.3, 0.2, -0.01};
  const int body = scene.addBrick({1, 1, 1}, {1, 1, 1}, 1, [&](const Vec3& p) {
    return tip + p.x * edge[0] + p.y * edge[1] + p.z * edge[2];
  });
  scene.cameBy(body, {0, 0, -0.01});
  auto run = alone(scene, config());
  run->step();
  const auto contact = run->of(run->scene.nodeAt(body, tip));
  return contact.size() == 1 && contact[0].depth > 0.009 && contact[0].stiffness > 0;
}

// A plate [0, 4] x [0, 4] x [-1, 0] and on it a block [1, 3] x [1, 3] x [-depth, 1 - depth] that
// moved down by `fall`.
ContactSums blockInPlate(double depth, double fall, double max_activation_depth) {
  Scene scene;
  scene.addBox({0, 0, -1}, {4, 4, 1}, {4, 4, 1});
  const int block = scene.addBox({1, 1, -depth}, {2, 2, 1}, {2, 2, 1});
  scene.cameBy(block, {0, 0, -fall});
  EnforcementConfig c = config();
  c.max_activation_depth = max_activation_depth;
  auto run = alone(scene, c);
  run->step();
  const auto contact = run->of(run->scene.nodeAt(block, {2, 2, -depth}));
  const double brought = std::min(depth, std::max(fall, 0.0));
  if (run->sums.interactions > 0) {
    EXPECT_EQ(contact.size(), 1u);
    EXPECT_NEAR(contact[0].depth, brought, 1e-15);
    EXPECT_NEAR(contact[0].offset, depth - brought, 1e-15);
  }
  return run->sums;
}

TEST(ContactActivation, NodeFarBehindAFaceBecomesActiveOnlyByThisStepsMotion) {
  EXPECT_EQ(blockInPlate(0.25, 0.00, 0.125).penetrating, 0);
  EXPECT_EQ(blockInPlate(0.25, 0.12, 0.125).penetrating, 0); // P > max_activation_depth + approach
  EXPECT_GT(blockInPlate(0.25, 0.13, 0.125).active, 0);
  EXPECT_GT(blockInPlate(0.25, 0.25, 0.125).active, 0);
  EXPECT_EQ(blockInPlate(0.25, -0.2, 0.125).penetrating, 0); // it comes from farther inside
}

TEST(ContactActivation, NodeJustBehindAFaceBecomesActiveWithAnyMotion) {
  EXPECT_GT(blockInPlate(0.12, 0.0, 0.125).penetrating, 0);
  EXPECT_EQ(blockInPlate(0.12, 0.0, 0.125).active, 0);
  EXPECT_GT(blockInPlate(0.12, -0.2, 0.125).penetrating, 0);
  EXPECT_GT(blockInPlate(0.25, 0.0, HUGE_VAL).penetrating, 0);
}

// A body with an inner corner along y: the floor z = 0 for 0 < x < 1, the wall x = 1 for 0 < z < 1;
// and a block [0.7, 1] x [0.3, 0.7] x [0, 0.3] moved by `at` from there.
Scene blockInCorner(const Vec3& at) {
  Scene scene;
  scene.addBrick({2, 1, 1}, {2, 1, 1}, 1, [](const Vec3& p) {
    if (p.x < 1.5)
      return Vec3{p.x, p.y, p.z - 1};
    return p.z > 0.5 ? Vec3{1, p.y, 1} : Vec3{2, p.y, 0.5};
  });
  scene.addBox(at + Vec3{0.7, 0.3, 0}, {0.3, 0.4, 0.3}, {1, 1, 1});
  return scene;
}

// The node leaves the floor upwards and moves on in the same step into the wall of the same body,
// where it was a little behind the wall's plane already. The floor's energy has been returned and
// is not transferred to the wall.
TEST(ContactActivation, LoadedNodeThatLeavesThroughItsFaceStartsAnewOnTheNext) {
  Scene scene = blockInCorner({0.002, 0, -0.03});
  scene.cameBy(1, {0, 0, -0.03});
  auto run = alone(scene, config());
  run->step();
  const int node = run->scene.nodeAt(1, {1.002, 0.3, -0.03});
  const auto on_floor = run->of(node);
  ASSERT_EQ(on_floor.size(), 1u);
  EXPECT_EQ(on_floor[0].face, 5); // the top of the first element
  EXPECT_NEAR(on_floor[0].depth, 0.03, 1e-15);
  run->scene.step();
  run->scene.move(1, {0.003, 0, 0.04});
  run->step();
  const auto at_wall = run->of(node);
  ASSERT_EQ(at_wall.size(), 1u);
  EXPECT_EQ(at_wall[0].face, 6 + 5);
  EXPECT_NEAR(at_wall[0].offset, 0.002, 1e-15); // P - approach
  EXPECT_NEAR(at_wall[0].depth, 0.003, 1e-15);
  EXPECT_EQ(at_wall[0].stored, 0);
  EXPECT_EQ(at_wall[0].is_new, 1);
  EXPECT_EQ(storedIn(run->sums), 0);
}

// No face of a slim corner opposes the plate by much, but the corner does.
TEST(ContactActivation, CornersAreInContactHoweverSlimAndTilted) {
  constexpr double degree = M_PI / 180;
  for (const double slim : {60.0, 36.0, 20.0, 8.0, 2.0, 0.3})
    for (double tilt = 0; tilt + slim < 85; tilt += 2)
      for (double azimuth = 0; azimuth <= 60; azimuth += 10)
        EXPECT_TRUE(isTipInContact(slim * degree, tilt * degree, azimuth * degree))
            << "edges " << slim << " off the axis, tilt " << tilt << ", azimuth " << azimuth;
}

// A node that is still behind the floor takes its energy along to the wall, less what the floor
// returned on the way.
TEST(ContactActivation, LoadedNodeThatSlidesToTheNextFaceKeepsItsRemainingEnergy) {
  Scene scene = blockInCorner({-0.01, 0, -0.03});
  scene.cameBy(1, {0, 0, -0.03});
  scene.fix(
      // otherwise the mass of the face's corners, and with it the stiffness, would differ a little
      0);
  auto run = alone(scene, config());
  run->step();
  const int node = run->scene.nodeAt(1, {0.99, 0.3, -0.03});
  ASSERT_EQ(run->of(node).size(), 1u);
  run->scene.step();
  run->scene.move(1, {0.04, 0, 0.01}); // beyond the floor's end; 0.02 below the wall's lower edge
  run->step();
  const auto at_wall = run->of(node);
  ASSERT_EQ(at_wall.size(), 1u);
  EXPECT_EQ(at_wall[0].face, 6 + 5);
  EXPECT_NEAR(at_wall[0].depth, 0.03 - 0.01, 1e-15);
  EXPECT_EQ(at_wall[0].is_new, 0);
}

// Two faces of edge length 1, each bent up by 30 degrees from the valley along y, and a block with
// an edge of 60 degrees down, which moved down the middle by `depth`. A node d below the valley is
// d cos 30 behind both faces, and d half-lengths beyond the end of either.
Scene edgeInValley(double depth) {
  Scene scene;
  const double c = std::sqrt(0.75), s = 0.5;
  scene.addBrick({2, 1, 1}, {2, 1, 1}, 1, [&](const Vec3& p) {
    return Vec3{c * (p.x - 1), p.y, s * std::fabs(p.x - 1) + p.z - 1};
  });
  const int block = scene.addBrick({1, 0.4, 1}, {1, 1, 1}, 1, [&](const Vec3& p) {
    return Vec3{s * (p.x - p.z), 0.3 + p.y, c * (p.x + p.z) - depth};
  });
  scene.cameBy(block, {0, 0, -depth});
  scene.fix(0); // so that the stiffness does not fall as the weights change
  return scene;
}

// Only depths up to 0.1 are accepted as entered through a face: the sides of the body, which the
// node is always behind, do not count.
EnforcementConfig shallow() {
  EnforcementConfig c = config();
  c.max_activation_depth = 0.1;
  return c;
}

TEST(RetainedContact, WedgeBetweenBentFacesRetainsALoadedNode) {
  auto run = alone(edgeInValley(0.04), shallow(), 1.0);
  run->step();
  const int node = run->scene.nodeAt(1, {0, 0.3, -0.04});
  const auto activated = run->of(node);
  ASSERT_EQ(activated.size(), 1u);
  const double c = std::sqrt(0.75);
  double before = 0.04 * c;
  for (const double d : {0.08, 0.3, 0.49, 0.2, 0.06, 0.03}) { // lateral_tolerance is .05
    run->scene.step();
    run->scene.move(1, {0, 0, -d - run->scene.x_new[node].z});
    run->step();
    const auto contact = run->of(node);
    ASSERT_EQ(contact.size(), 1u) << d;
    EXPECT_EQ(contact[0].face, activated[0].face);
    EXPECT_EQ(contact[0].stiffness, activated[0].stiffness);
    EXPECT_NEAR(contact[0].offset, 0, 1e-15);
    EXPECT_NEAR(contact[0].depth, d * c, 1e-15);
    EXPECT_EQ(run->sums.lost, 0);
    // Both nodes of the edge: the energy continues.
    EXPECT_NEAR(storedIn(run->sums), 2 * 0.5 * activated[0].stiffness * before * contact[0].depth,
                1e-14 * activated[0].stiffness);
    before = contact[0].depth;
  }
  run->scene.step();
  run->scene.move(1, {0, 0, 0.031});
  run->step();
  EXPECT_EQ(run->sums.interactions, 0);
}

// Half a face away the contact is to return its energy, once it no longer approaches.
TEST(RetainedContact, WedgeActivatesNoContactAndReleasesOneHalfAFaceAway) {
  auto deep = alone(edgeInValley(0.2), shallow(), 1.0);
  deep->step();
  EXPECT_EQ(deep->sums.interactions, 0); // beyond the tolerance of both
  auto run = alone(edgeInValley(0.04), shallow(), 1.0);
  run->step();
  run->scene.step();
  run->scene.move(1, {0, 0, -0.47}); // .51 half-lengths beyond
  run->step();
  ASSERT_EQ(run->sums.interactions, 2);
  const int node = run->scene.nodeAt(1, {0, 0.3, -0.51});
  EXPECT_FALSE(run->of(node)[0].releases());
  run->moveAndStep(1, {0, 0, 0.001});
  EXPECT_TRUE(run->of(node)[0].releases());
  EXPECT_NEAR(run->of(node)[0].depth, 0.509 * std::sqrt(0.75), 1e-15);
  run->moveAndStep(1, {0, 0, 0.009}); // as long as it holds energy, it may be covered again
  EXPECT_EQ(run->sums.interactions, 2);
}

// Crossing ridges of single edges, with the upper one rotated by `angle` from the lower one's
// direction.
Scene ridgesAt(double angle, double gap) {
  Scene scene = crossedRidges(gap, 1);
  Turn{{0, 0, 1}, {}, angle - 0.5 * M_PI}.body(scene, 1); // its ridge was along y
  scene.step();
  return scene;
}
Interaction onlyInteraction(const EdgeRun& run) {
  EXPECT_EQ(run.edges->history().count, 1);
  return toHost(run.edges->history().interactions)(0);
}

// Half of s m_red/dt^2 at any angle at which there is a contact.
TEST(EdgeActivation, HasItsFullStiffnessFromTheSmallestAngleOn) {
  for (const double angle : {0.035, 0.1, 0.3, 1.5}) {
    EdgeRun run(ridgesAt(angle, 0.001), MPI_COMM_SELF, onOneRank);
    run.step();
    run.move(1, {0, 0, -0.011});
    run.step();
    ASSERT_EQ(run.sums.active, 1) << angle;
    const Interaction pair = onlyInteraction(run);
    // |x| ~ 1, over the sine of 0.03
    EXPECT_NEAR(pair.depth, 0.01, 1e-14) << angle;
    EXPECT_DOUBLE_EQ(pair.stiffness,
                     0.5 * EnforcementConfig().penalty / (dt * dt) / pair.inverse_mass);
    EXPECT_DOUBLE_EQ(pair.force, pair.stiffness * pair.depth);
    EXPECT_EQ(pair.fade_weight, 1);
  }
  EdgeRun parallel(ridgesAt(0.025, 0.001), MPI_COMM_SELF, onOneRank);
  parallel.step();
  parallel.move(1, {0, 0, -0.011});
  parallel.step();
  EXPECT_EQ(parallel.sums.interactions, 0);
}

// The same at the rim of the cone of outward directions: the lower body is rotated about its ridge
// until a face is almost level.
TEST(EdgeActivation, HasItsFullStiffnessFromTheRimOfItsConeOn) {
  for (const double inside : {0.025, 0.035, 0.2}) {
    Scene scene = crossedRidges(0.001, 1);
    Turn{{1, 0, 0}, {}, 0.25 * M_PI - inside}.body(scene, 0);
    scene.step();
    EdgeRun run(scene, MPI_COMM_SELF, onOneRank);
    run.step();
    run.move(1, {0, 0, -0.011});
    run.step();
    ASSERT_EQ(run.sums.active, inside > 0.03 ? 1 : 0) << inside;
    if (run.sums.active == 1) {
      const Interaction pair = onlyInteraction(run);
      EXPECT_DOUBLE_EQ(pair.stiffness,
                       0.5 * EnforcementConfig().penalty / (dt * dt) / pair.inverse_mass);
    }
  }
}

// A loaded pair of edges is rotated about the point where they cross, until they are parallel and a
// little beyond, while the depth oscillates. The energy of the half step and the work of the
// forces, k p^n p^{n+1}/2 and -k p^n (p^{n+1} - p^{n-1})/2, add up to a constant exactly.
TEST(RetainedContact, EdgesThatTurnParallelUnderLoadKeepTheirEnergy) {
  EdgeRun run(ridgesAt(0.5 * M_PI, 0.001), MPI_COMM_SELF, onOneRank);
  run.step();
  run.move(1, {0, 0, -0.031});
  run.step();
  const Interaction activated = onlyInteraction(run);
  double work = 0, total = 0, turned = 0;
  bool was_retained = false;
  for (int step = 0; turned < 0.5 * M_PI + 0.17; ++step) {
    run.scene.step();
    Turn{{0, 0, 1}, {}, -0.02}.body(run.scene, 1);
    turned += 0.02;
    run.scene.move(1, {0, 0, 0.002 * std::sin(0.3 * step)});
    const auto force = run.step();
    ASSERT_EQ(run.sums.active, 1) << turned;
    const Interaction pair = onlyInteraction(run);
    EXPECT_EQ(pair.is_retained, std::fabs(std::cos(turned)) < 0.03 || was_retained) << turned;
    was_retained = pair.is_retained;
    EXPECT_NEAR(pair.stiffness, activated.stiffness, 1e-13 * activated.stiffness);
    // depths differ from heights by 1e-16/0.03 of the ridges' size
    const double scale = activated.stiffness * 0.03 * 0.03;
    work += run.sums.terms.sum[spring_work].value(energyScale());
    if (step == 0)
      total = storedIn(run.sums) + work;
    EXPECT_NEAR(storedIn(run.sums) + work, total, 1e-12 * scale * (step + 1)) << turned;
    const Resultant r = resultantOf(run.scene, force);
    EXPECT_EQ(r.sum, (std::array<std::int64_t, 3>{0, 0, 0}));
    EXPECT_LT(norm(r.moment), momentOfRounding(r, 1));
  }
  EXPECT_TRUE(was_retained); // retained until now, although the edges cross again
}

// The lower ridge stays between two edges of the upper one that are bent away from it: where it is
// pressed in deep, the lines of both edges cross it beyond their ends, by more than the lateral
// tolerance.
TEST(RetainedContact, EdgeSlidesOverABendOfTheOtherEdge) {
  constexpr double bend = 0.513, slope = -0.2;
  Scene scene = crossedRidges(0.001);
  for (std::size_t i = 0; i < scene.x_new.size(); ++i)
    if (scene.node_body[i] == 1)
      scene.x_new[i].z += slope * std::fabs(scene.x_new[i].y - bend);
  scene.move(1, {0, -bend + 0.15, -slope * 0.15});
  scene.step();
  EdgeRun run(scene, MPI_COMM_SELF, onOneRank);
  run.step();
  for (int step = 0; step < 45; ++step) {
    run.move(1, {0, 0, -0.01});
    run.step();
    ASSERT_EQ(run.sums.active, 1) << step;
  }
  bool has_been_beyond = false;
  for (int step = 0; step < 30; ++step) {
    run.move(1, {0, -0.01, 0});
    run.step();
    ASSERT_EQ(run.sums.active, 1) << step;
    const Interaction pair = onlyInteraction(run);
    EXPECT_EQ(pair.is_new, 0) << step;
    has_been_beyond = has_been_beyond || pair.weight[0] < -0.05 || pair.weight[1] < -0.05;
  }
  EXPECT_TRUE(has_been_beyond);
}

// Parallel edges that slide: the force acts along the vector between the two points, so it has no
// couple.
TEST(RetainedContact, ParallelEdgesThatSlideHaveNoCoupleAndEndWhenTheySeparate) {
  EdgeRun run(ridgesAt(0.06, 0.001), MPI_COMM_SELF, onOneRank);
  run.step();
  run.move(1, {0, 0, -0.031});
  run.step();
  run.scene.step();
  Turn{{0, 0, 1}, {}, -0.06}.body(run.scene, 1);
  run.step();
  EXPECT_EQ(onlyInteraction(run).is_retained, 1);
  run.move(1, {0.01, 0.015, 0.005});
  const auto force = run.step();
  const Interaction pair = onlyInteraction(run);
  EXPECT_NEAR(pair.depth, norm(Vec3{0.01, 0.015, -0.025}), 1e-14);
  EXPECT_NEAR(pair.normal.y, 0.015 / pair.depth, 1e-12);
  const Resultant r = resultantOf(run.scene, force);
  EXPECT_EQ(r.sum, (std::array<std::int64_t, 3>{0, 0, 0}));
  EXPECT_LT(norm(r.moment), momentOfRounding(r, 1));
  run.move(1, {-0.01, -0.015, 0.03}); // apart by 0.005: the vector points back
  run.step();
  EXPECT_EQ(run.sums.interactions, 0);
}

// Edges may separate or slide out of reach before the force has returned what the contact stores.
TEST(RetainedContact, EdgesThatAreApartAreReleasedAlongTheirCommonNormal) {
  if (!host_accessible)
    GTEST_SKIP() << "on a host";
  for (const double slide : {0.0, 1.9}) { // from the middle of the edge
    LoneFaces edges(2, 2, words_of<EdgeAttributes>);
    const Vec3 below[4] = {{0, 0, 0}, {1, 0, 0}, {1, 1, -1}, {0, 1, -1}};
    for (int j = 0; j < 4; ++j) {
      edges.set(4 + j, below[j], below[j]);
      const Vec3 above = {below[j].y + 0.5 + slide, below[j].x - 0.5, 0.002 - below[j].z};
      edges.set(j, above, above); // 0.002 apart
    }
    EdgeEdgeKinematics kinematics;
    kinematics.num_corners = 8;
    kinematics.edge_tolerance = 0.1;
    Interaction last;
    last.point.share = 0.5;
    last.weight[1] = 0.5;
    last.normal = {0, 0, 1};
    kinematics.previous = StructArray<Interaction>("test::previous", 1);
    kinematics.previous.assign({last});
    const FaceAccess faces{edges.surface, GhostFaces()};
    FaceContact contact;
    contact.previous = 0;
    EXPECT_FALSE(kinematics.test(faces, 8, 1, ContactTest::retain, contact));
    ASSERT_TRUE(kinematics.test(faces, 8, 1, ContactTest::release, contact));
    EXPECT_NEAR(contact.depth, -0.002, 1e-15);
    EXPECT_NEAR(contact.normal[2], 1, 1e-15);
    EXPECT_NEAR(contact.weight[1], 0.5 + slide, 1e-15);
  }
}

} // namespace
} // namespace brickwall::contact::testing
