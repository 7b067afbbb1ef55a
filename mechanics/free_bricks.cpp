#include "mechanics/free_bricks.hpp"

#include "mechanics/brick_sweep.hpp"
#include "mechanics/central_difference.hpp"
#include "mechanics/host_mesh.hpp"
#include "mechanics/kick_kernel.hpp"

namespace brickwall::mechanics {

namespace {

struct BrickSums {
  ForceSums force;
  KickSums kick;
  KOKKOS_INLINE_FUNCTION BrickSums& operator+=(const BrickSums& b) {
    force += b.force;
    kick += b.kick;
    return *this;
  }
};

// Planes drift as they are loaded and are kicked when their forces are complete.
template <int W>
struct SteppedPlanes {
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
      // Through registers: what has just been stored is slow to load again.
      PackOf<W> rows[3], u[3];
      driftRows(first + p, rows);
      triplesOf([&](int k) { return rows[k]; }, u);
      storeRows(plane, p, u, buffers);
    }
    if (p < nodes)
      loadRest(plane, p, nodes - p, buffers);
  }
  // Three packs of `rows` are the displacements of W nodes.
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

  // What load() and finish() will want of W nodes.
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

template <int W>
struct BrickStepFunctor {
  LatticeTables tables;
  View<LatticeSlab*> slabs;
  ForceArguments a;
  KickNode<1> node_kick;
  View<double* [3]> displacement;
  bool drifts;
  double dt_drift;
  Kokkos::Experimental::UniqueToken<exec_space> token;

  void operator()(const std::int64_t s, BrickSums& sums) const {
    const LatticeSlab slab = slabs(s);
    const BrickLattice lattice = tables.lattices(slab.lattice);
    PackKicker<1, W> kicker(node_kick, sums.kick);
    SteppedPlanes<W> planes{lattice,        displacement, node_kick.velocity, node_kick.reference,
                            node_kick.mass, drifts,       dt_drift,           kicker};
    const auto thread = token.acquire();
    sweepSlab<W>(lattice, slab, a, &tables.scratch(thread, 0), sums.force, planes);
    token.release(thread);
  }
};

template <int W>
BrickSums launch(const exec_space& space, const BrickStepFunctor<W>& functor) {
  BrickSums sums;
  if constexpr (W > 1) {
    Kokkos::parallel_reduce(
        "mechanics::FreeBricks::step::slabs",
        overInChunks(space, static_cast<std::int64_t>(functor.slabs.extent(0)), 1), functor,
        Combine<BrickSums>(sums));
    space.fence();
  }
  return sums;
}

bool isFree(const BrickLattice& lattice, const std::vector<char>& is_loaded) {
  if (!lattice.is_whole)
    return false;
  for (int node = lattice.first_node; node < lattice.first_node + lattice.numNodes(); ++node)
    if (is_loaded[node])
      return false;
  return true;
}

NodeSelection selectNodes(const exec_space& space, const std::vector<char>& marks, char mark) {
  std::vector<NodeRun> runs;
  for (int node = 0; node < static_cast<int>(marks.size()); ++node)
    if (marks[node] == mark)
      appendNode(node, runs);
  NodeSelection selection;
  selection.all = false;
  selection.runs = copyToDevice(space, "mechanics::FreeBricks::node_runs", runs);
  return selection;
}

} // namespace

FreeBricks::FreeBricks(const exec_space& space, const HexMesh& mesh, InternalForce& internal,
                       const std::vector<char>& is_loaded) {
  const std::vector<BrickLattice>& lattices = internal.lattices().on_host;
  std::vector<int> rows;
  std::vector<char> is_own(mesh.num_nodes, 0);
  for (int row = 0; row < static_cast<int>(lattices.size()); ++row) {
    const BrickLattice& lattice = lattices[row];
    if (!isFree(lattice, is_loaded))
      continue;
    rows.push_back(row);
    _num_elems += lattice.numElems();
    std::fill_n(is_own.begin() + lattice.first_node, lattice.numNodes(), 1);
  }
  if (rows.empty()) {
    _other_nodes = NodeSelection::allOf(mesh.num_nodes);
    return;
  }
  const std::vector<LatticeSlab> slabs = cutIntoSlabs(lattices, rows, internal.threads());
  _has_pieces = slabs.size() > rows.size();
  _slabs = copyToDevice(space, "mechanics::FreeBricks::slabs", slabs);
  _own_nodes = selectNodes(space, is_own, 1);
  _other_nodes = selectNodes(space, is_own, 0);
  internal.leaveOut(space, rows);
}

FreeBricks::Result FreeBricks::step(const exec_space& space, const HexMesh& mesh,
                                    const InternalForce& internal,
                                    const BoundaryConditions& boundary, double time, bool drifts,
                                    double dt_drift, double dt_kick, const NodalState& state,
                                    const LedgerScales& scales, const SpeedTest& test) const {
  if (drifts && _has_pieces) {
    drift(space, dt_drift, state, _own_nodes);
    drifts = false;
  }
  const Quantum quantum = internal.quantum();
  const ForceArguments arguments{internal.tables(), state.displacement,     {}, {},   {},
                                 quantum.inverse,   internal.energyScale(), 0,  true, true};
  const KickNode<1> node_kick{mesh.reference_coordinates,
                              state.displacement,
                              state.velocity,
                              state.mass,
                              mesh.node_is_owned,
                              {},
                              quantum.value,
                              dt_kick,
                              boundary.at(time),
                              scales,
                              test};
  const BrickSums sums = launch(space, BrickStepFunctor<simd_width>{internal.lattices(),
                                                                    _slabs,
                                                                    arguments,
                                                                    node_kick,
                                                                    state.displacement,
                                                                    drifts,
                                                                    dt_drift,
                                                                    {}});
  Result result;
  result.internal.energy = sums.force.energy;
  result.internal.failure = sums.force.failure;
  result.internal.has_energy = true;
  result.internal.energy.carry();
  result.kick = sums.kick;
  result.kick.carry();
  return result;
}

} // namespace brickwall::mechanics
