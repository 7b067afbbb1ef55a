// The largest frequency of assembled bodies: against known steps of bricks, against the true limit
// of the time loop, and on any number of ranks.
#include "mechanics/element/rest_stiffness.hpp"
#include "mechanics/mesh/body_types.hpp"
#include "mechanics/stability/largest_frequency.hpp"
#include "mechanics/stability/ritz_value.hpp"
#include "tests/mechanics/support/solver.hpp"

#include <gtest/gtest.h>

namespace {

using namespace brickwall;
using namespace brickwall::mechanics;
using namespace brickwall::mechanics::testing;

LargestFrequency frequencyOf(MPI_Comm comm, BlockMesh& blocks,
                             ElementKind kind = ElementKind::one_point) {
  const exec_space space;
  const auto mass = lumpedMass(space, comm, blocks.mesh, blocks.sum);
  const double bound = stableTimeStep(space, comm, blocks.mesh).dt;
  return largestFrequency(space, comm, blocks.mesh, blocks.shared, mass,
                          findBodyTypes(space, comm, blocks.mesh), kind, bound);
}

// A brick of n^3 cubes.
Block bricks(int n, double edge = 1, Vec3 origin = {}, int material = 0) {
  return {{n, n, n}, {n * edge, n * edge, n * edge}, origin, material};
}

// dt c_d/h of free bricks of n^3 elements, from dense eigenvalue solutions.
TEST(LargestFrequency, OfBricksHasTheKnownValue) {
  struct Known {
    double poisson;
    int n;
    double step;
  };
  const Known known[] = {{0.3, 1, 0.734},   {0.3, 2, 0.932},   {0.3, 3, 0.928},   {0.3, 6, 0.970},
                         {0.499, 1, 0.578}, {0.499, 2, 0.817}, {0.499, 3, 0.828}, {0.499, 6, 0.852},
                         {0.2, 1, 0.816},   {0.2, 2, 0.971},   {0.2, 3, 0.962},   {0.2, 6, 0.993},
                         {0, 1, 1},         {0, 3, 1}};
  for (const Known& brick : known) {
    const Material material = steelLike(MaterialModel::neo_hookean, brick.poisson);
    BlockMesh blocks =
        makeBlocks(exec_space(), MPI_COMM_SELF, {bricks(brick.n)}, {material}, asIs, onOneRank);
    const LargestFrequency found = frequencyOf(MPI_COMM_SELF, blocks);
    const double unit = 1 / material.dilatationalSpeed();
    EXPECT_NEAR(2 / std::sqrt(found.ritz) / unit, brick.step, 0.0015)
        << brick.poisson << " " << brick.n;
    EXPECT_LE(2 / std::sqrt(found.bound.bodies) / unit, brick.step + 0.0006);
    EXPECT_GE(2 / std::sqrt(found.bound.bodies) / unit, brick.step * 0.9965);
    EXPECT_LE(found.products, 120);
  }
}

TEST(RestForces, AreTheSlopeOfTheElementForces) {
  const CornerCoordinates X = {{0, 0, 0},      {1.1, 0.1, -0.1}, {1, 0.9, 0.1}, {-0.1, 1, 0},
                               {0, 0.1, 1.05}, {1, 0, 0.9},      {1.1, 1, 1},   {0.1, 0.9, 1.1}};
  const Material material = steelLike();
  const OnePointGeometry<double> geometry = onePointGeometry(X);
  double u[3][num_modes], plus[3][num_modes], minus[3][num_modes], forces[3][num_modes];
  constexpr double h = 1e-5;
  for (int k = 0; k < 3 * num_modes; ++k) {
    u[k / num_modes][k % num_modes] = randomOf(static_cast<std::uint64_t>(k));
    plus[k / num_modes][k % num_modes] = h * u[k / num_modes][k % num_modes];
    minus[k / num_modes][k % num_modes] = -h * u[k / num_modes][k % num_modes];
  }
  OnePointForces<double> at_plus, at_minus;
  const auto stiffness = stiffnessOf(geometry, ElementModuli::of(material), 1.0);
  onePointForces<MaterialModel::neo_hookean>(plus, geometry, stiffness, false, at_plus);
  onePointForces<MaterialModel::neo_hookean>(minus, geometry, stiffness, false, at_minus);
  restForces(u, geometry, material, forces);
  for (int i = 0; i < 3; ++i)
    for (int m = 0; m < num_modes; ++m)
      EXPECT_NEAR(forces[i][m], -(at_plus.force[i][m] - at_minus.force[i][m]) / (2 * h), 1e-8);
}

TEST(RitzValue, OfAChainIsTheClosedForm) {
  for (const int n : {1, 2, 7, 40}) {
    const double pi = std::acos(-1.0);
    const RitzValue ritz =
        largestRitzValue(std::vector<double>(n, 2), std::vector<double>(n - 1, 1));
    EXPECT_NEAR(ritz.value, 2 + 2 * std::cos(pi / (n + 1)), 1e-14);
    EXPECT_NEAR(ritz.last, std::sqrt(2.0 / (n + 1)) * std::sin(pi * n / (n + 1)), 1e-12);
  }
}

// Four bodies of two types, which numbering and materials determine; one body displaced, and a
// distorted one.
BlockMesh someBodies(MPI_Comm comm, double distortion, const Partition& partition) {
  const std::vector<Block> blocks = {bricks(3), bricks(3, 1, {4.1, 0, 0}),
                                     bricks(2, 0.5, {0, 0, 9}, 1), bricks(3, 1, {0, 5.3, 0.7}, 2)};
  const std::vector<Material> materials = {
      steelLike(), {MaterialModel::svk, 3, 1, 0.4}, steelLike(MaterialModel::linear)};
  const auto place = [distortion](const Vec3& x) {
    const auto seed = static_cast<std::uint64_t>(1e4 * (x.x + 10 * x.y + 100 * x.z) + 0.5);
    return x + (x.x > 3.5 ? distortion : 0.0) * randomVector(3 * seed);
  };
  return makeBlocks(exec_space(), comm, blocks, materials, place, partition);
}

TEST(BodyTypes, AreEqualIfMeshAndStiffnessAre) {
  const exec_space space;
  for (const double distortion : {0.0, 0.1}) {
    const BlockMesh blocks = someBodies(world, distortion, nullptr);
    const BodyTypes types = findBodyTypes(space, world, blocks.mesh);
    EXPECT_EQ(types.count, distortion > 0 ? 3 : 2); // the material model has no effect at rest
    for (std::size_t b = 0; b < blocks.mesh.bodies.size(); ++b) {
      const global_id body = blocks.mesh.bodies[b].body;
      const global_id expected[] = {0, distortion > 0 ? 1 : 0, 2, 0};
      EXPECT_EQ(types.representative[b], expected[body]);
      const global_id first[] = {0, 64, 128, 155};
      EXPECT_EQ(types.first_node[b], first[body]);
    }
  }
}

// Elements of bodies may take turns in a mesh file.
TEST(BodyTypes, AreCountedOnceIfABodyHasSeveralRangesOfElements) {
  BlockMesh blocks = someBodies(MPI_COMM_SELF, 0.0, onOneRank);
  const auto elem_to_nodes = toHost(blocks.mesh.elem_to_nodes);
  const auto ids = toHost(blocks.mesh.node_ids);
  std::swap(ids(elem_to_nodes(0, 0)), ids(elem_to_nodes(0, 6))); // eight elements have the first
  Kokkos::deep_copy(blocks.mesh.node_ids, ids);
  const auto num_types = findBodyTypes(exec_space(), MPI_COMM_SELF, blocks.mesh).count;
  std::vector<ElementRange> ranges;
  for (const ElementRange& body : blocks.mesh.bodies)
    for (int elem = body.first; elem < body.first + body.count; ++elem)
      ranges.push_back({elem, 1, body.body});
  blocks.mesh.bodies = ranges;
  EXPECT_EQ(findBodyTypes(exec_space(), MPI_COMM_SELF, blocks.mesh).count, num_types);
}

TEST(LargestFrequency, HasTheSameBitsOnAnyNumberOfRanks) {
  for (const ElementKind kind : {ElementKind::one_point, ElementKind::full})
    for (const double distortion : {0.0, 0.1}) {
      BlockMesh whole = someBodies(MPI_COMM_SELF, distortion, onOneRank);
      const LargestFrequency expected = frequencyOf(MPI_COMM_SELF, whole, kind);
      const auto num_types = findBodyTypes(exec_space(), MPI_COMM_SELF, whole.mesh).count;
      for (const Partition& partition :
           {Partition(nullptr), Partition(onOneRank), Partition(slices)}) {
        BlockMesh cut = someBodies(world, distortion, partition);
        const LargestFrequency found = frequencyOf(world, cut, kind);
        EXPECT_EQ(found.ritz, expected.ritz);
        EXPECT_EQ(found.bound.bodies, expected.bound.bodies);
        EXPECT_EQ(found.products, expected.products);
        EXPECT_EQ(findBodyTypes(exec_space(), world, cut.mesh).count, num_types);
      }
    }
}

TEST(LargestFrequency, OfSeveralBodiesIsTheLargestOfEach) {
  const Material stiff = {MaterialModel::neo_hookean, 1, 4, 0.3}, soft = steelLike();
  const auto of = [&](const std::vector<Block>& blocks) {
    BlockMesh mesh =
        makeBlocks(exec_space(), MPI_COMM_SELF, blocks, {soft, stiff}, asIs, onOneRank);
    return frequencyOf(MPI_COMM_SELF, mesh).ritz;
  };
  const double alone = of({bricks(3, 1, {}, 1)});
  EXPECT_NEAR(of({bricks(6), bricks(3, 1, {9, 0, 0}, 1), bricks(3, 1.5, {0, 9, 0})}), alone,
              2e-3 * alone);
}

// Bodies under contact that takes the fraction `a` of the mass of given nodes.
double stepUnderContact(BlockMesh& blocks, const std::vector<int>& surface, double a) {
  const exec_space space;
  const auto mass =
      massUnderContact(space, lumpedMass(space, MPI_COMM_SELF, blocks.mesh, blocks.sum),
                       toDevice(space, "surface", surface), a);
  const StabilityTerms load = {{}, 0, a};
  const double bound = stableTimeStep(space, MPI_COMM_SELF, blocks.mesh, load).dt;
  const RestFrequency rest =
      largestFrequency(space, MPI_COMM_SELF, blocks.mesh, blocks.shared, mass,
                       findBodyTypes(space, MPI_COMM_SELF, blocks.mesh), ElementKind::one_point,
                       bound)
          .bound;
  return stableTimeStep(space, MPI_COMM_SELF, blocks.mesh, load, rest).dt;
}

// A chain of masses m and springs k whose end has the mass mu m < m/2 has a mode localised there,
// omega^2 = (k/m)/(mu (1 - mu)).
TEST(StepUnderContact, OfABarPressedAtItsEndsHasTheKnownValue) {
  const Block bar{{40, 1, 1}, {40, 3, 3}};
  const Material material = steelLike(MaterialModel::linear, 0);
  BlockMesh blocks = makeBlocks(exec_space(), MPI_COMM_SELF, {bar}, {material}, asIs, onOneRank);
  const auto X = toHost(blocks.mesh.reference_coordinates);
  std::vector<int> ends, all;
  for (int node = 0; node < blocks.mesh.num_nodes; ++node) {
    all.push_back(node);
    if (X(node, 0) < 0.5 || X(node, 0) > 39.5)
      ends.push_back(node);
  }
  for (const double a : {0.3, 0.5}) {
    const double mu = 0.5 * (1 - a), free = 1 / material.dilatationalSpeed();
    const double expected = free * std::sqrt(4 * mu * (1 - mu));
    const double step = stepUnderContact(blocks, ends, a);
    EXPECT_LE(step, expected * (1 + 1e-9));
    EXPECT_GE(step, expected * 0.998); // margin of the Lanczos bound
    // Weyl's bound if every node is a contact node.
    EXPECT_NEAR(stepUnderContact(blocks, all, a), free * std::sqrt(1 - a), 1e-9 * free);
  }
}

// The step is a sharp limit of the time loop: 0.99 of it is stable, and at 1.01 small noise grows
// without bound. No contact, small strains, 1e4 steps.
struct FreeBody {
  const char* name;
  Block block;
  Material material;
  double distortion;
  ElementKind kind;
};
std::vector<FreeBody> freeBodies() {
  const Block slab{{6, 3, 1}, {1.5, 2, 0.4}};
  return {
      {"cube", bricks(3), steelLike(MaterialModel::neo_hookean, 0.3), 0, ElementKind::one_point},
      {"nearly incompressible", bricks(2), steelLike(MaterialModel::svk, 0.499), 0,
       ElementKind::one_point},
      {"slab", slab, steelLike(MaterialModel::linear, 0.2), 0, ElementKind::one_point},
      {"distorted", bricks(3), steelLike(MaterialModel::neo_hookean, 0.3), 0.12,
       ElementKind::one_point},
      {"full integration", bricks(2), steelLike(MaterialModel::neo_hookean, 0.3), 0.1,
       ElementKind::full}};
}

// Kinetic energy after the steps over that at the start; stops after growth by 1e9.
double growthOfEnergy(const FreeBody& body, double share) {
  Solver solver(
      MPI_COMM_SELF, body.block, body.material, {},
      [&](const Vec3& x) {
        const auto seed = static_cast<std::uint64_t>(1e4 * (x.x + 10 * x.y + 100 * x.z) + 0.5);
        return x + body.distortion * randomVector(3 * seed);
      },
      body.kind);
  const LargestFrequency found = frequencyOf(MPI_COMM_SELF, solver.blocks, body.kind);
  const double dt = share * 2 / std::sqrt(found.ritz);
  const double speed = 1e-9 * body.material.dilatationalSpeed();
  const auto v = Kokkos::create_mirror_view(solver.state.velocity);
  for (int k = 0; k < 3 * solver.blocks.mesh.num_nodes; ++k)
    v(k / 3, k % 3) = speed * randomOf(static_cast<std::uint64_t>(k));
  Kokkos::deep_copy(solver.state.velocity, v);
  solver.start(dt);
  const double before = solver.ledger.balance().kinetic;
  for (int step = 0; step < 10000; ++step) {
    solver.step(dt);
    if (solver.ledger.balance().kinetic > 1e9 * before)
      break;
  }
  return solver.ledger.balance().kinetic / before;
}

TEST(LargestFrequency, IsASharpLimitOfTheStep) {
  if (sizeOf(world) > 1)
    GTEST_SKIP() << "runs on one rank only";
  for (const FreeBody& body : freeBodies()) {
    EXPECT_LT(growthOfEnergy(body, 0.99), 100) << body.name;
    EXPECT_GT(growthOfEnergy(body, 1.01), 1e9) << body.name;
  }
}

} // namespace
