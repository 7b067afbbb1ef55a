// Meshes divided among ranks: patch test, rotation, the same bits for any partition, failures,
// skin, mass.
#include "mechanics/mesh/skin.hpp"
#include "mechanics/stability/stable_time_step.hpp"
#include "tests/mechanics/support/block_mesh.hpp"

#include <gtest/gtest.h>

namespace brickwall::mechanics {
namespace {

using namespace testing;

// Moves interior nodes of the unit cube, and slides boundary nodes within their faces.
Vec3 distorted(const Vec3& x) {
  const auto seed = static_cast<std::uint64_t>(1000 * x.x + 100000 * x.y + 10000000 * x.z);
  Vec3 y = x;
  for (int j = 0; j < 3; ++j)
    if (x[j] > 1e-9 && x[j] < 1 - 1e-9)
      y[j] += 0.08 * randomOf(3 * seed + j);
  return y;
}
bool isInterior(const std::vector<double>& X, global_id node) {
  for (int j = 0; j < 3; ++j)
    if (X[3 * node + j] < 1e-9 || X[3 * node + j] > 1 - 1e-9)
      return false;
  return true;
}
std::vector<double> globalCoordinates(const BlockMesh& blocks) {
  const auto words = globalWords(world, blocks, blocks.mesh.reference_coordinates);
  std::vector<double> X(words.size());
  memcpy(X.data(), words.data(), words.size() * sizeof(double));
  return X;
}

// E = 1 and edges 1/3: forces of the patch are of size strain/9. A tolerance of 1e-13 relative to E
// h^2 covers some hundred roundings.
TEST(PatchTest, AffineDisplacementLeavesInteriorNodesOfADistortedMeshFree) {
  const exec_space space;
  for (const ElementKind kind : {ElementKind::one_point, ElementKind::full})
    for (const MaterialModel model : all_models) {
      BlockMesh blocks =
          makeBlocks(space, world, {cube(3)}, {steelLike(model)}, distorted, scattered);
      const auto u = nodalField(space, blocks.mesh, [](const Vec3& x) {
        return Vec3{0.1 * x.x + 0.03 * x.y, -0.05 * x.y + 0.02 * x.z, 0.07 * x.z + 0.01 * x.x};
      });
      const Evaluation result = evaluate(space, world, blocks, u, kind);
      const std::vector<double> X = globalCoordinates(blocks);
      double largest = 0, boundary = 0;
      for (global_id node = 0; node < blocks.num_global_nodes; ++node)
        for (int i = 0; i < 3; ++i)
          (isInterior(X, node) ? largest : boundary) =
              std::max(isInterior(X, node) ? largest : boundary, std::fabs(result.force(node, i)));
      EXPECT_LE(largest, 1e-13 / 9);
      EXPECT_GT(boundary, 1e-3);
      if (kind == ElementKind::one_point) { // constant strain causes no hourglass energy
        EXPECT_LE(result.hourglass, 1e-26);
      }
    }
}

TEST(RigidMotion, CausesNoForce) {
  const exec_space space;
  for (const ElementKind kind : {ElementKind::one_point, ElementKind::full}) {
    BlockMesh blocks = makeBlocks(space, world, {cube(3)}, {steelLike()}, distorted, scattered);
    const auto u = nodalField(space, blocks.mesh, [](const Vec3& x) {
      const double c = std::cos(2.3), s = std::sin(2.3);
      return Vec3{c * x.x - s * x.y - x.x + 0.5, s * x.x + c * x.y - x.y - 0.2, 0.3};
    });
    const Evaluation result = evaluate(space, world, blocks, u, kind);
    for (global_id node = 0; node < blocks.num_global_nodes; ++node)
      for (int i = 0; i < 3; ++i)
        EXPECT_LE(std::fabs(result.force(node, i)), 1e-13);
    EXPECT_LE(std::fabs(result.material + result.hourglass), 1e-15);
  }
}

struct Outcome {
  std::vector<std::int64_t> forces, mass;
  double material, hourglass, dt;
  global_id dt_elem;
};
Outcome outcomeOf(MPI_Comm comm, bool is_distorted, ElementKind kind, const Partition& partition) {
  const exec_space space;
  BlockMesh blocks = makeBlocks(
      space, comm, {cube(3), cube(4, {2, 0, 0}), cube(2, {0, 2, 0})}, {steelLike()},
      [&](const Vec3& x) { return is_distorted ? distorted(x) : x; }, partition);
  const auto u = nodalField(space, blocks.mesh, [](const Vec3& x) {
    return Vec3{0.01 * std::sin(3 * x.y), 0.02 * x.x * x.z, 0.01 * std::cos(2 * x.x)};
  });
  const Evaluation result = evaluate(space, comm, blocks, u, kind);
  const auto step = stableTimeStep(space, comm, blocks.mesh, u);
  return {
      result.forces,   globalWords(comm, blocks, lumpedMass(space, comm, blocks.mesh, blocks.sum)),
      result.material, result.hourglass,
      step.dt,         step.elem};
}

TEST(Partition, ChangesNoBitOfForcesMassEnergiesAndStep) {
  for (const bool is_distorted : {false, true})
    for (const ElementKind kind : {ElementKind::one_point, ElementKind::full}) {
      const Outcome whole = outcomeOf(MPI_COMM_SELF, is_distorted, kind, onOneRank);
      const Outcome cut = outcomeOf(world, is_distorted, kind, scattered);
      EXPECT_EQ(whole.forces, cut.forces);
      EXPECT_EQ(whole.mass, cut.mass);
      EXPECT_EQ(whole.material, cut.material);
      EXPECT_EQ(whole.hourglass, cut.hourglass);
      EXPECT_EQ(whole.dt, cut.dt);
      EXPECT_EQ(whole.dt_elem, cut.dt_elem);
    }
}

TEST(InternalForce, OfAllNodesSumsToExactlyZero) {
  const Outcome result = outcomeOf(world, true, ElementKind::one_point, scattered);
  for (int column = 0; column < 3; ++column) {
    std::int64_t sum = 0;
    for (std::size_t node = 0; node < result.forces.size() / 9; ++node)
      sum += result.forces[9 * node + column];
    EXPECT_EQ(sum, 0);
  }
}

TEST(CongruentBodies, AreFoundAndAgreeWithTheGeneralPath) {
  const exec_space space;
  const auto count = [&](const Placement& place) {
    BlockMesh blocks =
        makeBlocks(space, world, {cube(3), cube(2, {2, 0, 0})}, {steelLike()}, place, scattered);
    const InternalForce internal(space, world, blocks.mesh, ElementKind::one_point,
                                 Quantum::powerOfTwo(-54), testEnergyScale());
    return allReduce(world, internal.numCongruentElems(), MPI_SUM);
  };
  EXPECT_EQ(count(asIs), 35);
  // one displaced node of the first body makes that body general
  EXPECT_EQ(count([](const Vec3& x) { return norm(x) < 1e-12 ? Vec3{-1e-6, 0, 0} : x; }), 8);
  EXPECT_EQ(count([](const Vec3& x) { return Vec3{x.x + 0.3 * x.y, x.y, x.z + 0.1 * x.x}; }), 35);

  // One corner node displaced by 1e-9 of an edge makes the body general; its forces then differ by
  // about that much.
  const auto forcesAt = [&](double shift) {
    BlockMesh blocks = makeBlocks(
        space, world, {cube(2)}, {steelLike()},
        [&](const Vec3& x) {
          return norm(x) < 1e-12 ? Vec3{-shift, 0, 0} : x;
        },
        scattered);
    const auto u = nodalField(space, blocks.mesh, [](const Vec3& x) {
      return Vec3{0.05 * x.y * x.z, 0.02 * x.x * x.z, 0.01 * x.x * x.y * x.z};
    });
    return evaluate(space, world, blocks, u, ElementKind::one_point);
  };
  const Evaluation box = forcesAt(0), general = forcesAt(1e-9);
  for (global_id node = 0; node < 27; ++node)
    for (int i = 0; i < 3; ++i)
      EXPECT_NEAR(box.force(node, i), general.force(node, i), 1e-9);
}

// One body in chunks for many threads, with atomic additions where chunks meet.
TEST(Threads, ChangeNoBit) {
  const exec_space space;
  const Block block{{12, 10, 9}};
  for (const bool is_distorted : {false, true}) {
    BlockMesh blocks = makeBlocks(
        space, world, {block, cube(3, {2, 0, 0})}, {steelLike()},
        [&](const Vec3& x) { return is_distorted ? distorted(x) : x; }, scattered);
    const auto u = nodalField(space, blocks.mesh, [](const Vec3& x) {
      return Vec3{0.01 * std::sin(3 * x.y), 0.02 * x.x * x.z, 0.01 * std::cos(2 * x.x)};
    });
    const auto forcesFor = [&](int threads) {
      InternalForce internal(space, world, blocks.mesh, ElementKind::one_point,
                             Quantum::powerOfTwo(-54), testEnergyScale(), threads);
      const NodalForces forces = zeroedForces(blocks.mesh, Quantum::powerOfTwo(-54));
      const auto result = internal.add(space, u, forces, true);
      EXPECT_EQ(result.failure.count, 0);
      auto words = globalWords(world, blocks, forces.values);
      for (const LimbSum& sum : result.energy.sum)
        words.insert(words.end(), {sum.high, sum.low, sum.tail});
      return words;
    };
    EXPECT_EQ(forcesFor(1), forcesFor(4));
    EXPECT_EQ(forcesFor(1), forcesFor(0));
  }
}

// Sweeps over lattices, in slabs for any number of threads, and tiles give the same bits as packs,
// also where elements fail. The blocks have any width and are boxes or sheared, whole or cut
// between layers or anywhere. The last is cut into tiles along all axes.
TEST(Lattices, ChangeNoBit) {
  const exec_space space;
  const auto bricks =
      stackOf({{1, 1, 1}, {7, 3, 2}, {8, 2, 3}, {9, 1, 1}, {1, 9, 2}, {16, 5, 20}, {23, 14, 9}});
  constexpr int many_threads = 1 << 20;
  const int ranks = sizeOf(world);
  for (const MaterialModel model : all_models)
    for (const bool is_sheared : {false, true})
      for (const bool is_whole : {false, true}) {
        BlockMesh blocks = makeBlocks(
            space, world, bricks, {steelLike(model)},
            [&](const Vec3& x) {
              return is_sheared ? x + Vec3{0.25 * x.y, 0, 0.125 * x.x} : x;
            },
            [&](global_id elem) {
              const global_id ends[] = {1, 43, 91, 100, 118, 1718};
              const auto body = std::upper_bound(std::begin(ends), std::end(ends), elem) - ends;
              return static_cast<int>((is_whole ? body : elem / 80) % ranks);
            });
        for (const bool is_broken : {false, true}) {
          const auto u = nodalField(space, blocks.mesh, [&](const Vec3& x) {
            if (is_broken && x.z > 22.4 && x.x > 0.7)
              return Vec3{0, 0, -3};
            return 0.01 * Vec3{std::sin(30 * x.y + x.x), std::sin(20 * x.x), std::cos(25 * x.z)};
          });
          const auto resultOf = [&](int threads, LatticeMethod method) {
            InternalForce internal(space, world, blocks.mesh, ElementKind::one_point,
                                   Quantum::powerOfTwo(-54), testEnergyScale(), threads, method);
            if (is_whole && simd_width > 1) {
              EXPECT_EQ(internal.lattices().on_host.size(),
                        method == LatticeMethod::planes ? blocks.mesh.bodies.size() : 0);
            }
            const NodalForces forces = zeroedForces(blocks.mesh, Quantum::powerOfTwo(-54));
            Kokkos::deep_copy(space, forces.values, 17);
            internal.zeroForces(space, {}, forces);
            const auto result = internal.add(space, u, forces, true);
            auto words = globalWords(world, blocks, forces.values);
            for (const LimbSum& sum : result.energy.sum)
              words.insert(words.end(), {sum.high, sum.low, sum.tail});
            ElementFields fields;
            internal.computeFields(space, u, fields);
            const auto pressure = toHost(fields.pressure);
            for (int elem = 0; elem < blocks.mesh.num_elems; ++elem)
              memcpy(&words.emplace_back(), &pressure(elem), sizeof(double));
            words.insert(words.end(), {result.failure.count, result.failure.first_elem,
                                       result.failure.reason, result.energy.invalid});
            return words;
          };
          const auto packs = resultOf(1, LatticeMethod::none);
          if (is_broken && model != MaterialModel::linear && ranks == 1) {
            EXPECT_GT(packs[packs.size() - 4], 0);
          }
          EXPECT_EQ(packs, resultOf(1, LatticeMethod::planes));
          EXPECT_EQ(packs, resultOf(4, LatticeMethod::planes));
          EXPECT_EQ(packs, resultOf(1, LatticeMethod::tiles));
          EXPECT_EQ(packs, resultOf(many_threads, LatticeMethod::tiles));
        }
      }
}

TEST(Failure, OfOneElementIsReportedWithItsGlobalIdOnAllRanks) {
  const exec_space space;
  BlockMesh blocks = makeBlocks(space, world, {cube(3)}, {steelLike()}, asIs, scattered);
  const auto check = [&](const View<double* [3]>& u, global_id elem, int reason) {
    const Evaluation result = evaluate(space, world, blocks, u, ElementKind::one_point);
    const GlobalFailure failure = agreeOnFailure(space, world, blocks.mesh, result.local.failure);
    EXPECT_GT(failure.count, 0);
    EXPECT_EQ(failure.first_elem, elem);
    EXPECT_EQ(failure.reason, reason);
    EXPECT_NEAR(failure.position.x, (elem % 3 + 0.5) / 3, 1e-12);
    EXPECT_NE(describe(failure).find("failed elements: " + std::to_string(failure.count)),
              std::string::npos);
  };
  // The last layer in z is inverted; its lowest element is 18.
  check(nodalField(space, blocks.mesh,
                   [](const Vec3& x) {
                     return Vec3{0, 0, x.z > 0.9 ? -1.0 : 0.0};
                   }),
        18, inverted_element);
  // NaN at the far corner affects element 26 alone.
  check(nodalField(space, blocks.mesh,
                   [](const Vec3& x) {
                     return Vec3{x.x + x.y + x.z > 2.9 ? NAN : 0.0, 0, 0};
                   }),
        26, not_a_number);
  // Scaled by a thousand: beyond the fixed-point range.
  check(nodalField(space, blocks.mesh, [](const Vec3& x) { return 1e4 * x; }), 0, force_overflow);
}

TEST(Mass, IsDensityTimesVolumeAndNamesABadElement) {
  const exec_space space;
  BlockMesh blocks =
      makeBlocks(space, world, {cube(3), cube(2, {2, 0, 0})}, {steelLike()}, distorted, scattered);
  const auto mass = lumpedMass(space, world, blocks.mesh, blocks.sum);
  EXPECT_NEAR(totalMass(space, world, blocks.mesh, mass), 2, 1e-15 * 10);
  BlockMesh bad = makeBlocks(
      space, world, {cube(3)}, {steelLike()},
      [](const Vec3& x) {
        return x.x + x.y + x.z > 2.9 ? Vec3{0.5, 0.5, 0.5} : x;
      },
      scattered);
  try {
    lumpedMass(space, world, bad.mesh, bad.sum);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("element 26"), std::string::npos) << error.what();
  }
}

TEST(Mass, CountsEveryElementWhoseMassIsBeyondTheRangeOfNumbers) {
  const exec_space space;
  BlockMesh blocks = makeBlocks(
      space, world, {cube(3)}, {steelLike()}, [](const Vec3& x) { return 1e150 * distorted(x); },
      scattered);
  try {
    lumpedMass(space, world, blocks.mesh, blocks.sum);
    FAIL();
  } catch (const InputError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("mass beyond the range of numbers; failed elements: 27"), std::string::npos)
        << text;
  }
}

