// Warnings for pressures and prescribed velocities that cannot act as intended: they begin too
// late, act too far away, or in a spot or a time that faces or steps do not resolve; and for decks
// in which nothing acts.
#pragma once

#include "io/mesh/mesh_part.hpp"
#include "mechanics/mesh/skin.hpp"
#include "miniapp/deck/config.hpp"

#include <mpi.h>

#include <string>
#include <vector>

namespace brickwall::miniapp {

// Largest relative error of the total force of the pressure exp(-(r/radius)^2), integrated with 2x2
// Gauss points on a flat grid of faces with edges a and b, for any position of the centre.
double gaussianForceError(double a, double b, double radius);

// At most one warning for each [[load.pressure]] and [[boundary.velocity]], and one if nothing sets
// the bodies in motion, the same on all ranks.
// Those of a wall depend on the deck only, so `part` may be a smaller wall. `dt` is the step.
// Collective.
std::vector<std::string> loadWarnings(MPI_Comm comm, const Config& config, const io::MeshPart& part,
                                      double dt);

// A warning for each [[load.pressure]] whose side set has faces that are not on the surface of a
// body, the same on all ranks. Collective.
std::vector<std::string> interiorSideWarnings(MPI_Comm comm, const Config& config,
                                              const io::MeshPart& part,
                                              const mechanics::Skin& skin);

} // namespace brickwall::miniapp
