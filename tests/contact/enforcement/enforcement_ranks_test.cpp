// Contact enforcement on several ranks: the same integers for every partition, exact momentum,
// values to ghosts and back.
#include "contact/enforcement/reports/history_checksum.hpp"
#include "contact/search/global_search.hpp"
#include "contact/search/local_search.hpp"
#include "tests/contact/enforcement/support/scene_run.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace brickwall::contact::testing {
namespace {

// A heap of jittered, rotated bricks with random motions.
Scene heap(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Scene scene;
  for (int b = 0; b < 6; ++b) {
    const double angle = 0.3 * uniform(random), tilt = 0.2 * uniform(random);
    const Vec3 corner = {1.0 * (b % 2) + 0.1 * uniform(random), 0.1 * uniform(random),
                         0.93 * (b / 2) + 0.03 * uniform(random)};
    scene.addBrick({1, 1, 1}, {3, 3, 3}, 1 + 0.5 * uniform(random), [&](const Vec3& p) {
      const Vec3 q =
          p + Vec3{0.03 * uniform(random), 0.03 * uniform(random), 0.03 * uniform(random)};
      const Vec3 turned = {q.x * std::cos(angle) - q.y * std::sin(angle),
                           q.x * std::sin(angle) + q.y * std::cos(angle), q.z + tilt * q.x};
      return corner + turned;
    });
  }
  for (Vec3& x : scene.x_old)
    x += Vec3{0.02 * uniform(random), 0.02 * uniform(random), 0.05 * uniform(random)};
  return scene;
}
void shake(Scene& scene, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  scene.step();
  for (Vec3& x : scene.x_new)
    x += Vec3{0.01 * uniform(random), 0.01 * uniform(random), 0.01 * uniform(random)};
}

std::array<std::int64_t, 3> sumOf(const std::vector<std::array<std::int64_t, 3>>& force) {
  std::array<std::int64_t, 3> sum = {0, 0, 0};
  for (const auto& f : force)
    for (int d = 0; d < 3; ++d)
      sum[d] += f[d];
  return sum;
}

// Elements are partitioned by slabs and at random: nodes on cuts, nodes owned by a rank that has no
// face there.
TEST(Enforcement, EveryPartitionGivesTheSameIntegersWhichAddUpToZero) {
  const int size = sizeOf(MPI_COMM_WORLD);
  for (unsigned seed = 0; seed < 12; ++seed) {
    const Scene scene = heap(seed);
    const auto scattered = [&](int e) { return static_cast<int>((e * 2654435761u >> 7) % size); };
    const auto slabs = [&](int e) { return e * size / static_cast<int>(scene.elements.size()); };
    auto one = alone(scene);
    SceneRun many(scene, MPI_COMM_WORLD, scattered), few(scene, MPI_COMM_WORLD, slabs);
    for (int step = 0; step < 4; ++step) {
      const auto expected = one->step();
      EXPECT_EQ(many.step(), expected) << "seed " << seed << " step " << step;
      EXPECT_EQ(few.step(), expected) << "seed " << seed << " step " << step;
      EXPECT_EQ(sumOf(expected), (std::array<std::int64_t, 3>{0, 0, 0}));
      EXPECT_GT(one->sums.active, 20);
      EXPECT_EQ(many.sums.active, one->sums.active);
      EXPECT_EQ(many.sums.terms.sum[spring_stored].value(energyScale()),
                one->sums.terms.sum[spring_stored].value(energyScale()));
      EXPECT_EQ(many.sums.max_penetration, one->sums.max_penetration);
      for (SceneRun* run : {one.get(), &many, &few})
        shake(run->scene, 100 * seed + step);
    }
  }
}

std::uint64_t checksum(const SceneRun& run, MPI_Comm comm) {
  const std::uint64_t mine =
      historyChecksum(exec_space(), run.part.surface().node_ids, run.enforcement.history());
  return static_cast<std::uint64_t>(allReduce(comm, static_cast<std::int64_t>(mine), MPI_SUM));
}

TEST(HistoryChecksum, IsTheSameForEveryPartitionAndDiffersInEveryStep) {
  EnforcementConfig c = config();
  c.friction = 0.3;
  const Scene scene = heap(5);
  SceneRun one(scene, MPI_COMM_SELF, onOneRank, c);
  SceneRun many(scene, MPI_COMM_WORLD, scattered, c);
  std::set<std::uint64_t> seen = {checksum(one, MPI_COMM_SELF)};
  EXPECT_EQ(*seen.begin(), 0u); // no contact yet
  for (int step = 0; step < 4; ++step) {
    one.step();
    many.step();
    const std::uint64_t expected = checksum(one, MPI_COMM_SELF);
    EXPECT_EQ(checksum(many, MPI_COMM_WORLD), expected);
    EXPECT_TRUE(seen.insert(expected).second);
    for (SceneRun* run : {&one, &many})
      shake(run->scene, step);
  }
}

TEST(HistoryChecksum, DependsOnTheLastBitOfEachValueAndNotOnTheOrder) {
  const exec_space space;
  SceneRun run(heap(5), MPI_COMM_SELF, onOneRank);
  run.step();
  const ContactHistory& history = run.enforcement.history();
  const auto copy = toHost(history.interactions);
  std::vector<Interaction> all(copy.data(), copy.data() + history.count);
  const auto sum = [&] {
    history.interactions.assign(all);
    return historyChecksum(space, run.part.surface().node_ids, history);
  };
  const std::uint64_t before = sum();
  ASSERT_GT(history.count, 2);
  std::swap(all[0], all[2]);
  EXPECT_EQ(sum(), before);
  for (const auto value : {&Interaction::offset, &Interaction::depth, &Interaction::stiffness,
                           &Interaction::fade_weight, &Interaction::stored, &Interaction::force,
                           &Interaction::damping, &Interaction::closing}) {
    const double kept = all[1].*value;
    all[1].*value = std::nextafter(kept, 1e9);
    EXPECT_NE(sum(), before);
    all[1].*value = kept;
  }
  all[1].face += 1;
  EXPECT_NE(sum(), before);
}

// With friction, contacts that return settle.
TEST(Enforcement, EnergyNeutralForcesAreTheSameIntegersForEveryPartition) {
  EnforcementConfig c = config();
  c.scheme = Scheme::energy_neutral;
  int num_settling = 0;
  for (unsigned seed = 0; seed < 4; ++seed) {
    c.friction = seed % 2 == 0 ? 0 : 0.3;
    const Scene scene = heap(seed);
    std::vector<Vec3> acceleration(scene.x_new.size());
    for (std::size_t i = 0; i < acceleration.size(); ++i)
      acceleration[i] = {std::sin(7.0 * i), std::cos(5.0 * i), std::sin(3.0 * i)};
    SceneRun one(scene, MPI_COMM_SELF, onOneRank, c);
    SceneRun many(scene, MPI_COMM_WORLD, scattered, c);
    for (int step = 0; step < 4; ++step) {
      std::vector<std::array<std::int64_t, 3>> forces[2];
      int which = 0;
      for (SceneRun* run : {&one, &many}) {
        run->part.update(run->scene);
        const NeutralInput input = run->part.neutralInput(run->scene, acceleration);
        run->sums = run->enforcement
                        .enforce(exec_space(), run->part.surface(), run->part.ghosts(),
                                 run->part.pairs(), dt, &input)
                        .nodes;
        forces[which++] = run->part.total(run->enforcement, scene.x_new.size(), scene);
        shake(run->scene, 100 * seed + step);
      }
      EXPECT_EQ(forces[0], forces[1]) << "seed " << seed << " step " << step;
      EXPECT_EQ(sumOf(forces[0]), (std::array<std::int64_t, 3>{0, 0, 0}));
      for (int node = 0; node < static_cast<int>(scene.x_new.size()); ++node)
        for (const Interaction& pair : one.of(node))
          num_settling += pair.damping > 0;
    }
  }
  EXPECT_GT(num_settling, 0);
}

// Search, enforcement and the return of reactions together, against brute-force pairs on one rank.
// Both reach 0.3, but the search lists other pairs than brute force; inactive pairs change no bit.
TEST(Enforcement, ForcesWithTheSearchEqualThoseOfBruteForce) {
  const exec_space space;
  for (unsigned seed = 0; seed < 6; ++seed) {
    const Scene scene = heap(seed);
    SceneRun run(scene, MPI_COMM_WORLD, scattered);
    const auto expected = alone(scene)->step();
    const Surface& surface = run.part.surface();
    SearchConfig tolerances;
    tolerances.node_tolerance = tolerances.face_tolerance = 0.15;
    tolerances.drop_same_body = true;
    GlobalSearch search(MPI_COMM_WORLD, tolerances);
    LocalSearch local(search);
    const GhostFaces& ghosts = search.findGhosts(space, surface);
    const auto& pairs = local.findCandidatePairs(space, surface);
    run.enforcement.enforce(space, surface, ghosts, pairs, dt);
    const ContactForces& forces = run.enforcement.forces();
    search.reverseSum(space, surface.face_to_nodes, forces.ghost_corners, forces.nodes);

    const auto nodes = toHost(forces.nodes);
    std::vector<std::int64_t> sum(3 * scene.x_new.size(), 0);
    for (std::size_t i = 0; i < run.part.nodes().size(); ++i)
      for (int d = 0; d < 3; ++d)
        sum[3 * run.part.nodes()[i] + d] = nodes(i, d);
    brickwall::allReduce(MPI_COMM_WORLD, sum.data(), static_cast<int>(sum.size()), MPI_SUM);
    for (std::size_t i = 0; i < expected.size(); ++i)
      for (int d = 0; d < 3; ++d)
        ASSERT_EQ(sum[3 * i + d], expected[i][d]) << "seed " << seed << " node " << i;
  }
}

TEST(Enforcement, GhostCornersReceiveTheValuesOfTheirOwnersNodes) {
  const int size = sizeOf(MPI_COMM_WORLD);
  const exec_space space;
  const Scene scene = heap(5);
  SceneRun run(scene, MPI_COMM_WORLD, scattered);
  const Surface& surface = run.part.surface();
  SearchConfig tolerances;
  tolerances.node_tolerance = tolerances.face_tolerance = 0.12;
  GlobalSearch search(MPI_COMM_WORLD, tolerances);
  const GhostFaces& ghosts = search.findGhosts(space, surface);
  const View<double* [3]> values("test::values", surface.num_nodes);
  const auto host = Kokkos::create_mirror_view(values);
  for (int node = 0; node < surface.num_nodes; ++node)
    for (int d = 0; d < 3; ++d)
      host(node, d) = 10.0 * run.part.nodes()[node] + d;
  Kokkos::deep_copy(values, host);
  const View<double* [12]> at_ghosts("test::at_ghosts", ghosts.count);
  search.forward(space, surface, values, at_ghosts);
  space.fence();
  const auto found = toHost(at_ghosts);
  const auto ids = toHost(ghosts.corner_ids);
  for (int ghost = 0; ghost < ghosts.count; ++ghost)
    for (int i = 0; i < 12; ++i)
      ASSERT_EQ(found(ghost, i), 10.0 * static_cast<double>(ids(ghost, i / 3)) + i % 3);
  EXPECT_TRUE(size == 1 || brickwall::allReduce(MPI_COMM_WORLD, ghosts.count, MPI_SUM) > 0);
}

// The stiffness of every node equals that of the uncut surface bit for bit: area and surface mass
// of a node on a cut include the faces of other ranks.
TEST(Enforcement, AreaOfANodeOnACutIsThatOfTheUncutSurface) {
  const Scene scene = heap(99);
  const int size = sizeOf(MPI_COMM_WORLD);
  auto one = alone(scene);
  SceneRun many(scene, MPI_COMM_WORLD, [&](int e) { return e % size; });
  one->step();
  many.step();
  std::int64_t compared = 0;
  for (const int node : many.part.nodes()) {
    const auto cut = many.of(node), uncut = one->of(node);
    for (std::size_t i = 0; i < cut.size(); ++i, ++compared) {
      ASSERT_EQ(cut.size(), uncut.size());
      EXPECT_EQ(cut[i].stiffness, uncut[i].stiffness);
      EXPECT_EQ(cut[i].face, uncut[i].face);
    }
  }
  EXPECT_EQ(allReduce(MPI_COMM_WORLD, compared, MPI_SUM), one->sums.interactions);
}

} // namespace
} // namespace brickwall::contact::testing
