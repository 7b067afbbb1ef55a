// A sweep over a lattice of congruent elements, plane by plane of nodes: no connectivity, no geometry per element, no atomic
// additions. Lanes are consecutive nodes p = i + (nx+1) j of a plane; the element whose lowest corner is p goes with them, and
// at the end of a row (i = nx), where there is none, its displacements are masked to zero:
//
//     j=1   n n n n|n         one element in five is none when nx = 4
//     j=0   e e e e|-  ->     p = 0 .. 4, 5 .. 9, ...
//
// Elements are those of the other kernels, bit for bit, and integers add up in any order, so the forces are theirs too.
// Host code. Included by internal_force.cpp and free_bricks.cpp only.
#pragma once

#include "mechanics/brick_lattice.hpp"
#include "mechanics/internal_force_kernel.hpp"
#include "mechanics/lane_sums.hpp"

namespace brickwall::mechanics {

// Two node planes of one thread: displacements, and the forces that elements have given so far.
template <int W>
class PlaneBuffers {
public:
  // Numbers that a lattice needs.
  static std::int64_t sizeFor(const BrickLattice& lattice) { return 2 * 9 * stride(lattice) + W; }
  PlaneBuffers(double* memory, const BrickLattice& lattice)
      : _memory(memory), _stride(stride(lattice)) {
    const auto misaligned = reinterpret_cast<std::uintptr_t>(memory) % (W * sizeof(double));
    if (misaligned != 0)
      _memory += W - misaligned / sizeof(double);
  }
  double* displacement(int plane, int axis) const { return at(plane, axis); }
  // Of the elements in the row of each node, and of those in the row below, told by the node of that row.
  std::int64_t* above(int plane, int axis) const { return integersAt(plane, 3 + axis); }
  std::int64_t* below(int plane, int axis) const { return integersAt(plane, 6 + axis); }
  void clear() const { memset(_memory, 0, 18 * _stride * sizeof(double)); }

  static int packs(int count) { return (count + W - 1) / W; }
  // Where entry 0 of below() stands for node rowNodes(): the entries before are those of the first row, zero.
  static int offset(const BrickLattice& lattice) { return packs(lattice.rowNodes()) * W; }

private:
  static std::int64_t stride(const BrickLattice& lattice) {
    return (packs(lattice.planeNodes()) + packs(lattice.rowNodes() + 1) + 1) * W;
  }
  double* at(int plane, int array) const { return _memory + (plane % 2 * 9 + array) * _stride; }
  std::int64_t* integersAt(int plane, int array) const {
    return reinterpret_cast<std::int64_t*>(at(plane, array));
  }
  double* _memory;
  std::int64_t _stride;
};

// f(0), f(1), f(2) with constants: loops over large bodies would keep arrays out of registers.
template <class F>
KOKKOS_FORCEINLINE_FUNCTION void forAxes(const F& f) {
  f(std::integral_constant<int, 0>());
  f(std::integral_constant<int, 1>());
  f(std::integral_constant<int, 2>());
}

// What the elements of a slab do. `Planes` brings the displacements of a plane and takes its forces:
//   planes.load(plane, buffers), planes.finish(plane, buffers)
template <MaterialModel model, class Shape, int W>
class LatticeSweep {
public:
  using Real = PackOf<W>;
  using Integer = IntPackOf<W>;

  LatticeSweep(const BrickLattice& lattice, const Shape& shape, const Material& material,
               const ForceArguments& arguments, double* memory, ForceSums& sums)
      : _lattice(lattice), _shape(shape),
        _stiffness(stiffnessOf(shape, ElementModuli::of(material), arguments.inverse_quantum)),
        _a(arguments), _buffers(memory, lattice), _sums(sums),
        _scale(SplitScale::of(arguments.energy_scale)) {}

