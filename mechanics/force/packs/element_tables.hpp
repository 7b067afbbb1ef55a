// Tables that the element kernels read: stored geometry of general elements,
// [pack][component][lane], and shapes of congruent bodies; and the functions that load geometry and
// displacements from them.
#pragma once

#include "contact/base/pack.hpp"
#include "mechanics/element/hex8_full.hpp"
#include "mechanics/element/hex8_one_point.hpp"
#include "mechanics/force/packs/element_chunks.hpp"

#include <cstring>

namespace brickwall::mechanics {

enum class ElementKind { one_point, full };

// Stored energies of elements.
enum StoredEnergy : int { stored_material, stored_hourglass, num_stored_energies };

// Element output fields; rows [0, num_elems) are valid.
struct ElementFields {
  // Cauchy stress, mean over the integration points [elem][xx yy zz xy yz zx], pressure
  View<double* [6]> stress;
  View<double*> pressure; // -tr(stress)/3
  View<double*> stored_energy; // including hourglass energy
  View<double*> energy_density; // stored energy per reference volume
};

// The shape of a congruent body's elements.
struct CongruentShape {
  bool is_brick = false;
  OnePointBrick brick;
  OnePointBox box;
  static CongruentShape of(const Mat3& jacobian) {
    CongruentShape shape;
    shape.is_brick = isOnePointBrick(jacobian);
    shape.box = onePointBox(jacobian);
    if (shape.is_brick)
      shape.brick = onePointBrick(jacobian);
    return shape;
  }
};

// Input of all element kernels.
struct ElementTables {
  MeshViews mesh;
  int num_elems = 0;
  View<ElementChunk*> chunks;
  View<ElementPack*> packs;
  View<CongruentShape*> boxes; // [body], one-point; rows of congruent bodies are set
  // [body], full integration; rows of congruent bodies are set
  View<FullGeometry<double>*> full_shapes;
  // [pack][component][lane] of OnePointGeometry or FullGeometry
  View<double** [simd_width]> geometry;
  View<BrickLattice*> lattices;
};

// Visits the numbers of a geometry in the order of storage.
template <class Real, class Visit>
KOKKOS_INLINE_FUNCTION void visitGeometry(OnePointGeometry<Real>& g, const Visit& visit) {
  int next = 0;
  for (int m = 0; m < num_modes; ++m)
    for (int j = 0; j < 3; ++j)
      visit(next++, g.B[m][j]);
  for (int a = 0; a < num_hourglass_modes; ++a)
    for (int j = 0; j < 3; ++j)
      visit(next++, g.M[a][j]);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      visit(next++, g.Q[i][j]);
  for (int i = 0; i < 3; ++i)
    visit(next++, g.thinness[i]);
  visit(next++, g.volume);
}
template <class Real, class Visit>
KOKKOS_INLINE_FUNCTION void visitGeometry(FullGeometry<Real>& g, const Visit& visit) {
  int next = 0;
  for (int j = 0; j < 3; ++j)
    for (int m = 0; m < num_modes; ++m)
      visit(next++, g.X[j][m]);
}

KOKKOS_INLINE_FUNCTION void makeGeometry(const CornerCoordinates& X, OnePointGeometry<double>& g) {
  g = onePointGeometry(X);
}
KOKKOS_INLINE_FUNCTION void makeGeometry(const CornerCoordinates& X, FullGeometry<double>& g) {
  coordinateModes(X, g.X);
}

template <class GeometryView>
KOKKOS_INLINE_FUNCTION void loadComponent(const GeometryView& stored, int row, int component,
                                          int lane, double& value) {
  value = stored(row, component, lane);
}
template <class GeometryView, int W>
inline void loadComponent(const GeometryView& stored, int row, int component, int,
                          PackOf<W>& value) {
  memcpy(&value.v, &stored(row, component, 0), sizeof value.v);
}

// Loads all lanes into a Pack, or one lane into a double.
template <class Geometry>
KOKKOS_INLINE_FUNCTION void loadGeometry(const ElementTables& tables, int row, int lane,
                                         Geometry& g) {
  visitGeometry(g, [&](int component, auto& value) {
    loadComponent(tables.geometry, row, component, lane, value);
  });
}

// Place of the geometry of an element in pack p of a chunk that is not congruent.
KOKKOS_INLINE_FUNCTION GeometryPlace geometryPlace(const ElementTables& tables,
                                                   const ElementChunk& chunk, int p, int lane,
                                                   int elem) {
  if (chunk.lattice >= 0)
    return tables.lattices(chunk.lattice).geometryPlace(elem);
  return {chunk.geometry_row + p, lane};
}
// Loads all lanes of a pack of a chunk; lanes beyond the count repeat the last element.
template <class Geometry>
KOKKOS_INLINE_FUNCTION void loadPackGeometry(const ElementTables& tables, const ElementChunk& chunk,
                                             int p, const ElementPack& pack, Geometry& g) {
  if (chunk.lattice < 0) {
    loadGeometry(tables, chunk.geometry_row + p, 0, g);
    return;
  }
  for (int lane = 0; lane < simd_width; ++lane) {
    const int elem = pack.first + minOf(lane, pack.count - 1);
    const GeometryPlace place = geometryPlace(tables, chunk, p, lane, elem);
    visitGeometry(g, [&](int component, auto& value) {
      setLane(value, lane, tables.geometry(place.row, component, place.lane));
    });
  }
}

template <class Geometry>
struct StoreGeometry {
  ElementTables tables;
  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t c) const {
    const ElementChunk chunk = tables.chunks(c);
    if (chunk.shape >= 0)
      return;
    for (int p = 0; p < chunk.num_packs; ++p) {
      const ElementPack pack = tables.packs(chunk.first_pack + p);
      for (int lane = 0; lane < simd_width; ++lane) {
        CornerCoordinates X;
        Geometry geometry;
        const int elem = pack.first + minOf(lane, pack.count - 1);
        gatherCorners(tables.mesh.elem_to_nodes, tables.mesh.reference_coordinates, elem, X);
        makeGeometry(X, geometry);
        const auto stored = tables.geometry;
        const GeometryPlace place = geometryPlace(tables, chunk, p, lane, elem);
        visitGeometry(geometry, [&](int component, double& value) {
          stored(place.row, component, place.lane) = value;
        });
      }
    }
  }
};
template <class Geometry>
void storeGeometry(const exec_space& space, int num_rows, ElementTables& tables) {
  tables.geometry = View<double** [simd_width]>("mechanics::InternalForce::geometry", num_rows,
                                                // rows of lattices without an element stay zero
                                                int(Geometry::size));
  Kokkos::parallel_for("mechanics::InternalForce::storeGeometry",
                       rangePolicy(space, static_cast<std::int64_t>(tables.chunks.extent(0))),
                       StoreGeometry<Geometry>{tables});
  space.fence();
}