TEST(Skin, OfACutBlockIsThatOfTheWhole) {
  const exec_space space;
  BlockMesh blocks =
      makeBlocks(space, world, {cube(4), cube(2, {1, 0, 0})}, {steelLike()}, asIs, scattered);
  const Skin skin = findSkin(space, world, blocks.mesh, blocks.shared);
  EXPECT_EQ(allReduce(world, skin.num_faces, MPI_SUM), 6 * 16 + 6 * 4);
  const auto nodes = toHost(skin.face_to_nodes);
  const auto surface = toHost(skin.face_to_surface_nodes);
  const auto to_node = toHost(skin.surface_to_node);
  const auto ids = toHost(skin.face_ids);
  const auto elems = toHost(skin.face_to_elem);
  const auto X = toHost(blocks.mesh.reference_coordinates);
  const auto elem_to_nodes = toHost(blocks.mesh.elem_to_nodes);
  for (int f = 0; f < skin.num_faces; ++f) {
    Vec3 p[4], centre, face_centre;
    for (int c = 0; c < 4; ++c) {
      p[c] = rowOf(X, nodes(f, c));
      face_centre += 0.25 * p[c];
      EXPECT_EQ(to_node(surface(f, c)), nodes(f, c));
    }
    for (int c = 0; c < 8; ++c)
      centre += 0.125 * rowOf(X, elem_to_nodes(elems(f), c));
    EXPECT_GT(dot(cross(p[1] - p[0], p[3] - p[0]), face_centre - centre), 0); // outward
    if (f > 0) {
      EXPECT_GT(ids(f), ids(f - 1));
    }
  }
  // Every owned node on the outside is a surface node on this rank, wherever its faces are.
  const auto owned = toHost(blocks.mesh.node_is_owned);
  int surface_nodes = 0;
  for (int s = 0; s < skin.num_nodes; ++s) {
    surface_nodes += owned(to_node(s));
    if (s > 0) {
      EXPECT_GT(to_node(s), to_node(s - 1));
    }
  }
  EXPECT_EQ(allReduce(world, surface_nodes, MPI_SUM), (125 - 27) + (27 - 1));
}

