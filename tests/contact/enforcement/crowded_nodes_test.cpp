// Nodes and edges in contact with any number of bodies: more than the local arrays of a thread hold
// (SelectInteractions::max_sides), and more than a byte counts.
#include "contact/enforcement/reports/history_checksum.hpp"
#include "tests/contact/enforcement/support/edge_run.hpp"
#include "tests/contact/enforcement/support/resultant.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>

namespace brickwall::contact::testing {
namespace {

using Forces = std::vector<std::array<std::int64_t, 3>>;

// Contacts of the node with the most contacts.
int longestRow(const ContactHistory& history) {
  const auto counts = toHost(history.row_count);
  int longest = 0;
  for (std::size_t node = 0; node < counts.extent(0); ++node)
    longest = std::max(longest, counts(node));
  return longest;
}

// `num_plates` plates [0, 2] x [0, 2] x [-1, 0], all in the same place, and a block on them that
// has moved down by its penetration of 0.01.
Scene blockOnEqualPlates(int num_plates) {
  Scene scene;
  for (int i = 0; i < num_plates; ++i)
    scene.addBox({0, 0, -1}, {2, 2, 1}, {1, 1, 1});
  const int block = scene.addBox({0.5, 0.5, -0.01}, {1, 1, 1}, {1, 1, 1});
  scene.cameBy(block, {0, 0, -0.01});
  return scene;
}

TEST(CrowdedNodes, ManyEqualBodiesShareTheStiffnessOfOneAndPushWithEqualIntegers) {
  auto one = alone(blockOnEqualPlates(1));
  one->step();
  const double whole = one->of(one->scene.nodeAt(1, {0.5, 0.5, -0.01})).at(0).stiffness;
  for (const int num_plates : {9, 12, 40, 300}) {
    auto run = alone(blockOnEqualPlates(num_plates));
    const Forces force = run->step();
    EXPECT_EQ(run->sums.problem(), "");
    EXPECT_EQ(run->sums.penetrating, 4 * num_plates);
    EXPECT_EQ(run->sums.active, 4 * num_plates);
    const auto status = toHost(run->enforcement.status());
    for (const Vec3& corner : {Vec3{0.5, 0.5, -0.01}, Vec3{1.5, 1.5, -0.01}}) {
      const int node = run->scene.nodeAt(num_plates, corner);
      const auto contacts = run->of(node);
      ASSERT_EQ(contacts.size(), static_cast<std::size_t>(num_plates));
      EXPECT_EQ(status(node), num_plates);
      for (int i = 0; i < num_plates; ++i) {
        EXPECT_EQ(contacts[i].side, i);
        EXPECT_DOUBLE_EQ(contacts[i].stiffness * num_plates, whole); // A_i is divided among them
      }
      const double quanta = quantum().inverse * (contacts[0].force * contacts[0].normal.z);
      EXPECT_EQ(force[node][2], num_plates * roundToFixed(quanta));
    }
  }
}

TEST(CrowdedNodes, AllContactsContinueAndAreLostOrEndTogether) {
  for (const int num_plates : {9, 12, 40}) {
    auto run = alone(blockOnEqualPlates(num_plates));
    run->step();
    for (int step = 1; step < 4; ++step) {
      run->scene.step();
      run->scene.move(num_plates, {0, 0, -0.01});
      run->step();
      EXPECT_EQ(run->sums.active, 4 * num_plates);
      EXPECT_EQ(run->sums.lost, 0);
      EXPECT_EQ(longestRow(run->enforcement.history()), num_plates);
      const auto all = toHost(run->enforcement.history().interactions);
      for (std::int64_t i = 0; i < run->enforcement.history().count; ++i) {
        ASSERT_EQ(all(i).is_new, 0);
        ASSERT_NEAR(all(i).depth, 0.01 * (step + 1), 1e-15); // the motion adds up
      }
    }
    auto raised = alone(blockOnEqualPlates(num_plates));
    raised->step();
    raised->scene.step();
    raised->scene.move(num_plates, {0, 0, 0.02});
    raised->step();
    EXPECT_EQ(raised->sums.interactions, 0);
    EXPECT_EQ(raised->sums.lost, 0);
    run->scene.step();
    run->scene.move(num_plates, {0, 0, -0.45}); // the boxes of this step hold x^n
    run->step();
    EXPECT_EQ(run->sums.lost, 0);
    run->scene.step();
    run->step(); // amid the plates, and no face within reach
    EXPECT_EQ(run->sums.lost, 4 * num_plates);
    EXPECT_EQ(run->sums.interactions, 0);
  }
}

// Plates of 3 x 3 elements, inclined and at heights at random, and a block that is pressed into
// them and slides.
struct Inclined {
  explicit Inclined(int num_plates) : tilt(num_plates) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (Vec3& t : tilt)
      t = {0.1 * uniform(random), 0.1 * uniform(random), 0.02 * uniform(random)};
  }
  // The block with the plates [first, last).
  Scene scene(std::size_t first, std::size_t last) const {
    Scene scene;
    for (std::size_t i = first; i < last; ++i)
      scene.addBrick({2, 2, 1}, {3, 3, 1}, 1, [&](const Vec3& p) {
        return Vec3{p.x, p.y, p.z - 1 + tilt[i].x * (p.x - 1) + tilt[i].y * (p.y - 1) + tilt[i].z};
      });
    scene.addBox({0.45, 0.45, 0.03}, {1, 1, 1}, {2, 2, 1});
    return scene;
  }
  // The block is the last body.
  static void advance(Scene& scene, int step) {
    scene.step();
    scene.move(scene.num_bodies - 1,
               {0.02 * std::sin(2.0 * step), 0.01, step % 5 == 4 ? 0.03 : -0.02});
  }

