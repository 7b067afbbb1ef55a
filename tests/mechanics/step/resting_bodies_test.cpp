// Bodies at rest are skipped without a change of any bit; they wake when a force acts on them.
#include "mechanics/force/internal_force.hpp"
#include "mechanics/ledger/energy.hpp"
#include "mechanics/step/central_difference.hpp"
#include "mechanics/step/resting_bodies.hpp"
#include "tests/mechanics/support/block_mesh.hpp"

#include <gtest/gtest.h>

namespace brickwall::mechanics {
namespace {

using namespace testing;

struct Bricks {
  exec_space space;
  BlockMesh blocks;
  NodalState state;
  NodalForces forces;
  LedgerScales scales;
  std::vector<char> may_be_pushed;

  // The first two are whole on a rank, the others are cut, and the last one is distorted.
  explicit Bricks(MaterialModel model) {
    const int ranks = sizeOf(world);
    blocks = makeBlocks(
        space, world, stackOf({{7, 3, 2}, {9, 4, 5}, {8, 8, 3}, {5, 4, 6}}), {steelLike(model)},
        [](const Vec3& x) {
          return x.z > 11.9 ? x + Vec3{0.01 * std::sin(9 * x.y), 0, 0} : x;
        },
        [&](global_id elem) { return static_cast<int>((elem < 222 ? 0 : elem / 50) % ranks); });
    state = stateAtRest(space, world, blocks);
    forces =
        zeroedForces(blocks.mesh, Quantum::forForceScale(forceScale(space, world, blocks.mesh)));
    scales = ledgerScales(space, world, blocks.mesh);
    may_be_pushed.assign(blocks.mesh.num_nodes, 1);
  }
  std::vector<int> nodesOf(int brick) const {
    const auto X = toHost(blocks.mesh.reference_coordinates);
    std::vector<int> nodes;
    for (int node = 0; node < blocks.mesh.num_nodes; ++node)
      if (X(node, 2) > 4.0 * brick - 0.1 && X(node, 2) < 4.0 * brick + 3)
        nodes.push_back(node);
    return nodes;
  }
  RestingBodies resting(const std::vector<PrescribedMotion>& motions = {},
                        const Vec3& gravity = {}) const {
    return {space, blocks.mesh, state, motions, gravity, may_be_pushed};
  }
  std::int64_t restingElems(const RestingBodies& bodies) const {
    return allReduce(world, bodies.numElems(), MPI_SUM);
  }
};

// Pushes one corner of the bricks from steps 3, 6, ... on, brick by brick.
void push(Bricks& bricks, int step) {
  const auto values = toHost(bricks.forces.values);
  const auto ids = toHost(bricks.blocks.mesh.node_ids);
  for (int brick = 0; brick < 3; ++brick) {
    const std::vector<int> nodes = bricks.nodesOf(brick);
    global_id lowest = INT64_MAX;
    for (const int node : nodes)
      lowest = std::min(lowest, ids(node));
    lowest = allReduce(world, lowest, MPI_MIN);
    for (const int node : nodes)
      if (ids(node) == lowest && step >= 3 * (brick + 1))
        values(node, 3 * external_force + 1) += std::int64_t(1) << 40; // on all sharers of the node
  }
  Kokkos::deep_copy(bricks.forces.values, values);
}

// Words of the state and the sums after each step.
std::vector<std::int64_t> run(MaterialModel model, bool lets_rest, std::int64_t& skipped) {
  Bricks bricks(model);
  const HexMesh& mesh = bricks.blocks.mesh;
  InternalForce internal(bricks.space, world, mesh, ElementKind::one_point, bricks.forces.quantum,
                         bricks.scales.energy);
  const BoundaryConditions boundary(bricks.space, mesh.num_nodes, {}, Vec3());
  RestingBodies resting;
  if (lets_rest)
    resting = bricks.resting();
  internal.skipRestingBodies(resting.flags());
  const NodeSelection all = NodeSelection::allOf(mesh.num_nodes);
  const double dt = 0.02;
  std::vector<std::int64_t> words;
  const auto take = [&](const void* from, std::size_t bytes) {
    const std::size_t begin = words.size();
    words.resize(begin + bytes / 8);
    std::copy_n(static_cast<const char*>(from), bytes / 8 * 8,
                reinterpret_cast<char*>(words.data() + begin));
  };
  for (int step = 0; step < 15; ++step) {
    drift(bricks.space, dt, bricks.state, resting.any() ? resting.movingNodes() : all);
    zeroForces(bricks.space, bricks.forces);
    const auto result = internal.add(bricks.space, bricks.state.displacement, bricks.forces, true);
    EXPECT_EQ(result.failure.count, 0);
    skipped += resting.numElems();
    push(bricks, step);
    bricks.blocks.sum.sum(bricks.space, bricks.forces.values);
    resting.wake(bricks.space, bricks.forces);
    const KickSums sums =
        kick(bricks.space, mesh, boundary, {step * dt, (step + 1) * dt}, dt, bricks.forces,
             bricks.state, bricks.scales, {}, resting.any() ? resting.movingNodes() : all);
    for (const View<double* [3]>& field : {bricks.state.displacement, bricks.state.velocity}) {
      const auto host = toHost(field);
      for (int node = 0; node < mesh.num_nodes; ++node)
        for (int axis = 0; axis < 3; ++axis)
          take(&host(node, axis), 8);
    }
    take(&result.energy, sizeof(result.energy));
    take(&sums, sizeof(sums));
  }
  return words;
}

TEST(RestingBodies, ChangeNoBit) {
  for (const MaterialModel model : {MaterialModel::neo_hookean, MaterialModel::linear}) {
    std::int64_t skipped = 0, none = 0;
    const auto with = run(model, true, skipped), without = run(model, false, none);
    EXPECT_EQ(with, without);
    EXPECT_EQ(none, 0);
    // Bricks 0, 1, 2 rest in steps 0 to 3, 6, 9, the fourth in all of 15; parts on other ranks
    // until the wave arrives.
    const std::int64_t whole = 4 * 42 + 7 * 180 + 10 * 192 + 15 * 120;
    skipped = allReduce(world, skipped, MPI_SUM);
    EXPECT_GE(skipped, whole);
    if (sizeOf(world) == 1) {
      EXPECT_EQ(skipped, whole);
    }
  }
}

TEST(RestingBodies, AreThoseThatHaveNotMoved) {
  Bricks bricks(MaterialModel::neo_hookean);
  const std::int64_t all = 42 + 180 + 192 + 120;
  EXPECT_EQ(bricks.restingElems(bricks.resting()), all);
  EXPECT_EQ(bricks.restingElems(bricks.resting({}, {0, 0, -1})), 0);
  PrescribedMotion fixed, driven;
  fixed.nodes = bricks.nodesOf(0);
  driven.nodes = bricks.nodesOf(1);
  driven.velocity = {0, 0, 1};
  EXPECT_EQ(bricks.restingElems(bricks.resting({fixed, driven})), all - 180);
  const auto velocity = Kokkos::create_mirror_view(bricks.state.velocity);
  for (const int node : bricks.nodesOf(2))
    velocity(node, 1) = 1e-300;
  Kokkos::deep_copy(bricks.state.velocity, velocity);
  EXPECT_EQ(bricks.restingElems(bricks.resting()), all - 192);
}

// A body of two blocks has two rows of elements, with rows of other bodies in between: both wake
// together.
TEST(RestingBodies, WakeInAllTheirRows) {
  Bricks bricks(MaterialModel::neo_hookean);
  HexMesh& mesh = bricks.blocks.mesh;
  if (mesh.bodies.empty())
    return; // a rank without elements
  const ElementRange whole = mesh.bodies[0];
  if (whole.count < 2)
    return;
  mesh.bodies[0].count = 1;
  mesh.bodies.push_back({whole.first + 1, whole.count - 1, whole.body});
  const std::size_t last = mesh.bodies.size() - 1;
  RestingBodies resting = bricks.resting();
  const std::int64_t before = resting.numElems();
  const auto nodes = toHost(mesh.elem_to_nodes);
  const auto values = toHost(bricks.forces.values);
  values(nodes(whole.first, 0), 0) = 1;
  Kokkos::deep_copy(bricks.forces.values, values);
  resting.wake(bricks.space, bricks.forces);
  EXPECT_EQ(resting.numElems(), before - whole.count);
  const auto flags = toHost(resting.flags());
  EXPECT_EQ(flags(0), 0);
  EXPECT_EQ(flags(last), 0);
}

// The mean velocity changes and that of resting nodes does not: they are fast relative to the mean
// without being kicked.
TEST(RestingBodies, CountAsFastIfTheMeanIs) {
  Bricks bricks(MaterialModel::linear);
  const HexMesh& mesh = bricks.blocks.mesh;
  const BoundaryConditions boundary(bricks.space, mesh.num_nodes, {}, {});
  const RestingBodies resting = bricks.resting();
  ASSERT_EQ(resting.any(), mesh.num_elems > 0);
  const auto fastNodes = [&](const Vec3& mean) {
    KickSums sums = kick(bricks.space, mesh, boundary, {}, 1e-9, bricks.forces, bricks.state,
                         bricks.scales, {mean, 0.5}, resting.movingNodes());
    allReduce(world, sums);
    return sums.sum[kick_fast_nodes].high;
  };
  EXPECT_EQ(fastNodes({0.4, 0, 0}), 0);
  EXPECT_GT(fastNodes({0.6, 0, 0}), 0);
}

} // namespace
} // namespace brickwall::mechanics
