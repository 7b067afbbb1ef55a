// What the deck says of loads, boundaries and initial conditions, applied to the sets of the mesh.
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

// [[boundary.fixed]] and [[boundary.velocity]]. Throws InputError for an unknown node set.
std::vector<mechanics::PrescribedMotion> prescribedMotions(const Config& config,
                                                           const io::MeshPart& part);

// [[load.pressure]]. Throws InputError for an unknown side set.
std::vector<mechanics::PressureLoad> pressureLoads(const exec_space& space, const Config& config,
                                                   const Scene& scene);

// [[initial.velocity]], later ones over earlier; prescribed components keep their own. Collective. Throws InputError
// for an unknown block, brick or body.
void setInitialVelocities(const exec_space& space, const Config& config, const Scene& scene,
                          mechanics::SharedNodeSum& shared,
                          const mechanics::BoundaryConditions& boundary,
                          const mechanics::NodalState& state);

// [[initial.deformation]], later ones over earlier. Prescribed components too: they keep the displacement that they start
// with. Collective. Throws InputError as above.
void setInitialDeformations(const exec_space& space, const Config& config, const Scene& scene,
                            mechanics::SharedNodeSum& shared, const mechanics::NodalState& state);

} // namespace brickwall::miniapp