TEST(ElementFields, OfUniformStrainAreUniformForAllPaths) {
  const exec_space space;
  for (const bool is_distorted : {false, true})
    for (const ElementKind kind : {ElementKind::one_point, ElementKind::full}) {
      BlockMesh blocks = makeBlocks(
          space, world, {cube(3)}, {steelLike()},
          [&](const Vec3& x) { return is_distorted ? distorted(x) : x; }, scattered);
      InternalForce internal(space, world, blocks.mesh, kind, Quantum::powerOfTwo(-54),
                             testEnergyScale());
      const auto u = nodalField(space, blocks.mesh, [](const Vec3& x) {
        return Vec3{0.1 * x.x, 0, 0};
      });
      ElementFields fields;
      internal.computeFields(space, u, fields);
      space.fence();
      const double H[3][3] = {{0.1, 0, 0}, {0, 0, 0}, {0, 0, 0}};
      double sigma[6];
      const Material material = steelLike();
      cauchyStress(H, material, sigma);
      StressPoint<double> point;
      neoHookean(H, material.lambda(), material.mu(), true, point);
      const auto stress = toHost(fields.stress);
      const auto pressure = toHost(fields.pressure);
      const auto density = toHost(fields.energy_density);
      for (int elem = 0; elem < blocks.mesh.num_elems; ++elem) {
        for (int k = 0; k < 6; ++k)
          EXPECT_NEAR(stress(elem, k), sigma[k], 1e-14);
        EXPECT_NEAR(pressure(elem), -(sigma[0] + sigma[1] + sigma[2]) / 3, 1e-14);
        EXPECT_NEAR(density(elem), point.W, 1e-14);
      }
    }
}

} // namespace
} // namespace brickwall::mechanics