  template <class Planes>
  void run(const LatticeSlab& slab, Planes& planes) {
    const int first = maxOf(slab.first - 1, 0);
    _buffers.clear(); // from then on every layer overwrites what the one before has left
    planes.load(first, _buffers);
    for (int plane = first; plane < slab.last; ++plane) {
      if (plane < _lattice.nz) {
        planes.load(plane + 1, _buffers);
        addLayer(plane, plane >= slab.first);
      }
      if (plane >= slab.first)
        planes.finish(plane, _buffers);
    }
    fold();
  }

private:
  // Elements between planes `layer` and layer + 1; only counted ones are in the sums.
  void addLayer(int layer, bool is_counted) {
    const int slots = _lattice.rowNodes() * _lattice.ny;
    for (int axis = 0; axis < 3; ++axis)
      for (int g = 0; g < 4; ++g)
        _from_left[axis][g].v = typename Integer::vector{};
    int i = 0; // of the pack's first node
    for (int p = 0; p < slots; p += W) {
      addPack(layer, p, i, is_counted);
      i = (i + W) % _lattice.rowNodes();
    }
  }

  void addPack(int layer, int p, int i, bool is_counted) {
    Real u[3][num_modes];
    gatherModes(layer, p, u);
    const bool has_ends = i + W > _lattice.nx || p + W > _lattice.rowNodes() * _lattice.ny;
    Integer is_element;
    if (has_ends) {
      is_element = elementsAmong(p, i);
      for (int axis = 0; axis < 3; ++axis)
        for (int m = 0; m < num_modes; ++m)
          u[axis][m] = masked(u[axis][m], is_element);
    }
    TlpsForces<Real> forces;
    tlpsForces<model>(u, _shape, _stiffness, _a.with_energy, forces);
    Real largest[3];
    forAxes([&](auto axis) { largest[axis] = largestOf(forces.force[axis]); });
    largest[0] = maxMagnitude(largest[1], maxMagnitude(largest[2], largest[0]));
    if (anyBeyond(largest[0], fixed_point_limit / 2) || !allPositive(forces.J)) {
      TlpsForces<Real> copy = forces; // so that the forces themselves stay in registers
      dropFailed(layer, p, is_counted, largest[0], copy);
      forces = copy;
    }
    if (is_counted && _a.with_energy)
      addEnergies(forces);
    scatter(layer, p, forces);
  }

  static KOKKOS_FORCEINLINE_FUNCTION Real largestOf(const Real (&modes)[num_modes]) {
    const Real low =
        maxMagnitude(modes[0], maxMagnitude(modes[1], maxMagnitude(modes[2], Real(0.0))));
    const Real high = maxMagnitude(modes[3], maxMagnitude(modes[4], Real(0.0)));
    return maxMagnitude(modes[5], maxMagnitude(modes[6], maxMagnitude(low, high)));
  }

  KOKKOS_FORCEINLINE_FUNCTION void gatherModes(int layer, int p, Real (&u)[3][num_modes]) const {
    const int row = _lattice.rowNodes();
    forAxes([&](auto axis) {
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
      cornersToModes(corner, u[axis]);
    });
  }

  Integer elementsAmong(int p, int i) const {
    const int slots = _lattice.rowNodes() * _lattice.ny;
    std::int64_t mask[W];
    for (int lane = 0; lane < W; ++lane) {
      mask[lane] = -static_cast<std::int64_t>(i < _lattice.nx && p + lane < slots);
      i = i == _lattice.nx ? 0 : i + 1;
    }
    return loadPack<Integer>(mask);
  }

