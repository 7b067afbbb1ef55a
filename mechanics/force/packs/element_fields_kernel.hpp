// Kernel of the output fields of InternalForce, one element at a time: mean Cauchy stress and
// stored energy. Included by internal_force.cpp only.
#pragma once

#include "mechanics/force/packs/element_tables.hpp"

namespace brickwall::mechanics {

template <class Geometry>
KOKKOS_INLINE_FUNCTION double storedEnergy(const double (&u)[3][num_modes],
                                           const Geometry& geometry, const Material& material) {
  OnePointForces<double> forces;
  const auto stiffness = stiffnessOf(geometry, ElementModuli::of(material), 1.0);
  if (material.model == MaterialModel::neo_hookean)
    onePointForces<MaterialModel::neo_hookean>(u, geometry, stiffness, true, forces);
  else if (material.model == MaterialModel::svk)
    onePointForces<MaterialModel::svk>(u, geometry, stiffness, true, forces);
  else
    onePointForces<MaterialModel::linear>(u, geometry, stiffness, true, forces);
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
  ElementTables tables;
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
    fields.stored_energy(elem) = storedEnergy(u, geometry, material);
    fields.energy_density(elem) = fields.stored_energy(elem) / volume;
  }

  // An element of a congruent body has the body's shape, any other its own geometry.
  KOKKOS_INLINE_FUNCTION void fieldsOf(const ElementChunk& chunk, const GeometryPlace& place,
                                       int elem, const Material& material) const {
    if constexpr (kind == ElementKind::one_point) {
      if (chunk.shape < 0)
        ownGeometry<OnePointGeometry<double>>(place, elem, material);
      else if (tables.boxes(chunk.shape).is_brick)
        oneElement(elem, tables.boxes(chunk.shape).brick, material);
      else
        oneElement(elem, tables.boxes(chunk.shape).box, material);
    } else {
      if (chunk.shape < 0)
        ownGeometry<FullGeometry<double>>(place, elem, material);
      else
        oneElement(elem, tables.full_shapes(chunk.shape), material);
    }
  }
  template <class Geometry>
  KOKKOS_INLINE_FUNCTION void ownGeometry(const GeometryPlace& place, int elem,
                                          const Material& material) const {
    Geometry geometry;
    loadGeometry(tables, place.row, place.lane, geometry);
    oneElement(elem, geometry, material);
  }

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t c) const {
    const ElementChunk chunk = tables.chunks(c);
    const Material material = tables.mesh.materials(chunk.block);
    for (int p = 0; p < chunk.num_packs; ++p) {
      const ElementPack pack = tables.packs(chunk.first_pack + p);
      for (int lane = 0; lane < pack.count; ++lane) {
        const int elem = pack.first + lane;
        fieldsOf(chunk, geometryPlace(tables, chunk, p, lane, elem), elem, material);
      }
    }
  }
};

} // namespace brickwall::mechanics
