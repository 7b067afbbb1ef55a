// Force kernel of element packs: gathers a pack's displacements as modes, evaluates the element
// (theory.md, equations (10) to (15)), rounds the modes and adds them to the corners in integers
// (equation (23)).
#include "mechanics/force/packs/pack_forces.hpp"

#include "mechanics/force/packs/round_forces.hpp"

namespace brickwall::mechanics {

namespace {

// Forces and energies of a pack before they are added.
template <class Real, class Integer>
struct PackForces {
  CornerForces<Integer> corners;
  Real energy[num_stored_energies];
  Real J;
  Real largest; // largest magnitude of a mode
};

template <MaterialModel model, class Real, class Integer, class Geometry, class Stiffness>
KOKKOS_INLINE_FUNCTION void packForces(const Real (&u)[3][num_modes], const Geometry& geometry,
                                       const Stiffness& stiffness, const ForceArguments& a,
                                       PackForces<Real, Integer>& out) {
  OnePointForces<Real> forces;
  onePointForces<model>(u, geometry, stiffness, a.with_energy, forces);
  out.J = forces.J;
  out.largest = Real(0.0);
  roundToCorners(forces.force, out.largest, out.corners);
  out.energy[stored_material] = forces.material_energy;
  out.energy[stored_hourglass] = forces.hourglass_energy;
}
template <MaterialModel model, class Real, class Integer>
KOKKOS_INLINE_FUNCTION void
packForces(const Real (&u)[3][num_modes], const FullGeometry<Real>& geometry,
           const ElementModuli& moduli, const ForceArguments& a, PackForces<Real, Integer>& out) {
  FullForces<Real> forces;
  fullForces<model>(u, geometry, moduli.lambda, moduli.mu, a.inverse_quantum, a.with_energy,
                    forces);
  out.J = forces.J;
  out.largest = Real(0.0);
  roundToCorners(forces.material, out.largest, out.corners);
  out.energy[stored_material] = forces.material_energy;
  out.energy[stored_hourglass] = Real(0.0);
}

// Adds to the columns of one force kind.
template <class Integer>
KOKKOS_INLINE_FUNCTION void addCorners(const ElementTables& tables, const ForceColumns& forces,
                                       const ElementPack& pack, int lane, int kind,
                                       const CornerForces<Integer>& corners) {
  for (int c = 0; c < 8; ++c) {
    const int node = tables.mesh.elem_to_nodes(pack.first + lane, c);
    for (int i = 0; i < 3; ++i) {
      std::int64_t* const target = &forces(node, 3 * kind + i);
      const std::int64_t value = laneOf(corners.value[i][c], lane);
      if (pack.atomic)
        Kokkos::atomic_add(target, value);
      else
        *target += value;
    }
  }
}

template <class Real, class Integer>
KOKKOS_INLINE_FUNCTION void addPack(const ForceArguments& a, const ElementPack& pack,
                                    const PackForces<Real, Integer>& forces, ForceSums& sums) {
  for (int lane = 0; lane < pack.count; ++lane) {
    const int reason = failureReason(laneOf(forces.J, lane), laneOf(forces.largest, lane));
    if (reason != no_failure) {
      sums.failure.add(a.tables.mesh.elem_ids(pack.first + lane), reason);
      continue;
    }
    addCorners(a.tables, a.forces, pack, lane, internal_force, forces.corners);
    if (a.with_energy)
      for (int kind = 0; kind < num_stored_energies; ++kind)
        sums.energy.add(kind, laneOf(forces.energy[kind], lane), a.energy_scale);
  }
}

// Viscous forces of a pack.
template <class Real, class Integer>
struct ViscousPack {
  CornerForces<Integer> corners;
  Real rate;
};

// Computes a pack's viscous forces. `largest` also covers their modes, so that overflow is detected
// for both force kinds.
template <MaterialModel model, class Real, class Integer, class Geometry>
KOKKOS_INLINE_FUNCTION void viscousPack(const ForceArguments& a, const ElementPack& pack,
                                        const Real (&u)[3][num_modes], const Geometry& geometry,
                                        const ViscousModuli& moduli, Real& largest,
                                        ViscousPack<Real, Integer>& out) {
  Real v[3][num_modes];
  gatherModes(a.tables, a.velocity, pack, v);
  ViscousForces<Real, Geometry::gradient_modes> forces;
  viscousForces<model>(u, v, geometry, moduli, a.inverse_quantum, forces);
  roundToCorners(forces.force, largest, out.corners);
  out.rate = forces.rate;
}

// Adds a pack's viscous forces. addPack() has reported failed elements, which add nothing here
// either.
template <class Real, class Integer>
KOKKOS_INLINE_FUNCTION void
addViscousPack(const ForceArguments& a, const ElementPack& pack, const Real& J, const Real& largest,
               const ViscousPack<Real, Integer>& viscous, ForceSums& sums) {
  for (int lane = 0; lane < pack.count; ++lane) {
    if (failureReason(laneOf(J, lane), laneOf(largest, lane)) != no_failure)
      continue;
    addCorners(a.tables, a.forces, pack, lane, viscous_force, viscous.corners);
    sums.compression_rate = maxOf(sums.compression_rate, laneOf(viscous.rate, lane));
  }
}

template <ElementKind kind, MaterialModel model, bool with_viscosity>
struct ForceFunctor {
  ForceArguments a;