  std::vector<Vec3> tilt; // slopes along x and y, height
};

// Adds the forces of the nodes from `first` on to `sum`.
void addForces(const Forces& force, std::size_t first, Forces& sum) {
  for (std::size_t i = 0; i < sum.size(); ++i)
    for (int d = 0; d < 3; ++d)
      sum[i][d] += force[first + i][d];
}
Forces partOf(const Forces& force, std::size_t first, std::size_t count) {
  return Forces(force.begin() + first, force.begin() + first + count);
}

// The block stands on each plate by itself: without a shared area, its contacts do not know of each
// other, and the forces on the block are the sums of those of all pairs of bodies.
TEST(CrowdedNodes, ForcesOfManyBodiesAreTheSumOfThoseOfEachBodyAlone) {
  EnforcementConfig c = config();
  c.shared_cosine = 1;
  c.friction = 0.3;
  c.damping = 0.1;
  const Inclined inclined(40);
  std::map<int, std::unique_ptr<SceneRun>> crowds; // [number of plates]
  for (const int num_plates : {9, 12, 40})
    crowds[num_plates] = alone(inclined.scene(0, num_plates), c);
  std::vector<std::unique_ptr<SceneRun>> pairs;
  for (int i = 0; i < 40; ++i)
    pairs.push_back(alone(inclined.scene(i, i + 1), c));
  constexpr std::size_t of_block = 3 * 3 * 2; // its nodes, the last ones
  std::map<int, int> longest;
  for (int step = 0; step < 9; ++step) {
    Forces sum(of_block, {0, 0, 0});
    std::int64_t active = 0;
    for (int i = 0; i < 40; ++i) {
      const Forces force = pairs[i]->step();
      addForces(force, force.size() - of_block, sum);
      active += pairs[i]->sums.active;
      Inclined::advance(pairs[i]->scene, step);
      const auto crowd = crowds.find(i + 1);
      if (crowd == crowds.end())
        continue;
      SceneRun& run = *crowd->second;
      const Forces together = run.step();
      EXPECT_EQ(run.sums.active, active) << i + 1 << " plates, step " << step;
      EXPECT_EQ(partOf(together, together.size() - of_block, of_block), sum)
          << i + 1 << " plates, step " << step;
      longest[i + 1] = std::max(longest[i + 1], longestRow(run.enforcement.history()));
      Inclined::advance(run.scene, step);
    }
  }
  EXPECT_EQ(longest, (std::map<int, int>{{9, 9}, {12, 12}, {40, 40}}));
}

TEST(CrowdedNodes, EveryPartitionGivesTheSameIntegersAndTheSameHistory) {
  EnforcementConfig c = config();
  c.scheme = Scheme::energy_neutral;
  c.friction = 0.3;
  for (const int num_plates : {9, 12, 40}) {
    const Scene scene = Inclined(num_plates).scene(0, num_plates);
    std::vector<Vec3> acceleration(scene.x_new.size());
    for (std::size_t i = 0; i < acceleration.size(); ++i)
      acceleration[i] = {std::sin(7.0 * i), std::cos(5.0 * i), std::sin(3.0 * i)};
    SceneRun one(scene, MPI_COMM_SELF, onOneRank, c), many(scene, MPI_COMM_WORLD, scattered, c);
    for (int step = 0; step < 8; ++step) {
      Forces forces[2];
      std::int64_t checksum[2];
      int which = 0;
      for (SceneRun* run : {&one, &many}) {
        run->part.update(run->scene);
        const NeutralInput input = run->part.neutralInput(run->scene, acceleration);
        run->enforcement.enforce(exec_space(), run->part.surface(), run->part.ghosts(),
                                 run->part.pairs(), dt, &input);
        forces[which] = run->part.total(run->enforcement, scene.x_new.size(), scene);
        checksum[which++] =
            allReduce(run->part.comm(),
                      static_cast<std::int64_t>(historyChecksum(
                          exec_space(), run->part.surface().node_ids, run->enforcement.history())),
                      MPI_SUM);
        Inclined::advance(run->scene, step);
      }
      EXPECT_EQ(forces[0], forces[1]) << step;
      EXPECT_EQ(checksum[0], checksum[1]) << step;
    }
    EXPECT_EQ(longestRow(one.enforcement.history()), num_plates);
  }
}

// A ridge along x and across it the ridges [first, last) of other bodies along y, each at its own
// place and height over one edge of the first ridge.
Scene ridgesAcrossOne(int first, int last) {
  const double c = std::sqrt(0.5), side = 3;
  Scene scene;
  scene.addBrick({side, side, side}, {3, 3, 3}, 1, [&](const Vec3& p) {
    const double y = p.y - side, z = p.z - side;
    return Vec3{p.x - 0.5 * side, c * (y - z), c * (y + z)};
  });
  for (int i = first; i < last; ++i)
    scene.addBrick({side, side, side}, {3, 3, 3}, 1, [&](const Vec3& p) {
      return Vec3{c * (p.x - p.z) + 0.02 * (i - 20), p.y - 0.5 * side + 0.013,
                  0.0001 * (i + 1) + c * (p.x + p.z)};
    });
  return scene;
}

TEST(CrowdedNodes, AnEdgeAcrossManyEdgesBearsTheSumOfTheirForces) {
  struct Crowd {
    explicit Crowd(int num_ridges)
        : one(ridgesAcrossOne(0, num_ridges), MPI_COMM_SELF, onOneRank),
          many(ridgesAcrossOne(0, num_ridges), MPI_COMM_WORLD, scattered) {}
    EdgeRun one, many;
  };
  std::map<int, std::unique_ptr<Crowd>> crowds; // [number of ridges across]
  for (const int num_ridges : {9, 12, 40})
    crowds[num_ridges] = std::make_unique<Crowd>(num_ridges);
  std::vector<std::unique_ptr<EdgeRun>> pairs;
  for (int i = 0; i < 40; ++i)
    pairs.push_back(std::make_unique<EdgeRun>(ridgesAcrossOne(i, i + 1), MPI_COMM_SELF, onOneRank));
  constexpr std::size_t of_ridge = 4 * 4 * 4; // nodes of the first ridge, the first ones
  for (int step = 0; step < 3; ++step) {
    Forces sum(of_ridge, {0, 0, 0});
    for (int i = 0; i < 40; ++i) {
      addForces(pairs[i]->step(), 0, sum);
      pairs[i]->move(0, {0, 0, 0.01});
      const auto crowd = crowds.find(i + 1);
      if (crowd == crowds.end())
        continue;
      EdgeRun &one = crowd->second->one, &many = crowd->second->many;
      const Forces together = one.step();
      EXPECT_EQ(partOf(together, 0, of_ridge), sum) << i + 1 << " ridges, step " << step;
      EXPECT_EQ(many.step(), together) << i + 1 << " ridges, step " << step;
      EXPECT_EQ(one.sums.active, step == 0 ? 0 : i + 1);
      EXPECT_EQ(longestRow(one.edges->history()), step == 0 ? 0 : i + 1);
      one.move(0, {0, 0, 0.01});
      many.move(0, {0, 0, 0.01});
    }
  }
}

} // namespace
} // namespace brickwall::contact::testing
