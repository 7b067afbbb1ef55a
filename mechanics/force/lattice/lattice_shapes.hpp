// Shapes of a lattice's elements for a sweep: one shared shape, or stored shapes, W elements at a
// time. Included by lattice_sweep.hpp only.
#pragma once

#include "contact/base/pack_memory.hpp"
#include "mechanics/force/packs/pack_forces.hpp"

namespace brickwall::mechanics {

// One shared shape. at(layer, p) is {geometry, stiffness} of the elements at p.
template <class Shape>
class SharedShape {
public:
  struct Element {
    const Shape& geometry;
    typename StiffnessOf<Shape>::type stiffness;
  };
  SharedShape(const Shape& shape, const Material& material, const ForceArguments& arguments)
      : _element{shape,
                 stiffnessOf(shape, ElementModuli::of(material), arguments.inverse_quantum)} {}
  KOKKOS_FORCEINLINE_FUNCTION const Element& at(int, int) const { return _element; }

private:
  Element _element;
};

template <int W>
class StoredShapes {
public:
  using Geometry = OnePointGeometry<PackOf<W>>;
  struct Elements {
    Geometry geometry;
    typename StiffnessOf<Geometry>::type stiffness;
  };
  StoredShapes(const BrickLattice& lattice, const Material& material,
               const ForceArguments& arguments)
      : _a(arguments), _moduli(ElementModuli::of(material)), _first_row(lattice.geometry_row),
        _layer_packs(lattice.layerPacks()) {}
  KOKKOS_FORCEINLINE_FUNCTION Elements at(int layer, int p) const {
    const int row = _first_row + layer * _layer_packs + p / W;
    // The whole row is loaded before its first use, so that cache misses overlap. Later rows are
    // prefetched into the second-level cache; the first level holds the buffers of the sweep.
    Elements elements;
    loadGeometry(_a.tables, row, 0, elements.geometry);
    for (int k = 0; k < Geometry::size; ++k)
      prefetchFar(&_a.tables.geometry(row, k, 0) + rows_ahead * Geometry::size * W);
    elements.stiffness = stiffnessOf(elements.geometry, _moduli, _a.inverse_quantum);
    return elements;
  }

private:
  static constexpr int rows_ahead = 6;

  const ForceArguments& _a;
  ElementModuli _moduli;
  int _first_row, _layer_packs;
};

} // namespace brickwall::mechanics
