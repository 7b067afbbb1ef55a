// Kernels of InternalForce: gather a pack's displacements as modes, evaluate the element, round the modes, add to the
// corners in integers. Included by internal_force.cpp only.
#pragma once

#include "mechanics/internal_force.hpp"

namespace brickwall::mechanics {

using Tables = InternalForce::Tables;

// --- geometry of general elements, [pack][component][lane]

// Visits the numbers of a geometry in storage order.
template <class Real, class Visit>
KOKKOS_INLINE_FUNCTION void visitGeometry(TlpsGeometry<Real>& g, const Visit& visit) {
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
    visit(next++, g.inverse_length[i]);
  visit(next++, g.volume);
}
template <class Real, class Visit>
KOKKOS_INLINE_FUNCTION void visitGeometry(FullGeometry<Real>& g, const Visit& visit) {
  int next = 0;
  for (int j = 0; j < 3; ++j)
    for (int m = 0; m < num_modes; ++m)
      visit(next++, g.X[j][m]);
}

KOKKOS_INLINE_FUNCTION void makeGeometry(const CornerCoordinates& X, TlpsGeometry<double>& g) {
  g = tlpsGeometry(X);
}
KOKKOS_INLINE_FUNCTION void makeGeometry(const CornerCoordinates& X, FullGeometry<double>& g) {
  coordinateModes(X, g.X);
}

template <class GeometryView>
KOKKOS_INLINE_FUNCTION void loadLanes(const GeometryView& stored, int row, int component, int lane,
                                      double& value) {
  value = stored(row, component, lane);
}
template <class GeometryView, int W>
inline void loadLanes(const GeometryView& stored, int row, int component, int, PackOf<W>& value) {
  memcpy(&value.v, &stored(row, component, 0), sizeof value.v);
}

// All lanes for a Pack, the given lane for a double.
template <class Geometry>
KOKKOS_INLINE_FUNCTION void loadGeometry(const Tables& tables, int row, int lane, Geometry& g) {
  visitGeometry(g, [&](int component, auto& value) {
    loadLanes(tables.geometry, row, component, lane, value);
  });
}

template <class Geometry>
struct StoreGeometry {
  Tables tables;
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
        const int row = chunk.geometry_row + p;
        visitGeometry(geometry,
                      [&](int component, double& value) { stored(row, component, lane) = value; });
      }
    }
  }
};
template <class Geometry>
void storeGeometry(const exec_space& space, int num_rows, Tables& tables) {
  tables.geometry = allocate<View<double** [simd_width]>>(
      space, "mechanics::InternalForce::geometry", num_rows, int(Geometry::size));
  Kokkos::parallel_for("mechanics::InternalForce::storeGeometry",
                       over(space, static_cast<std::int64_t>(tables.chunks.extent(0))),
                       StoreGeometry<Geometry>{tables});
  space.fence();
}

// X modes of a parallelepiped about its centre.
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

// --- forces

