// The wall W(n) of the search benchmarks (inputs/wall_*.toml): 15 bricks x 29 courses in running
// bond, each brick 2 x 1 x 1 with 2n x n x n elements, 4350 n^2 faces, jittered and drifting as in
// the decks.
#pragma once

#include "contact/surface/search_config.hpp"
#include "io/mesh/mesh_part.hpp"
#include "miniapp/scene/search_surface.hpp"
#include "verification/performance/peers/peers.hpp"

#include <mpi.h>

#include <map>
#include <string>

namespace brickwall::peers {

// Collective. This rank's part of the surface of W(n).
io::SurfacePart wallSurface(MPI_Comm comm, int n);

// The surface as it drifts in `brickwall search`.
miniapp::SearchSurface movingWall(const exec_space& space, MPI_Comm comm, int n,
                                  const io::SurfacePart& part);

// Brickwall's methods by their names on command lines.
const std::map<std::string, contact::SearchMethod>& searchMethods();

// Both tolerances are 5 % of an element's edge.
contact::SearchConfig wallSearch(int n, contact::SearchMethod method);

// The boxes that the search builds for owned nodes and for all faces of the surface, on the host.
SearchBoxes searchBoxes(const exec_space& space, const contact::Surface& surface,
                        const contact::SearchConfig& config);

} // namespace brickwall::peers