  // Failed elements give no force and no energy.
  void dropFailed(int layer, int p, bool is_counted, const Real& largest,
                  TlpsForces<Real>& forces) {
    for (int lane = 0; lane < W; ++lane) {
      const int reason = failureReason(forces.J[lane], largest[lane]);
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

  void addEnergies(const TlpsForces<Real>& forces) {
    _energy.add(stored_material, forces.material_energy, _scale);
    _energy.add(stored_hourglass, forces.hourglass_energy, _scale);
    _energy.endRow();
    if (++_rows == LaneSums<num_stored_energies, W>::max_rows)
      fold();
  }
  void fold() {
    const SplitScale* const scales[num_stored_energies] = {&_scale, &_scale};
    constexpr int index[num_stored_energies] = {stored_material, stored_hourglass};
    _energy.foldInto(_sums.energy, index, scales);
    _rows = 0;
  }

  // Corner forces combine along xi in registers: a node takes those of its own element and of the one to its left; then eta
  // and zeta tell rows and planes apart.
  KOKKOS_FORCEINLINE_FUNCTION void scatter(int layer, int p, const TlpsForces<Real>& forces) {
    const int shifted_p = p + PlaneBuffers<W>::offset(_lattice);
    forAxes([&](auto axis) {
      Integer f[num_modes];
      for (int m = 0; m < num_modes; ++m)
        f[m] = toFixedInRange(forces.force[axis][m]);
      Integer(&left)[4] = _from_left[axis];
      const Integer x1 = alongXi(-f[0], f[0], left[0]); // of modes 1, eta, zeta, eta zeta
      const Integer xe = alongXi(f[1] - f[5], f[1] + f[5], left[1]);
      const Integer xz = alongXi(f[2] - f[4], f[2] + f[4], left[2]);
      const Integer xez = alongXi(f[3] - f[6], f[3] + f[6], left[3]);
      const Integer low_even = x1 - xz, low_odd = xe - xez, high_even = x1 + xz,
                    high_odd = xe + xez;
      addTo(_buffers.above(layer, axis) + p, low_even - low_odd);
      addTo(_buffers.below(layer, axis) + shifted_p, low_even + low_odd);
      storePack(high_even - high_odd, _buffers.above(layer + 1, axis) + p);
      storePack(high_even + high_odd, _buffers.below(layer + 1, axis) + shifted_p);
    });
  }
  static Integer alongXi(const Integer& minus, const Integer& plus, Integer& left) {
    const Integer from_left = shiftedIn(left, plus);
    left = plus;
    return minus + from_left;
  }
  static void addTo(std::int64_t* to, const Integer& value) {
    storePack(loadPack<Integer>(to) + value, to);
  }

  const BrickLattice& _lattice;
  const Shape& _shape;
  const typename StiffnessOf<Shape>::type _stiffness;
  const ForceArguments& _a;
  PlaneBuffers<W> _buffers;
  ForceSums& _sums;
  SplitScale _scale;
  Integer _from_left[3][4];
  LaneSums<num_stored_energies, W> _energy;
  int _rows = 0;
};

// The forces of nodes [p, p + W) of a finished plane.
template <int W>
inline IntPackOf<W> planeForce(const PlaneBuffers<W>& buffers, const BrickLattice& lattice,
                               int plane, int axis, int p) {
  using Integer = IntPackOf<W>;
  const int shift = PlaneBuffers<W>::offset(lattice) - lattice.rowNodes();
  return loadPack<Integer>(buffers.above(plane, axis) + p) +
         loadPack<Integer>(buffers.below(plane, axis) + shift + p);
}

// Runs the lattice's sweep for its material and shape.
template <int W, class Planes>
void sweepSlab(const BrickLattice& lattice, const LatticeSlab& slab, const ForceArguments& a,
               double* memory, ForceSums& sums, Planes& planes) {
  const Material material = a.tables.mesh.materials(lattice.block);
  const CongruentShape& shape = a.tables.boxes(lattice.body);
  const auto run = [&](auto model) {
    constexpr MaterialModel m = decltype(model)::value;
    if (shape.is_brick)
      LatticeSweep<m, TlpsBrick, W>(lattice, shape.brick, material, a, memory, sums)
          .run(slab, planes);
    else
      LatticeSweep<m, TlpsBox, W>(lattice, shape.box, material, a, memory, sums).run(slab, planes);
  };
  switch (material.model) {
  case MaterialModel::neo_hookean:
    return run(std::integral_constant<MaterialModel, MaterialModel::neo_hookean>());
  case MaterialModel::svk:
    return run(std::integral_constant<MaterialModel, MaterialModel::svk>());
  default:
    return run(std::integral_constant<MaterialModel, MaterialModel::linear>());
  }
}

} // namespace brickwall::mechanics
