// A sweep over a lattice of elements, plane by plane of nodes, without connectivity and atomic
// additions. Lanes are consecutive nodes p = i + (nx+1) j of a plane. The element whose lowest
// corner is p shares its lane; at the end of a row (i = nx) there is no element, and the
// displacements are masked to zero:
//     j=1   n n n n|n         one lane in five has no element if nx = 4
//     j=0   e e e e|-  ->     p = 0 .. 4, 5 .. 9, ...
// The element functions are those of pack_forces.cpp, and integer sums do not depend on the order,
// so the forces have the same bits. Host code.
#pragma once

#include "contact/base/lane_sums.hpp"
#include "mechanics/force/lattice/lattice_shapes.hpp"
#include "mechanics/force/lattice/plane_buffers.hpp"

namespace brickwall::mechanics {

// The sweep over the elements of a slab. `Planes` provides the displacements of a plane and
// receives its forces, W nodes at a time:
//   planes.load(plane, buffers), planes.finish(plane, p, forces), Planes::always_with_energy
template <MaterialModel model, class Shapes, int W>
class LatticeSweep {
public:
  using Real = PackOf<W>;
  using Integer = IntPackOf<W>;

  LatticeSweep(const BrickLattice& lattice, const Shapes& shapes, const ForceArguments& arguments,
               double* memory, ForceSums& sums)
      : _lattice(lattice), _shapes(shapes), _a(arguments), _buffers(memory, lattice), _sums(sums),
        _scale(SplitScale::of(arguments.energy_scale)) {}

  template <class Planes>
  void run(const LatticeSlab& slab, Planes& planes) {
    const int first = maxOf(slab.first - 1, 0);
    planes.load(first, _buffers);
    for (int plane = first; plane < slab.last; ++plane) {
      const bool has_layer = plane < _lattice.nz;
      if (has_layer)
        planes.load(plane + 1, _buffers);
      if (plane < slab.first)
        addLayer<false, false>(plane, planes);
      else if (!has_layer)
        finishLast(plane, planes);
      else if (Planes::always_with_energy || _a.with_energy)
        addLayer<true, true>(plane, planes);
      else if constexpr (!Planes::always_with_energy)
        addLayer<true, false>(plane, planes);
    }
    fold();
  }

private:
  int numPacks() const { return PlaneBuffers<W>::numPacks(_lattice); }

  // Elements between planes `layer` and layer + 1. Those of another slab (not is_counted) only
  // contribute the forces on their upper faces.
  template <bool is_counted, bool with_energy, class Planes>
  void addLayer(int layer, Planes& planes) {
    for (int axis = 0; axis < 3; ++axis)
      _from_left[0][axis] = FromLeft<W>::none();
    const int slots = numPacks() * W;
    for (int p = 0; p < slots; p += W) {
      Integer force[3];
      addPack<is_counted, with_energy>(layer, p, force);
      if (is_counted)
        planes.finish(layer, p, force);
    }
    if (is_counted)
      for (int p = slots; p < _lattice.planeNodes(); p += W) {
        Integer force[3];
        for (int axis = 0; axis < 3; ++axis)
          force[axis] = loadPack<Integer>(_buffers.atNodes(axis, p)) - Shift::behind();
        planes.finish(layer, p, force);
      }
  }
  // The uppermost plane, which has no elements above it.
  template <class Planes>
  void finishLast(int plane, Planes& planes) {
    const int slots = numPacks() * W;
    for (int p = 0; p < slots; p += W)
      for (int axis = 0; axis < 3; ++axis)
        storePack(_buffers.pack(plane, p).below[axis] + (Shift::behind() - Shift::below()),
                  _buffers.behind(axis, p));
    for (int p = 0; p < _lattice.planeNodes(); p += W) {
      Integer force[3];
      for (int axis = 0; axis < 3; ++axis) {
        force[axis] = loadPack<Integer>(_buffers.atNodes(axis, p)) - Shift::behind();
        if (p < slots)
          force[axis] = force[axis] + (_buffers.pack(plane, p).above[axis] - Shift::above());
      }
      planes.finish(plane, p, force);
    }
  }