// Modes of the coordinates of a parallelepiped relative to its centre.
inline FullGeometry<double> fullShape(const Mat3& jacobian) {
  FullGeometry<double> shape;
  for (int j = 0; j < 3; ++j)
    for (int m = 0; m < num_modes; ++m)
      shape.X[j][m] = m < 3 ? 8 * jacobian(j, m < 3 ? m : 0) : 0.0;
  return shape;
}
template <class Real>
KOKKOS_INLINE_FUNCTION FullGeometry<Real> inAllLanes(const FullGeometry<double>& shape) {
  FullGeometry<Real> result;
  for (int j = 0; j < 3; ++j)
    for (int m = 0; m < num_modes; ++m)
      result.X[j][m] = Real(shape.X[j][m]);
  return result;
}

// Modes of the displacements of the pack's elements, [xyz][mode]; lanes beyond the count repeat the
// last element.
template <class Real>
KOKKOS_INLINE_FUNCTION void gatherModes(const ElementTables& tables,
                                        const View<const double* [3]>& u, const ElementPack& pack,
                                        Real (&modes)[3][num_modes]) {
  constexpr int width = NumLanes<Real>::value;
  Real corner[3][8];
  for (int lane = 0; lane < width; ++lane) {
    const int elem = pack.first + minOf(lane, pack.count - 1);
    for (int c = 0; c < 8; ++c) {
      const int node = tables.mesh.elem_to_nodes(elem, c);
      for (int i = 0; i < 3; ++i)
        setLane(corner[i][c], lane, u(node, i));
    }
  }
  for (int i = 0; i < 3; ++i)
    cornersToModes(corner[i], modes[i]);
}

} // namespace brickwall::mechanics
