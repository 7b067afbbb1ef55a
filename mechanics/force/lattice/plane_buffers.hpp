// Buffers of a sweep over a lattice between two layers of elements, per thread. They are small
// enough for the first-level cache. Host code. Included by lattice_sweep.hpp only.
#pragma once

#include "contact/base/pack_memory.hpp"
#include "contact/base/pack_rounding.hpp"
#include "mechanics/element/hex8_modes.hpp"
#include "mechanics/mesh/brick_lattice.hpp"

namespace brickwall::mechanics {

// Rounded forces keep the shift S of their rounding (Rounding::shifted), modulo 2^64. A sum of
// forces contains S once for each modal force with a plus sign, less once for each with a minus
// sign. In the sum over all eight elements of a node, where missing elements count as forces of
// zero, the shifts cancel.
template <int W>
struct SumShift {
  static IntPackOf<W> times(std::int64_t count) {
    return typename IntPackOf<W>::vector{} +
           static_cast<std::int64_t>(static_cast<std::uint64_t>(count) * Rounding<W>::shift_bits);
  }
  static IntPackOf<W> above() { return times(-2); }
  static IntPackOf<W> below() { return times(6); }
  static IntPackOf<W> behind() { return times(4); }
};

// Sums of forces of the elements to the left, in the lanes of the nodes on their right: on modes 1,
// eta, zeta, eta zeta of the shared faces.
template <int W>
struct FromLeft {
  IntPackOf<W> sum[4];
  static FromLeft none() {
    const IntPackOf<W> one = SumShift<W>::times(1), two = SumShift<W>::times(2);
    return {{one, two, two, two}};
  }
};

// Forces of the layer below on the nodes at its upper face, in the lanes of one pack of elements:
// `above` for the row of each element's first node, `below` for the next row, [xyz].
template <int W>
struct PackBuffers {
  IntPackOf<W> above[3], below[3];
};

template <int W>
class PlaneBuffers {
public:
  // Numbers of memory that a lattice needs.
  static std::int64_t sizeFor(const BrickLattice& lattice) {
    return 6 * stride(lattice) + 3 * behindStride(lattice) +
           numPacks(lattice) * (2 * numbers_per_pack + W) + W;
  }
  PlaneBuffers(double* memory, const BrickLattice& lattice)
      : _row(lattice.rowNodes()), _stride(stride(lattice)), _behind_stride(behindStride(lattice)),
        _displacement(aligned(memory)),
        _behind(reinterpret_cast<std::int64_t*>(_displacement + 6 * _stride)),
        _packs(reinterpret_cast<PackBuffers<W>*>(_behind + 3 * _behind_stride)),
        _is_element(reinterpret_cast<MaskPackOf<W>*>(_packs + 2 * numPacks(lattice))) {
    clearTails(lattice);
    clearForces(lattice);
    markElements(lattice);
  }
  // Displacements of a plane of nodes, up to those after the last pack of elements.
  double* displacement(int plane, int axis) const {
    return _displacement + (plane % 2 * 3 + axis) * _stride;
  }
  // Forces on the nodes of a plane from the layer below.
  PackBuffers<W>& pack(int plane, int p) const { return _packs[p / W * 2 + plane % 2]; }
  // False at the ends of rows.
  const MaskPackOf<W>& isElement(int p) const { return _is_element[p / W]; }
  // Complete forces of the elements at p on the nodes of the next row.
  std::int64_t* behind(int axis, int p) const {
    return _behind + axis * _behind_stride + firstRow(_row) + p;
  }
  // The same addressed by these nodes; zero for those of the first row.
  const std::int64_t* atNodes(int axis, int p) const { return behind(axis, p - _row); }

  static int packs(int count) { return dividedUp(count, W); }
  // Packs of elements in a layer, including one place at the end of each row.
  static int numPacks(const BrickLattice& lattice) {
    return packs(lattice.rowNodes() * lattice.ny);
  }

private:
  static constexpr int numbers_per_pack = sizeof(PackBuffers<W>) / sizeof(double);

  static double* aligned(double* memory) {
    const auto misaligned = reinterpret_cast<std::uintptr_t>(memory) % (W * sizeof(double));
    return misaligned == 0 ? memory : memory + (W - misaligned / sizeof(double));
  }
  static int firstRow(int row) { return packs(row) * W; }
  static std::int64_t stride(const BrickLattice& lattice) {
    return (packs(lattice.planeNodes()) + packs(lattice.rowNodes() + 1) + 1) * W;
  }
  static std::int64_t behindStride(const BrickLattice& lattice) {
    return firstRow(lattice.rowNodes()) + (packs(lattice.planeNodes()) + 1) * W;
  }
  // The memory after the displacements of a plane is read and then masked.
  void clearTails(const BrickLattice& lattice) const {
    for (int row = 0; row < 6; ++row)
      for (int p = lattice.planeNodes(); p < _stride; ++p)
        _displacement[row * _stride + p] = 0;
  }
  void clearForces(const BrickLattice& lattice) const {
    for (int k = 0; k < 3 * _behind_stride; k += W)
      storePack(SumShift<W>::behind(), _behind + k);
    for (int k = 0; k < 2 * numPacks(lattice); ++k)
      for (int axis = 0; axis < 3; ++axis) {
        _packs[k].above[axis] = SumShift<W>::above();
        _packs[k].below[axis] = SumShift<W>::below();
      }
  }
  void markElements(const BrickLattice& lattice) const {
    const int slots = _row * lattice.ny, padded = numPacks(lattice) * W;
    int i = 0;
    for (int p = 0; p < padded; ++p) {
      _is_element[p / W].v[p % W] = -static_cast<std::int64_t>(i < lattice.nx && p < slots);
      i = i == lattice.nx ? 0 : i + 1;
    }
  }

  int _row;
  std::int64_t _stride, _behind_stride;
  double* _displacement;
  std::int64_t* _behind;
  PackBuffers<W>* _packs;
  MaskPackOf<W>* _is_element;
};

} // namespace brickwall::mechanics