  template <class Geometry, class Stiffness>
  KOKKOS_INLINE_FUNCTION void onePack(const ElementPack& pack, const Geometry& geometry,
                                      const Stiffness& stiffness, const Material& material,
                                      ForceSums& sums) const {
    Lanes u[3][num_modes];
    gatherModes(a.tables, a.displacement, pack, u);
    PackForces<Lanes, IntLanes> forces;
    packForces<model>(u, geometry, stiffness, a, forces);
    if constexpr (with_viscosity) {
      ViscousPack<Lanes, IntLanes> viscous;
      viscousPack<model>(a, pack, u, geometry, ViscousModuli::of(material, a.viscosity),
                         forces.largest, viscous);
      addPack(a, pack, forces, sums);
      addViscousPack(a, pack, forces.J, forces.largest, viscous, sums);
    } else {
      addPack(a, pack, forces, sums);
    }
  }

  template <class Geometry>
  KOKKOS_INLINE_FUNCTION auto stiffness(const Geometry& geometry,
                                        const ElementModuli& moduli) const {
    if constexpr (kind == ElementKind::one_point)
      return stiffnessOf(geometry, moduli, a.inverse_quantum);
    else
      return moduli;
  }
  template <class Geometry>
  KOKKOS_INLINE_FUNCTION void congruent(const ElementChunk& chunk, const Geometry& shape,
                                        const Material& material, ForceSums& sums) const {
    const auto shared = stiffness(shape, ElementModuli::of(material));
    for (int p = 0; p < chunk.num_packs; ++p)
      onePack(a.tables.packs(chunk.first_pack + p), shape, shared, material, sums);
  }
  template <class Geometry>
  KOKKOS_INLINE_FUNCTION void general(const ElementChunk& chunk, const Material& material,
                                      ForceSums& sums) const {
    const ElementModuli moduli = ElementModuli::of(material);
    for (int p = 0; p < chunk.num_packs; ++p) {
      Geometry geometry;
      const ElementPack pack = a.tables.packs(chunk.first_pack + p);
      loadPackGeometry(a.tables, chunk, p, pack, geometry);
      onePack(pack, geometry, stiffness(geometry, moduli), material, sums);
    }
  }

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t c, ForceSums& sums) const {
    const ElementChunk chunk = a.tables.chunks(a.first_chunk + c);
    if ((a.skips_lattices && chunk.lattice >= 0) || a.rests(chunk.body))
      return;
    const Material material = a.tables.mesh.materials(chunk.block);
    if constexpr (kind == ElementKind::one_point) {
      if (chunk.shape < 0)
        general<OnePointGeometry<Lanes>>(chunk, material, sums);
      else if (a.tables.boxes(chunk.shape).is_brick)
        congruent(chunk, a.tables.boxes(chunk.shape).brick, material, sums);
      else
        congruent(chunk, a.tables.boxes(chunk.shape).box, material, sums);
    } else {
      if (chunk.shape >= 0)
        congruent(chunk, inAllLanes<Lanes>(a.tables.full_shapes(chunk.shape)), material, sums);
      else
        general<FullGeometry<Lanes>>(chunk, material, sums);
    }
  }
};

template <ElementKind kind, MaterialModel model, bool with_viscosity>
void launchForces(const exec_space& space, const ChunkGroup& group, const ForceArguments& a,
                  LaunchedSums<ForceSums>& sums) {
  launchSum<ForceSums>("mechanics::InternalForce::add::packs", space, 0, group.count,
                       ForceFunctor<kind, model, with_viscosity>{a}, sums.next(space));
}
template <ElementKind kind, MaterialModel model>
void launchForces(const exec_space& space, const ChunkGroup& group, const ForceArguments& a,
                  LaunchedSums<ForceSums>& sums) {
  if (a.viscosity.any())
    launchForces<kind, model, true>(space, group, a, sums);
  else
    launchForces<kind, model, false>(space, group, a, sums);
}

template <MaterialModel model>
void launchForces(const exec_space& space, ElementKind kind, const ChunkGroup& group,
                  const ForceArguments& a, LaunchedSums<ForceSums>& sums) {
  if (kind == ElementKind::one_point)
    launchForces<ElementKind::one_point, model>(space, group, a, sums);
  else
    launchForces<ElementKind::full, model>(space, group, a, sums);
}

} // namespace

void addPackForces(const exec_space& space, ElementKind kind, const ChunkGroup& group,
                   const ForceArguments& a, LaunchedSums<ForceSums>& sums) {
  switch (group.model) {
  case MaterialModel::neo_hookean:
    return launchForces<MaterialModel::neo_hookean>(space, kind, group, a, sums);
  case MaterialModel::svk:
    return launchForces<MaterialModel::svk>(space, kind, group, a, sums);
  default:
    return launchForces<MaterialModel::linear>(space, kind, group, a, sums);
  }
}

} // namespace brickwall::mechanics