// Modes of the displacements of the pack's elements, [xyz][mode]; lanes beyond the count repeat the last element.
template <class Real>
KOKKOS_INLINE_FUNCTION void gatherModes(const Tables& tables, const View<const double* [3]>& u,
                                        const ElementPack& pack, Real (&modes)[3][num_modes]) {
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

// One element's corner forces of one force kind: [xyz][corner] in quanta.
template <class Integer>
struct CornerForces {
  Integer value[3][8];
};

template <class Real, class Integer>
KOKKOS_INLINE_FUNCTION void roundToCorners(const Real (&modes)[3][num_modes], Real& largest,
                                           CornerForces<Integer>& corners) {
  for (int i = 0; i < 3; ++i) {
    Integer rounded[num_modes];
    for (int m = 0; m < num_modes; ++m) {
      largest = maxMagnitude(modes[i][m], largest);
      rounded[m] = toFixed(modes[i][m]);
    }
    modesToCorners(rounded, corners.value[i]);
  }
}
template <class Real, class Integer>
KOKKOS_INLINE_FUNCTION void roundToCorners(const Real (&modes)[3][3], Real& largest,
                                           CornerForces<Integer>& corners) {
  for (int i = 0; i < 3; ++i) {
    Integer rounded[3];
    for (int m = 0; m < 3; ++m) {
      largest = maxMagnitude(modes[i][m], largest);
      rounded[m] = toFixed(modes[i][m]);
    }
    linearModesToCorners(rounded, corners.value[i]);
  }
}

struct ForceArguments {
  Tables tables;
  View<const double* [3]> displacement;
  View<std::int64_t**> forces; // [node][3 * kind + xyz]
  double inverse_quantum;
  LimbScale energy_scale;
  int first_chunk;
  bool with_energy;
};

struct ForceSums {
  LimbSums<num_stored_energies> energy;
  ElementFailure failure;
  KOKKOS_INLINE_FUNCTION ForceSums& operator+=(const ForceSums& b) {
    energy += b.energy;
    failure += b.failure;
    return *this;
  }
};

KOKKOS_INLINE_FUNCTION int failureReason(double J, double largest) {
  if (J <= 0)
    return inverted_element;
  if (J != J || largest != largest)
    return not_a_number;
  return fitsFixedPoint(largest) ? no_failure : force_overflow;
}

// A pack's forces and energies, ready to be added.
template <class Real, class Integer, int kinds>
struct PackForces {
  CornerForces<Integer> corners[kinds]; // material, hourglass
  Real energy[kinds];
  Real J;
  Real largest; // magnitude of any mode
};

template <MaterialModel model, class Real, class Integer, class Geometry>
KOKKOS_INLINE_FUNCTION void packForces(const Real (&u)[3][num_modes], const Geometry& geometry,
                                       const ElementModuli& moduli, const ForceArguments& a,
                                       PackForces<Real, Integer, 2>& out) {
  TlpsForces<Real, Geometry> forces;
  tlpsForces<model>(u, geometry, moduli, a.inverse_quantum, a.with_energy, forces);
  out.J = forces.J;
  out.largest = Real(0.0);
  roundToCorners(forces.material, out.largest, out.corners[0]);
  roundToCorners(forces.hourglass, out.largest, out.corners[1]);
  out.energy[0] = forces.material_energy;
  out.energy[1] = forces.hourglass_energy;
}
template <MaterialModel model, class Real, class Integer>
KOKKOS_INLINE_FUNCTION void packForces(const Real (&u)[3][num_modes],
                                       const FullGeometry<Real>& geometry,
                                       const ElementModuli& moduli, const ForceArguments& a,
                                       PackForces<Real, Integer, 1>& out) {
  FullForces<Real> forces;
  fullForces<model>(u, geometry, moduli.lambda, moduli.mu, a.inverse_quantum, a.with_energy,
                    forces);
  out.J = forces.J;
  out.largest = Real(0.0);
  roundToCorners(forces.material, out.largest, out.corners[0]);
  out.energy[0] = forces.material_energy;
}

template <class Integer, int kinds>
KOKKOS_INLINE_FUNCTION void addCorners(const Tables& tables, const View<std::int64_t**>& forces,
                                       const ElementPack& pack, int lane,
                                       const CornerForces<Integer> (&corners)[kinds]) {
  for (int c = 0; c < 8; ++c) {
    const int node = tables.mesh.elem_to_nodes(pack.first + lane, c);
    for (int kind = 0; kind < kinds; ++kind)
      for (int i = 0; i < 3; ++i) {
        std::int64_t* const target = &forces(node, 3 * kind + i);
        const std::int64_t value = laneOf(corners[kind].value[i][c], lane);
        if (pack.atomic)
          Kokkos::atomic_add(target, value);
        else
          *target += value;
      }
  }
}

template <class Real, class Integer, int kinds>
KOKKOS_INLINE_FUNCTION void addPack(const ForceArguments& a, const ElementPack& pack,
                                    const PackForces<Real, Integer, kinds>& forces,
                                    ForceSums& sums) {
  for (int lane = 0; lane < pack.count; ++lane) {
    const int reason = failureReason(laneOf(forces.J, lane), laneOf(forces.largest, lane));
    if (reason != no_failure) {
      sums.failure.add(a.tables.mesh.elem_ids(pack.first + lane), reason);
      continue;
    }
    addCorners(a.tables, a.forces, pack, lane, forces.corners);
    if (a.with_energy)
      for (int kind = 0; kind < kinds; ++kind)
        sums.energy.add(kind, laneOf(forces.energy[kind], lane), a.energy_scale);
  }
}

template <ElementKind kind, MaterialModel model>
struct ForceFunctor {
  static constexpr int kinds = kind == ElementKind::one_point ? 2 : 1;
  ForceArguments a;

  template <class Geometry>
  KOKKOS_INLINE_FUNCTION void onePack(const ElementPack& pack, const Geometry& geometry,
                                      const ElementModuli& moduli, ForceSums& sums) const {
    Lanes u[3][num_modes];
    gatherModes(a.tables, a.displacement, pack, u);
    PackForces<Lanes, IntLanes, kinds> forces;
    packForces<model>(u, geometry, moduli, a, forces);
    addPack(a, pack, forces, sums);
  }

  template <class Geometry>
  KOKKOS_INLINE_FUNCTION void congruent(const ElementChunk& chunk, const Geometry& shape,
                                        const ElementModuli& moduli, ForceSums& sums) const {
    for (int p = 0; p < chunk.num_packs; ++p)
      onePack(a.tables.packs(chunk.first_pack + p), shape, moduli, sums);
  }
  template <class Geometry>
  KOKKOS_INLINE_FUNCTION void general(const ElementChunk& chunk, const ElementModuli& moduli,
                                      ForceSums& sums) const {
    for (int p = 0; p < chunk.num_packs; ++p) {
      Geometry geometry;
      loadGeometry(a.tables, chunk.geometry_row + p, 0, geometry);
      onePack(a.tables.packs(chunk.first_pack + p), geometry, moduli, sums);
    }
  }

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t c, ForceSums& sums) const {
    const ElementChunk chunk = a.tables.chunks(a.first_chunk + c);
    const ElementModuli moduli = ElementModuli::of(a.tables.mesh.materials(chunk.block));
    if constexpr (kind == ElementKind::one_point) {
      if (chunk.shape >= 0)
        congruent(chunk, a.tables.boxes(chunk.shape), moduli, sums);
      else
        general<TlpsGeometry<Lanes>>(chunk, moduli, sums);
    } else {
      if (chunk.shape >= 0)
        congruent(chunk, inAllLanes<Lanes>(a.tables.full_shapes(chunk.shape)), moduli, sums);
      else
        general<FullGeometry<Lanes>>(chunk, moduli, sums);
    }
  }
};