  // Rounds the forces on an axis and scatters them before those of the next axis are computed.
  struct TakeForces {
    LatticeSweep& sweep;
    int layer, p;
    Rounding<W>& rounded;
    Integer (&force)[3];
    KOKKOS_FORCEINLINE_FUNCTION void operator()(int axis, const Real (&forces)[num_modes]) const {
      Integer f[num_modes];
      for (int m = 0; m < num_modes; ++m)
        f[m] = rounded.shifted(forces[m]);
      sweep.scatter(layer, p, axis, f, force[axis]);
    }
  };
  // The elements at p. `force` receives the total force on nodes [p, p + W) of the lower plane.
  template <bool is_counted, bool with_energy>
  KOKKOS_FORCEINLINE_FUNCTION void addPack(int layer, int p, Integer (&force)[3]) {
    Real u[3][num_modes];
    gatherModes(layer, p, u);
    OnePointPoint<Real> point;
    Rounding<W> rounded;
    const auto& shape = _shapes.at(layer, p);
    onePointForcesByAxis<model, VolumeChange::small>(
        u, shape.geometry, shape.stiffness, with_energy,
        TakeForces{*this, layer, p, rounded, force}, point);
    rounded.need(isWithin(point.J - 1.0, small_volume_change<model>));
    if (__builtin_expect(!rounded.isGood(), 0)) {
      addUnusualPack(layer, p, is_counted, with_energy, force);
      return;
    }
    if (with_energy)
      addEnergies(point.material_energy, point.hourglass_energy);
  }

  KOKKOS_FORCEINLINE_FUNCTION void gatherModes(int layer, int p, Real (&u)[3][num_modes]) const {
    gatherModes(layer, p, 0, u[0]);
    gatherModes(layer, p, 1, u[1]);
    gatherModes(layer, p, 2, u[2]);
  }
  KOKKOS_FORCEINLINE_FUNCTION void gatherModes(int layer, int p, int axis,
                                               Real (&u)[num_modes]) const {
    const int row = _lattice.rowNodes();
    const double* const low = _buffers.displacement(layer, axis) + p;
    const double* const high = _buffers.displacement(layer + 1, axis) + p;
    const Real corner[8] = {loadPack<Real>(low),
                            loadPack<Real>(low + 1),
                            loadPack<Real>(low + row + 1),
                            loadPack<Real>(low + row),
                            loadPack<Real>(high),
                            loadPack<Real>(high + 1),
                            loadPack<Real>(high + row + 1),
                            loadPack<Real>(high + row)};
    cornersToModes(corner, u);
    const auto& is_element = _buffers.isElement(p);
    for (int m = 0; m < num_modes; ++m)
      u[m] = whereOrZero(is_element, u[m]);
  }

  // Repeats a pack in which elements deform strongly or fail, with all tests. Failed elements give
  // no force and no energy.
  __attribute__((noinline)) void addUnusualPack(int layer, int p, bool is_counted, bool with_energy,
                                                Integer (&force)[3]) {
    Real u[3][num_modes];
    gatherModes(layer, p, u);
    OnePointForces<Real> forces;
    const auto& shape = _shapes.at(layer, p);
    onePointForces<model>(u, shape.geometry, shape.stiffness, with_energy, forces);
    dropFailed(layer, p, is_counted, forces);
    if (with_energy)
      addEnergies(forces.material_energy, forces.hourglass_energy);
    for (int axis = 0; axis < 3; ++axis) {
      Integer f[num_modes];
      for (int m = 0; m < num_modes; ++m)
        f[m] = toFixed(forces.force[axis][m]) + Rounding<W>::shift();
      scatter(layer, p, axis, f, force[axis]);
    }
  }

  void dropFailed(int layer, int p, bool is_counted, OnePointForces<Real>& forces) {
    for (int lane = 0; lane < W; ++lane) {
      double largest = 0;
      for (int axis = 0; axis < 3; ++axis)
        for (int m = 0; m < num_modes; ++m)
          largest = maxMagnitude(forces.force[axis][m][lane], largest);
      const int reason = failureReason(forces.J[lane], largest);
      if (reason == no_failure)
        continue;
      for (int axis = 0; axis < 3; ++axis)
        for (int m = 0; m < num_modes; ++m)
          setLane(forces.force[axis][m], lane, 0.0);
      setLane(forces.material_energy, lane, 0.0);
      setLane(forces.hourglass_energy, lane, 0.0);
      const int j = (p + lane) / _lattice.rowNodes(), i = (p + lane) % _lattice.rowNodes();
      const int elem = _lattice.first_elem + i + _lattice.nx * (j + _lattice.ny * layer);
      if (is_counted)
        _sums.failure.add(_a.tables.mesh.elem_ids(elem), reason);
    }
  }

  KOKKOS_FORCEINLINE_FUNCTION void addEnergies(const Real& material, const Real& hourglass) {
    _energy.add(stored_material, material, _scale);
    _energy.add(stored_hourglass, hourglass, _scale);
    _energy.endRow();
    if (++_rows == LaneSums<num_stored_energies, W>::max_rows)
      fold();
  }
  __attribute__((noinline)) void fold() {
    const SplitScale* const scales[num_stored_energies] = {&_scale, &_scale};
    constexpr int index[num_stored_energies] = {stored_material, stored_hourglass};
    _energy.foldInto(_sums.energy, index, scales);
    _rows = 0;
  }

