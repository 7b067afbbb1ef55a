// What a sweep over a lattice keeps between two layers of elements, per thread: small, so that it stays in the first-level
// cache. Host code. Included by brick_sweep.hpp only.
#pragma once

#include "mechanics/brick_lattice.hpp"
#include "mechanics/hex8_modes.hpp"
#include "mechanics/pack.hpp"

namespace brickwall::mechanics {

// In the lanes of one pack of elements.
template <int W>
struct PackBuffers {
  // Forces that the layer below has given to the nodes at its upper face: of the row of each element's first node, and of
  // the row behind, [xyz].
  IntPackOf<W> above[3], below[3];
  IntPackOf<W> is_element; // -1, or 0 at the ends of rows
};

template <int W>
class PlaneBuffers {
public:
  // Numbers that a lattice needs.
  static std::int64_t sizeFor(const BrickLattice& lattice) {
    return 6 * stride(lattice) + 3 * behindStride(lattice) + numPacks(lattice) * numbers_per_pack +
           W;
  }
  PlaneBuffers(double* memory, const BrickLattice& lattice)
      : _row(lattice.rowNodes()), _stride(stride(lattice)), _behind_stride(behindStride(lattice)),
        _displacement(aligned(memory)),
        _behind(reinterpret_cast<std::int64_t*>(_displacement + 6 * _stride)),
        _packs(reinterpret_cast<PackBuffers<W>*>(_behind + 3 * _behind_stride)) {
    memset(memory, 0, sizeFor(lattice) * sizeof(double));
    markElements(lattice);
  }
  // Of a plane of nodes, up to those behind the last pack of elements.
  double* displacement(int plane, int axis) const {
    return _displacement + (plane % 2 * 3 + axis) * _stride;
  }
  PackBuffers<W>& pack(int p) const { return _packs[p / W]; }
  // Complete forces of the elements at p on the nodes of the row behind them.
  std::int64_t* behind(int axis, int p) const {
    return _behind + axis * _behind_stride + firstRow(_row) + p;
  }
  // The same by these nodes; 0 for those of the first row.
  const std::int64_t* atNodes(int axis, int p) const { return behind(axis, p - _row); }

  static int packs(int count) { return (count + W - 1) / W; }
  // Packs of elements in a layer, counting a place at the end of each row.
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
  void markElements(const BrickLattice& lattice) {
    const int slots = _row * lattice.ny, padded = numPacks(lattice) * W;
    int i = 0;
    for (int p = 0; p < padded; ++p) {
      _packs[p / W].is_element.v[p % W] = -static_cast<std::int64_t>(i < lattice.nx && p < slots);
      i = i == lattice.nx ? 0 : i + 1;
    }
  }

  int _row;
  std::int64_t _stride, _behind_stride;
  double* _displacement;
  std::int64_t* _behind;
  PackBuffers<W>* _packs;
};

} // namespace brickwall::mechanics