template <ElementKind kind, MaterialModel model>
ForceSums launchForces(const exec_space& space, const ChunkGroup& group, const ForceArguments& a) {
  ForceSums sums;
  Kokkos::parallel_reduce("mechanics::internalForce::elements", over(space, group.count),
                          ForceFunctor<kind, model>{a}, Combine<ForceSums>(sums));
  space.fence();
  return sums;
}
template <ElementKind kind>
ForceSums launchForces(const exec_space& space, const ChunkGroup& group, const ForceArguments& a) {
  switch (group.model) {
  case MaterialModel::neo_hookean:
    return launchForces<kind, MaterialModel::neo_hookean>(space, group, a);
  case MaterialModel::svk:
    return launchForces<kind, MaterialModel::svk>(space, group, a);
  default:
    return launchForces<kind, MaterialModel::linear>(space, group, a);
  }
}

// --- output fields, one element at a time

template <class Geometry>
KOKKOS_INLINE_FUNCTION double storedEnergy(const double (&u)[3][num_modes],
                                           const Geometry& geometry, const Material& material) {
  TlpsForces<double, Geometry> forces;
  const ElementModuli moduli = ElementModuli::of(material);
  if (material.model == MaterialModel::neo_hookean)
    tlpsForces<MaterialModel::neo_hookean>(u, geometry, moduli, 1.0, true, forces);
  else if (material.model == MaterialModel::svk)
    tlpsForces<MaterialModel::svk>(u, geometry, moduli, 1.0, true, forces);
  else
    tlpsForces<MaterialModel::linear>(u, geometry, moduli, 1.0, true, forces);
  return forces.material_energy + forces.hourglass_energy;
}
KOKKOS_INLINE_FUNCTION double storedEnergy(const double (&u)[3][num_modes],
                                           const FullGeometry<double>& geometry,
                                           const Material& material) {
  FullForces<double> forces;
  const double lambda = material.lambda(), mu = material.mu();
  if (material.model == MaterialModel::neo_hookean)
    fullForces<MaterialModel::neo_hookean>(u, geometry, lambda, mu, 1.0, true, forces);
  else if (material.model == MaterialModel::svk)
    fullForces<MaterialModel::svk>(u, geometry, lambda, mu, 1.0, true, forces);
  else
    fullForces<MaterialModel::linear>(u, geometry, lambda, mu, 1.0, true, forces);
  return forces.material_energy;
}

