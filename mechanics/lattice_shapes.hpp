// Shapes of a lattice's elements as a sweep reads them: one for all, or stored, W elements at a time. Included by
// brick_sweep.hpp only.
#pragma once

#include "mechanics/internal_force_kernel.hpp"

namespace brickwall::mechanics {

// One shape: with(layer, p, f) calls f(geometry, stiffness) for the elements at p.
template <class Shape>
class SharedShape {
public:
  SharedShape(const Shape& shape, const Material& material, const ForceArguments& arguments)
      : _shape(shape),
        _stiffness(stiffnessOf(shape, ElementModuli::of(material), arguments.inverse_quantum)) {}
  template <class F>
  KOKKOS_FORCEINLINE_FUNCTION void with(int, int, const F& f) const {
    f(_shape, _stiffness);
  }

private:
  const Shape& _shape;
  typename StiffnessOf<Shape>::type _stiffness;
};

template <int W>
class StoredShapes {
public:
  StoredShapes(const BrickLattice& lattice, const Material& material,
               const ForceArguments& arguments)
      : _a(arguments), _moduli(ElementModuli::of(material)), _first_row(lattice.geometry_row),
        _layer_packs(lattice.layerPacks()) {}
  template <class F>
  KOKKOS_FORCEINLINE_FUNCTION void with(int layer, int p, const F& f) const {
    constexpr int size = TlpsGeometry<PackOf<W>>::size;
    const int row = _first_row + layer * _layer_packs + p / W;
    // All at once, before any of it is used: what is not there yet then comes in together; later rows after it.
    TlpsGeometry<PackOf<W>> geometry;
    loadGeometry(_a.tables, row, 0, geometry);
    for (int k = 0; k < size; ++k)
      prefetchLine(&_a.tables.geometry(row, k, 0) + 3 * size * W);
    f(geometry, stiffnessOf(geometry, _moduli, _a.inverse_quantum));
  }

private:
  const ForceArguments& _a;
  ElementModuli _moduli;
  int _first_row, _layer_packs;
};

} // namespace brickwall::mechanics
