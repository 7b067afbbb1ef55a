// Prints the speed of the whole solver without contact: drift, forces, kick, boundary conditions
// and ledger. BRICKWALL_BRICKS sets the number of bricks of 16x8x8 elements (435 as in W(8)),
// BRICKWALL_ONLY selects cases by a part of their name. The same run measures for comparison
//   triad      a = b + s c on arrays beyond the caches: 3 numbers of 8 bytes each
//   peak       multiplications and additions of vectors in registers
//   launch     of a kernel without work
// and counts the flops of one element and one node by running their templates on a counting type.
#include "contact/base/to_device.hpp"
#include "mechanics/ledger/energy.hpp"
#include "mechanics/step/central_difference.hpp"
#include "mechanics/step/free_bricks/free_bricks.hpp"
#include "mechanics/step/kick_kernel.hpp"
#include "tests/mechanics/support/block_mesh.hpp"
#include "verification/performance/benchmarks/benchmark_clock.hpp"
#include "verification/performance/benchmarks/counted.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

namespace brickwall {

// Found through its argument.
inline Counted logOnePlus(const Counted&, const Counted& s) {
  return mechanics::logSeries(s, Counted(s * s));
}

namespace mechanics {
namespace {

using namespace testing;

int numBricks() {
  const char* text = std::getenv("BRICKWALL_BRICKS");
  return text ? std::atoi(text) : 24;
}

// Median and minimum of the times of several calls.
struct Seconds {
  double median, best;
};
template <class Call>
Seconds timeCalls(int calls, const Call& call) {
  std::vector<double> seconds;
  for (int c = 0; c < calls; ++c) {
    const double begin = now();
    call();
    seconds.push_back(now() - begin);
  }
  std::sort(seconds.begin(), seconds.end());
  return {seconds[calls / 2], seconds[0]};
}

// --- counting of operations

template <MaterialModel model, class Geometry>
std::int64_t flopsOfElement(const Geometry& geometry) {
  const auto stiffness = stiffnessOf(geometry, ElementModuli::of(steelLike(model)), 1.0);
  Counted::count = 0;
  Counted u[3][num_modes] = {}, corner[3][8] = {};
  for (int i = 0; i < 3; ++i)
    cornersToModes(corner[i], u[i]);
  OnePointForces<Counted> forces = {};
  onePointForces<model>(u, geometry, stiffness, true, forces);
  return Counted::count;
}
std::int64_t flopsOfNode() {
  Counted::count = 0;
  NodeKick<Counted> kick = {};
  Counted term[num_plain_kick_terms] = {};
  kick.mass = 1.0;
  kick.accelerate(kick.force, 1, Vec3());
  kick.terms(1, term);
  return Counted::count + 12; // x = X + u, u += dt v, force = quantum f
}

// --- the machine

double triadBandwidth(const exec_space& space) { // bytes per second
  const std::int64_t n = 16 << 20;
  View<double*> a("a", n), b("b", n), c("c", n);
  const Seconds seconds = timeCalls(7, [&] {
    Kokkos::parallel_for(
        "triad", rangePolicy(space, n),
        KOKKOS_LAMBDA(const std::int64_t i) { a(i) = b(i) + 3.0 * c(i); });
    space.fence();
  });
  return 24.0 * n / seconds.median;
}

// Times of a launch over one number per thread, with the wait for its end, in runs of 100.
void printLaunches(const exec_space& space) {
  constexpr int runs = 101, launches = 100;
  const int threads = concurrency(space);
  const View<double*> a("a", threads);
  const auto timed = [&](const auto& launch) {
    const Seconds seconds = timeCalls(runs, [&] {
      for (int l = 0; l < launches; ++l)
        launch();
    });
    return 1e6 * seconds.median / launches;
  };
  const double loop = timed([&] {
    Kokkos::parallel_for(
        "empty", rangePolicy(space, threads), KOKKOS_LAMBDA(const std::int64_t i) { a(i) = 1; });
    space.fence();
  });
  const double reduction = timed([&] {
    double sum = 0;
    Kokkos::parallel_reduce(
        "empty", rangePolicy(space, threads),
        KOKKOS_LAMBDA(const std::int64_t i, double& part) { part += a(i); }, sum);
  });
  std::printf("  empty launch: parallel_for %.2f us, parallel_reduce %.2f us\n", loop, reduction);
}

// Ten independent chains of products and ten of sums.
template <int W>
struct PeakLoop {
  View<double*> out;
  void operator()(const std::int64_t thread) const {
    constexpr int chains = 10, turns = 2000000;
    PackOf<W> x[chains], y[chains];
    for (int k = 0; k < chains; ++k)
      x[k] = y[k] = PackOf<W>(1.0 + 1e-9 * k);
    PackOf<W> factor(1 + 1e-12), term(1e-12);
    for (int turn = 0; turn < turns; ++turn)
      for (int k = 0; k < chains; ++k) {
        x[k] = x[k] * factor;
        y[k] = y[k] + term;
      }
    double sum = 0;
    for (int k = 0; k < chains; ++k)
      sum += x[k][0] + y[k][W - 1];
    out(thread) = sum;
  }
  static constexpr double flops() { return 2.0 * 10 * 2000000 * W; }
};
// Flops per second; 0 without SIMD lanes. A template, since PackOf<1> does not exist.
template <int W>
double vectorPeak(const exec_space& space) {
  if constexpr (W > 1) {
    const int threads = concurrency(space);
    const PeakLoop<W> loop{View<double*>("out", threads)};
    const Seconds seconds = timeCalls(5, [&] {
      Kokkos::parallel_for("peak", rangePolicy(space, threads), loop);
      space.fence();
    });
    return threads * loop.flops() / seconds.median;
  }
  return 0;
}

// --- the solver

struct Bench {
  exec_space space;
  BlockMesh blocks;
  NodalState state;
  NodalForces forces;
  LedgerScales scales;
  std::unique_ptr<InternalForce> internal;
  std::unique_ptr<BoundaryConditions> boundary;
  FreeBricks bricks;
  NodeSelection others;
  EnergyLedger ledger;
  double dt = 0, time = 0;