// Mean Cauchy stress over the integration points, and the reference volume.
template <class Geometry>
KOKKOS_INLINE_FUNCTION double meanStress(const double (&u)[3][num_modes], const Geometry& geometry,
                                         const Material& material, double (&sigma)[6]) {
  double H[3][3];
  meanGradient(u, geometry, H);
  cauchyStress(H, material, sigma);
  return geometry.volume;
}
KOKKOS_INLINE_FUNCTION double meanStress(const double (&u)[3][num_modes],
                                         const FullGeometry<double>& geometry,
                                         const Material& material, double (&sigma)[6]) {
  double volume = 0;
  for (int k = 0; k < 6; ++k)
    sigma[k] = 0;
  for (int p = 0; p < 8; ++p) {
    double xi[3], H[3][3], C[3][3], D, at_point[6];
    gaussPoint(p, xi);
    pointGradient(u, geometry, xi, H, C, D);
    cauchyStress(H, material, at_point);
    for (int k = 0; k < 6; ++k)
      sigma[k] += 0.125 * at_point[k];
    volume += D / 512;
  }
  return volume;
}

template <ElementKind kind>
struct FieldFunctor {
  Tables tables;
  View<const double* [3]> displacement;
  ElementFields fields;

  template <class Geometry>
  KOKKOS_INLINE_FUNCTION void oneElement(int elem, const Geometry& geometry,
                                         const Material& material) const {
    double u[3][num_modes], sigma[6];
    gatherModes(tables, displacement, ElementPack{elem, 1, 0}, u);
    const double volume = meanStress(u, geometry, material, sigma);
    for (int k = 0; k < 6; ++k)
      fields.stress(elem, k) = sigma[k];
    fields.pressure(elem) = -(sigma[0] + sigma[1] + sigma[2]) / 3;
    fields.energy_density(elem) = storedEnergy(u, geometry, material) / volume;
  }

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t c) const {
    const ElementChunk chunk = tables.chunks(c);
    const Material material = tables.mesh.materials(chunk.block);
    for (int p = 0; p < chunk.num_packs; ++p) {
      const ElementPack pack = tables.packs(chunk.first_pack + p);
      for (int lane = 0; lane < pack.count; ++lane)
        fieldsOf(chunk, chunk.geometry_row + p, pack.first + lane, lane, material);
    }
  }
  KOKKOS_INLINE_FUNCTION void fieldsOf(const ElementChunk& chunk, int row, int elem, int lane,
                                       const Material& material) const {
    if constexpr (kind == ElementKind::one_point) {
      if (chunk.shape >= 0) {
        oneElement(elem, tables.boxes(chunk.shape), material);
      } else {
        TlpsGeometry<double> geometry;
        loadGeometry(tables, row, lane, geometry);
        oneElement(elem, geometry, material);
      }
    } else {
      if (chunk.shape >= 0) {
        oneElement(elem, tables.full_shapes(chunk.shape), material);
      } else {
        FullGeometry<double> geometry;
        loadGeometry(tables, row, lane, geometry);
        oneElement(elem, geometry, material);
      }
    }
  }
};

} // namespace brickwall::mechanics
