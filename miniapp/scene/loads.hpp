// Loads, boundary conditions and initial conditions of the deck, applied to the sets of the mesh.
#pragma once

#include "mechanics/loads/boundary_conditions.hpp"
#include "mechanics/loads/pressure_load.hpp"
#include "mechanics/mesh/nodal_state.hpp"
#include "miniapp/scene/scene.hpp"

#include <vector>

namespace brickwall::miniapp {

inline Vec3 toVec3(const Triple& t) {
  return {t[0], t[1], t[2]};
}

// The velocity in the components that an entry prescribes, zero in the others.
Vec3 prescribedVelocity(const PrescribedVelocityConfig& prescribed);

// The variation in time of a load or a prescribed velocity, from its start on.
mechanics::PulseShape toPulseShape(const PulseConfig& pulse);

// [[boundary.fixed]] and [[boundary.velocity]]. Throws InputError for an unknown node set.
std::vector<mechanics::PrescribedMotion> prescribedMotions(const Config& config,
                                                           const io::MeshPart& part);

// [[load.pressure]]. Throws InputError for an unknown side set. Collective.
std::vector<mechanics::PressureLoad> pressureLoads(const exec_space& space, MPI_Comm comm,
                                                   const Config& config, const Scene& scene);

// [[initial.velocity]]; later entries override earlier ones, prescribed motions override both.
// Throws InputError for an unknown block, brick or body. Collective.
void setInitialVelocities(const exec_space& space, const Config& config, const Scene& scene,
                          mechanics::SharedNodeSum& shared,
                          const mechanics::BoundaryConditions& boundary,
                          const mechanics::NodalState& state);

// [[initial.deformation]]; later entries override earlier ones. It also sets prescribed components,
// which then move from this displacement. Throws InputError as above. Collective.
void setInitialDeformations(const exec_space& space, const Config& config, const Scene& scene,
                            mechanics::SharedNodeSum& shared, const mechanics::NodalState& state);

} // namespace brickwall::miniapp