  Bench(bool is_distorted, MaterialModel model, bool frees) {
    std::vector<Block> wall(numBricks());
    for (std::size_t b = 0; b < wall.size(); ++b) {
      wall[b].elements[0] = 16;
      wall[b].elements[1] = wall[b].elements[2] = 8;
      wall[b].size = {2, 1, 1};
      wall[b].origin = {2.5 * (b % 32), 0, 1.25 * (b / 32)};
    }
    blocks = makeBlocks(space, MPI_COMM_SELF, wall, {steelLike(model, 0.2)}, [&](const Vec3& x) {
      return is_distorted ? x + Vec3{0.01 * std::sin(9 * x.y), 0.01 * std::sin(7 * x.z), 0} : x;
    });
    const HexMesh& mesh = blocks.mesh;
    const Quantum quantum = Quantum::forForceScale(forceScale(space, MPI_COMM_SELF, mesh));
    scales = ledgerScales(space, MPI_COMM_SELF, mesh);
    internal = std::make_unique<InternalForce>(space, MPI_COMM_SELF, mesh, ElementKind::one_point,
                                               quantum, scales.energy);
    PrescribedMotion base;
    const auto X = toHost(mesh.reference_coordinates);
    for (int node = 0; node < mesh.num_nodes; ++node)
      if (X(node, 2) == 0)
        base.nodes.push_back(node);
    boundary = std::make_unique<BoundaryConditions>(
        space, mesh.num_nodes, std::vector<PrescribedMotion>{base}, Vec3{0, 0, -1e-4});
    state = stateAtRest(space, MPI_COMM_SELF, blocks);
    state.velocity = nodalField(space, mesh, [](const Vec3& x) {
      return Vec3{1e-3 * std::sin(x.y), 2e-3 * std::cos(x.x * x.z), 1e-3 * std::sin(x.x)};
    });
    others = NodeSelection::allOf(mesh.num_nodes);
    if (frees) {
      bricks = FreeBricks(space, mesh, *internal, std::vector<char>(mesh.num_nodes, 0));
      others = bricks.otherNodes();
    }
    if (others.numRuns() > 0)
      forces = zeroedForces(mesh, quantum);
    ledger = EnergyLedger(MPI_COMM_SELF, scales, boundary->gravity(),
                          totalMass(space, MPI_COMM_SELF, mesh, state.mass),
                          motionOf(space, mesh, state, scales));
    dt = 0.02;
  }

