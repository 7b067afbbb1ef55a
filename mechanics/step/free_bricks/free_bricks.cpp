#include "mechanics/step/free_bricks/free_bricks.hpp"

#include "mechanics/mesh/host_mesh.hpp"
#include "mechanics/step/central_difference.hpp"
#include "mechanics/step/free_bricks/stepped_planes.hpp"

namespace brickwall::mechanics {

struct BrickSums {
  ForceSums force;
  KickSums kick;
  KOKKOS_INLINE_FUNCTION BrickSums& operator+=(const BrickSums& b) {
    force += b.force;
    kick += b.kick;
    return *this;
  }
};

namespace {

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
    sweepSlab(lattice, slab, a, &tables.scratch(thread, 0), sums.force, planes);
    token.release(thread);
  }
};

template <int W>
BrickSums launch(const exec_space& space, const BrickStepFunctor<W>& functor) {
  BrickSums sums;
  if constexpr (W > 1) {
    Kokkos::parallel_reduce(
        "mechanics::FreeBricks::step::slabs",
        dynamicPolicy(space, static_cast<std::int64_t>(functor.slabs.extent(0)), 1), functor,
        PlusReducer<BrickSums>(sums));
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
  selection.num_nodes = static_cast<int>(marks.size());
  selection.runs = toDevice(space, "mechanics::FreeBricks::node_runs", runs);
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
  _slabs = toDevice(space, "mechanics::FreeBricks::slabs", slabs);
  _own_nodes = selectNodes(space, is_own, 1);
  _other_nodes = selectNodes(space, is_own, 0);
  internal.skipLattices(space, rows);
}

FreeBricks::Result FreeBricks::step(const exec_space& space, const HexMesh& mesh,
                                    const InternalForce& internal,
                                    const BoundaryConditions& boundary, const TimeSpan& next_drift,
                                    bool drifts, double dt_drift, double dt_kick,
                                    const NodalState& state, const LedgerScales& scales,
                                    const SpeedTest& test) const {
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
                              boundary.during(next_drift),
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
