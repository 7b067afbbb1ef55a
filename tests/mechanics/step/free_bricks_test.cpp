// Free bricks have the same bits as drift, forces and kick in separate kernels.
#include "mechanics/ledger/energy.hpp"
#include "mechanics/step/central_difference.hpp"
#include "mechanics/step/free_bricks/free_bricks.hpp"
#include "tests/mechanics/support/block_mesh.hpp"

#include <gtest/gtest.h>

namespace brickwall::mechanics {
namespace {

using namespace testing;

struct Scene {
  exec_space space;
  BlockMesh blocks;
  std::vector<PrescribedMotion> motions;
  std::vector<char> is_loaded;
};

// Bricks of several sizes, whole on a rank or cut; a sheared one, one with fixed and driven nodes,
// one that is distorted, and one that is marked as loaded.
Scene sceneOf(MaterialModel model) {
  Scene scene;
  const auto bricks = stackOf({{7, 3, 2}, {16, 4, 5}, {1, 1, 1}, {8, 8, 3}, {5, 4, 6}, {9, 2, 2}});
  const int ranks = sizeOf(world);
  scene.blocks = makeBlocks(
      scene.space, world, bricks, {steelLike(model)},
      [](const Vec3& x) {
        if (x.z > 11 && x.z < 15) // the fourth
          return x + Vec3{0.25 * x.y, 0, 0};
        if (x.z > 19) // the sixth
          return x + Vec3{0.01 * std::sin(9 * x.y), 0, 0.01 * std::sin(7 * x.x)};
        return x;
      },
      [&](global_id elem) { return static_cast<int>((elem < 362 ? 0 : elem / 50) % ranks); });
  const auto X = toHost(scene.blocks.mesh.reference_coordinates);
  PrescribedMotion fixed, driven;
  driven.component[0] = driven.component[2] = false;
  driven.velocity = {0, 0.02, 0};
  scene.is_loaded.assign(scene.blocks.mesh.num_nodes, 0);
  for (int node = 0; node < scene.blocks.mesh.num_nodes; ++node) {
    const Vec3 x = rowOf(X, node);
    if (x.z > 3.9 && x.z < 4.01)
      fixed.nodes.push_back(node);
    if (x.z > 4.7 && x.z < 4.8 && x.x > 1.5)
      driven.nodes.push_back(node);
    scene.is_loaded[node] = x.z > 15.9 && x.z < 16.1;
  }
  scene.motions = {fixed, driven};
  return scene;
}

// Words of the state and of all sums, step by step.
std::vector<std::int64_t> run(Scene& scene, bool frees, int threads, double mass_damping,
                              double speed = 0.05) {
  const exec_space& space = scene.space;
  HexMesh& mesh = scene.blocks.mesh;
  const Quantum quantum = Quantum::forForceScale(forceScale(space, world, mesh));
  const LedgerScales scales = ledgerScales(space, world, mesh);
  InternalForce internal(space, world, mesh, ElementKind::one_point, quantum, scales.energy,
                         threads, frees ? LatticeMethod::planes : LatticeMethod::none);
  const FreeBricks bricks =
      frees ? FreeBricks(space, mesh, internal, scene.is_loaded) : FreeBricks();
  if (frees && simd_width > 1 && sizeOf(world) == 1) {
    EXPECT_EQ(bricks.numElems(), 42 + 320 + 1 + 192 + 36);
  }
  const NodeSelection others = frees ? bricks.otherNodes() : NodeSelection::allOf(mesh.num_nodes);
  const BoundaryConditions boundary(space, mesh.num_nodes, scene.motions, {0.01, 0, -0.02},
                                    mass_damping);
  NodalState state = stateAtRest(space, world, scene.blocks);
  state.velocity = nodalField(space, mesh, [&](const Vec3& x) {
    return speed * Vec3{std::sin(9 * x.y + x.z), std::sin(8 * x.x), std::cos(7 * x.x + x.z)};
  });
  NodalForces forces = zeroedForces(mesh, quantum);
  constexpr double dt = 0.04;
  const SpeedTest test{{}, 0.06};
  std::vector<std::int64_t> words;
  for (int step = 0; step < 6; ++step) {
    const bool drifts = step > 0;
    if (drifts)
      drift(space, dt, state, others);
    zeroForces(space, forces);
    InternalForceResult stored = internal.add(space, state.displacement, forces, true);
    scene.blocks.sum.sum(space, forces.values);
    KickSums sums = kick(space, mesh, boundary, {}, dt, forces, state, scales, test, others);
    if (bricks.any()) {
      const auto result =
          bricks.step(space, mesh, internal, boundary, {}, drifts, dt, dt, state, scales, test);
      stored.energy += result.internal.energy;
      stored.failure += result.internal.failure;
      sums += result.kick;
    }
    allReduce(world, sums);
    allReduce(world, stored.energy);
    sums.carry();
    stored.energy.carry();
    EXPECT_EQ(stored.failure.count, 0);
    words.insert(words.end(), sums.data(), sums.data() + sums.size());
    words.insert(words.end(), stored.energy.data(), stored.energy.data() + stored.energy.size());
    // Forces of skipped lattices are available on request.
    internal.addSkippedLattices(space, state.displacement, forces);
    for (const auto& view : {state.displacement, state.velocity}) {
      const auto more = globalWords(world, scene.blocks, view);
      words.insert(words.end(), more.begin(), more.end());
    }
    const auto more = globalWords(world, scene.blocks, forces.values);
    words.insert(words.end(), more.begin(), more.end());
  }
  return words;
}

TEST(FreeBricks, ChangeNoBit) {
  for (const MaterialModel model : all_models)
    for (const double mass_damping : {0.0, 0.3}) {
      Scene scene = sceneOf(model);
      const auto apart = run(scene, false, 1, mass_damping);
      EXPECT_TRUE(apart == run(scene, true, 1, mass_damping));
      EXPECT_TRUE(apart == run(scene, true, 6, mass_damping));
    }
}

// Volumes change by more than a sixteenth in some elements, which sweeps handle separately.
TEST(FreeBricks, ChangeNoBitAtLargeDeformation) {
  for (const MaterialModel model : {MaterialModel::neo_hookean, MaterialModel::svk}) {
    Scene scene = sceneOf(model);
    const auto apart = run(scene, false, 1, 0, 0.2);
    EXPECT_TRUE(apart == run(scene, true, 1, 0, 0.2));
    EXPECT_TRUE(apart == run(scene, true, 6, 0, 0.2));
  }
}

} // namespace
} // namespace brickwall::mechanics