  void step() {
    time += dt;
    InternalForceResult stored;
    KickSums sums;
    if (others.numRuns() > 0) {
      drift(space, dt, state, others);
      zeroForces(space, forces);
      stored = internal->add(space, state.displacement, forces, true);
      sums = kick(space, blocks.mesh, *boundary, {time, time + dt}, dt, forces, state, scales, {},
                  others);
    }
    if (bricks.any()) {
      const auto result = bricks.step(space, blocks.mesh, *internal, *boundary, {time, time + dt},
                                      true, dt, dt, state, scales);
      stored.energy += result.internal.energy;
      stored.failure += result.internal.failure;
      stored.has_energy = true;
      sums += result.kick;
    }
    ledger.bookStep(MPI_COMM_SELF, dt, dt, stored, {}, sums);
  }
};

template <class... Views>
double bytesOf(const Views&... views) {
  return (static_cast<double>(views.span() * sizeof(typename Views::value_type)) + ...);
}

double measure(const char* name, bool is_distorted, MaterialModel model, bool frees) {
  const char* const only = std::getenv("BRICKWALL_ONLY");
  if (only && !std::strstr(name, only))
    return 1;
  Bench bench(is_distorted, model, frees);
  for (int warm = 0; warm < 3; ++warm)
    bench.step();
  const Seconds seconds = timeCalls(numBricks() < 100 ? 200 : 27, [&] { bench.step(); });
  EXPECT_EQ(bench.ledger.balance().failures, 0);
  const HexMesh& mesh = bench.blocks.mesh;
  const double elems = mesh.num_elems;
  double resident = bytesOf(bench.state.displacement, bench.state.velocity, bench.state.mass,
                            mesh.reference_coordinates, mesh.node_is_owned,
                            bench.boundary->motion(), bench.forces.values);
  resident += bytesOf(bench.internal->tables().geometry);
  if (!frees)
    resident += bytesOf(mesh.elem_to_nodes);
  std::printf("  %-46s %6.2f M element-steps/s, best step %6.2f, %4.0f B resident\n", name,
              elems / seconds.median * 1e-6, elems / seconds.best * 1e-6, resident / elems);
  return seconds.median / elems;
}

TEST(SolverSpeed, IsPrinted) {
  const exec_space space;
  const bool all = !std::getenv("BRICKWALL_ONLY");
  const double triad = all ? triadBandwidth(space) : 1,
               peak = all ? vectorPeak<simd_width>(space) : 1;
  std::printf("  %d thread(s), %d bricks; triad %.1f GB/s; peak %.1f Gflop/s\n", concurrency(space),
              numBricks(), triad * 1e-9, peak * 1e-9);
  printLaunches(space);
  const double nodes_per_elem = 17.0 * 9 * 9 / (16 * 8 * 8);
  const double neo = measure("congruent, neo-Hookean", false, MaterialModel::neo_hookean, true);
  measure("congruent, linear", false, MaterialModel::linear, true);
  measure("congruent, svk", false, MaterialModel::svk, true);
  measure("congruent, drift/forces/kick apart, neo-Hookean", false, MaterialModel::neo_hookean,
          false);
  const double general = measure("distorted, neo-Hookean", true, MaterialModel::neo_hookean, true);
  measure("distorted, linear", true, MaterialModel::linear, true);
  measure("distorted, drift/forces/kick apart, neo-Hookean", true, MaterialModel::neo_hookean,
          false);
  OnePointBrick brick = {};
  OnePointGeometry<Counted> hex = {};
  const double brick_flops =
      flopsOfElement<MaterialModel::neo_hookean>(brick) + nodes_per_elem * flopsOfNode();
  const double hex_flops =
      flopsOfElement<MaterialModel::neo_hookean>(hex) + nodes_per_elem * flopsOfNode();
  // u, v read and written, X, mass, motion
  const double traffic = nodes_per_elem * (4 * 24 + 24 + 8 + 3);
  std::printf("  congruent: %.0f flops, %.0f B of traffic an element-step, %.2f of peak, %.2f of "
              "triad\n",
              brick_flops, traffic, brick_flops / neo / peak, traffic / neo / triad);
  std::printf("  distorted: %.0f flops an element-step, %.2f of peak\n", hex_flops,
              hex_flops / general / peak);
}

} // namespace
} // namespace mechanics
} // namespace brickwall
