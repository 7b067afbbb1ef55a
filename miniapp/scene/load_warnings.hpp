// What a deck says of pressures and prescribed velocities that can not come out as it means them: they come too late, or act too
// far away, or in a spot that the faces do not resolve.
#pragma once

#include "io/mesh/mesh_part.hpp"
#include "miniapp/deck/config.hpp"

#include <mpi.h>

#include <string>
#include <vector>

namespace brickwall::miniapp {

// Largest relative error of the total force of exp(-(r/radius)^2) by 2x2 Gauss points on a flat grid of faces with edges a and
// b, wherever on them the centre lies.
double gaussianForceError(double a, double b, double radius);

// Warnings of [[load.pressure]] and [[boundary.velocity]], one of each at most, the same on all ranks. Of a wall from the deck alone, so that `part` may be
// that of a smaller one. Collective.
std::vector<std::string> loadWarnings(MPI_Comm comm, const Config& config,
                                      const io::MeshPart& part);

} // namespace brickwall::miniapp
