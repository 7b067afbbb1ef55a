// Planes of a free brick (free_bricks.hpp) for its sweep. Host code. Included by free_bricks.cpp,
// stepped_planes_*.cpp and scheduled_sweeps.cpp only.
#pragma once

#include "mechanics/force/lattice/lattice_sweep.hpp"
#include "mechanics/step/kick_packs.hpp"

namespace brickwall::mechanics {

// Implements the `Planes` of lattice_sweep.hpp: planes drift when they are loaded and are kicked
// when their forces are complete.
template <int W>
struct SteppedPlanes {
  static constexpr bool always_with_energy = true;
  const BrickLattice& lattice;
  const View<double* [3]>& displacement;
  const View<double* [3]>& velocity;
  const View<const double* [3]>& reference;
  const View<const double*>& mass;
  bool drifts;
  double dt_drift;
  PackKicker<1, W>& kicker;

  void load(int plane, const PlaneBuffers<W>& buffers) const {
    const int nodes = lattice.planeNodes(), first = lattice.first_node + plane * nodes;
    int p = 0;
    for (; p + W <= nodes; p += W) {
      // The transposition works on registers, because loading what has just been stored is slow.
      PackOf<W> rows[3], u[3];
      driftRows(first + p, rows);
      triplesOf([&](int k) { return rows[k]; }, u);
      storeRows(plane, p, u, buffers);
    }
    if (p < nodes)
      loadRest(plane, p, nodes - p, buffers);
  }
  // The three packs `rows` are the displacements of W nodes.
  KOKKOS_FORCEINLINE_FUNCTION void driftRows(int node, PackOf<W> (&rows)[3]) const {
    double* const u = &displacement(node, 0);
    const double* const v = &velocity(node, 0);
    for (int k = 0; k < 3; ++k) {
      rows[k] = loadPack<PackOf<W>>(u + W * k);
      if (drifts) {
        rows[k] = rows[k] + dt_drift * loadPack<PackOf<W>>(v + W * k);
        storePack(rows[k], u + W * k);
      }
    }
  }
  __attribute__((noinline)) void loadRest(int plane, int p, int count,
                                          const PlaneBuffers<W>& buffers) const {
    const int node = lattice.first_node + plane * lattice.planeNodes() + p;
    PackOf<W> u[3] = {PackOf<W>(0.0), PackOf<W>(0.0), PackOf<W>(0.0)};
    for (int lane = 0; lane < count; ++lane)
      for (int axis = 0; axis < 3; ++axis) {
        double& moved = displacement(node + lane, axis);
        if (drifts)
          moved += dt_drift * velocity(node + lane, axis);
        setLane(u[axis], lane, moved);
      }
    storeRows(plane, p, u, buffers);
  }
  KOKKOS_FORCEINLINE_FUNCTION static void storeRows(int plane, int p, const PackOf<W> (&u)[3],
                                                    const PlaneBuffers<W>& buffers) {
    for (int axis = 0; axis < 3; ++axis)
      storePack(u[axis], buffers.displacement(plane, axis) + p);
  }

  // Prefetches the operands of load() and finish() for W nodes.
  KOKKOS_FORCEINLINE_FUNCTION void prefetchRows(int node) const {
    const std::size_t at = 3 * static_cast<std::size_t>(node);
    for (int line = 0; line < 3; ++line) {
      prefetch(displacement.data() + at + W * line);
      prefetch(velocity.data() + at + W * line);
      prefetch(reference.data() + at + W * line);
    }
    prefetch(mass.data() + node);
  }

  KOKKOS_FORCEINLINE_FUNCTION void finish(int plane, int p, const IntPackOf<W> (&force)[3]) {
    const int nodes = lattice.planeNodes(), first = lattice.first_node + plane * nodes + p;
    const int count = minOf(W, nodes - p);
    prefetchRows(first + 2 * nodes);
    if (count == W && kicker.isFree(first)) {
      kicker.kickPlain(first, force);
    } else if (kicker.isFree(first, count)) {
      kicker.kickSome(first, count, force, firstLanes<W>(count));
    } else {
      for (int lane = 0; lane < count; ++lane)
        kicker.kickOne(first + lane, {force[0][lane], force[1][lane], force[2][lane]});
    }
  }
};

// Compiled in scheduled_sweeps.cpp with flags of its own.
void runSweep(
    LatticeSweep<MaterialModel::neo_hookean, SharedShape<OnePointBrick>, simd_width>& sweep,
    const LatticeSlab& slab, SteppedPlanes<simd_width>& planes);

extern template void sweepModel<MaterialModel::neo_hookean>(const BrickLattice&, const LatticeSlab&,
                                                            const ForceArguments&, double*,
                                                            ForceSums&, SteppedPlanes<simd_width>&);
extern template void sweepModel<MaterialModel::svk>(const BrickLattice&, const LatticeSlab&,
                                                    const ForceArguments&, double*, ForceSums&,
                                                    SteppedPlanes<simd_width>&);
extern template void sweepModel<MaterialModel::linear>(const BrickLattice&, const LatticeSlab&,
                                                       const ForceArguments&, double*, ForceSums&,
                                                       SteppedPlanes<simd_width>&);

} // namespace brickwall::mechanics