  // Corner forces combine along xi in registers: a node takes those of its own element and of its
  // left neighbour. Rows and planes then separate eta and zeta. Each of `f` is a force plus
  // Rounding::shift(). Nothing is overwritten that addUnusualPack() reads.
  KOKKOS_FORCEINLINE_FUNCTION void scatter(int layer, int p, int axis,
                                           const Integer (&f)[num_modes], Integer& force) {
    const FromLeft<W>& left = _from_left[p / W % 2][axis];
    FromLeft<W>& next = _from_left[1 - p / W % 2][axis];
    // modes 1, eta, zeta, eta zeta
    const Integer x1 = alongXi(-f[0], f[0], left.sum[0], next.sum[0]);
    const Integer xe = alongXi(f[1] - f[5], f[1] + f[5], left.sum[1], next.sum[1]);
    const Integer xz = alongXi(f[2] - f[4], f[2] + f[4], left.sum[2], next.sum[2]);
    const Integer xez = alongXi(f[3] - f[6], f[3] + f[6], left.sum[3], next.sum[3]);
    const Integer low_even = x1 - xz, low_odd = xe - xez, high_even = x1 + xz, high_odd = xe + xez;
    const PackBuffers<W>& lower = _buffers.pack(layer, p);
    PackBuffers<W>& upper = _buffers.pack(layer + 1, p);
    storePack(lower.below[axis] + (low_even + low_odd), _buffers.behind(axis, p));
    force =
        (lower.above[axis] + (low_even - low_odd)) + loadPack<Integer>(_buffers.atNodes(axis, p));
    upper.above[axis] = high_even - high_odd;
    upper.below[axis] = high_even + high_odd;
  }
  static KOKKOS_FORCEINLINE_FUNCTION Integer alongXi(const Integer& minus, const Integer& plus,
                                                     const Integer& left, Integer& next) {
    next = plus;
    return minus + shiftedIn(left, plus);
  }
  using Shift = SumShift<W>;
  const BrickLattice& _lattice;
  const Shapes _shapes;
  const ForceArguments& _a;
  PlaneBuffers<W> _buffers;
  ForceSums& _sums;
  SplitScale _scale;
  FromLeft<W> _from_left[2][3]; // of even and odd packs, [xyz]
  LaneSums<num_stored_energies, W> _energy;
  int _rows = 0;
};

template <class Sweep, class Planes>
void runSweep(Sweep& sweep, const LatticeSlab& slab, Planes& planes) {
  sweep.run(slab, planes);
}

// Runs the sweep of a slab for the shape of the lattice's elements, whose material model is
// `model`. Each model is instantiated in a file of its own to keep compile times short.
template <MaterialModel model, int W, template <int> class PlanesOf>
void sweepModel(const BrickLattice& lattice, const LatticeSlab& slab, const ForceArguments& a,
                double* memory, ForceSums& sums, PlanesOf<W>& planes) {
  if constexpr (W > 1) { // devices have no packs
    const Material material = a.tables.mesh.materials(lattice.block);
    const CongruentShape& shape = a.tables.boxes(lattice.body);
    const auto run = [&](const auto& shapes) {
      LatticeSweep<model, std::decay_t<decltype(shapes)>, W> sweep(lattice, shapes, a, memory,
                                                                   sums);
      runSweep(sweep, slab, planes);
    };
    if (lattice.geometry_row >= 0)
      run(StoredShapes<W>(lattice, material, a));
    else if (shape.is_brick)
      run(SharedShape<OnePointBrick>(shape.brick, material, a));
    else
      run(SharedShape<OnePointBox>(shape.box, material, a));
  }
}

template <int W, template <int> class PlanesOf>
void sweepSlab(const BrickLattice& lattice, const LatticeSlab& slab, const ForceArguments& a,
               double* memory, ForceSums& sums, PlanesOf<W>& planes) {
  switch (a.tables.mesh.materials(lattice.block).model) {
  case MaterialModel::neo_hookean:
    return sweepModel<MaterialModel::neo_hookean>(lattice, slab, a, memory, sums, planes);
  case MaterialModel::svk:
    return sweepModel<MaterialModel::svk>(lattice, slab, a, memory, sums, planes);
  default:
    return sweepModel<MaterialModel::linear>(lattice, slab, a, memory, sums, planes);
  }
}

} // namespace brickwall::mechanics
