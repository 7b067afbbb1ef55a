// Generates a wall in parallel: each rank takes a slice of the elements (faces), RCB assigns them
// to ranks, and these generate them from their ids. No rank holds more than its slice and its
// part.
#pragma once

#include "io/mesh/mesh_part.hpp"
#include "io/wall/wall_layout.hpp"

#include <mpi.h>

namespace brickwall::io {

// This rank's part of the wall. Bodies are bricks; blocks "brick" and, where there are half bricks,
// "half_brick"; side sets front (y = 0), back, left, right, bottom, top; node sets base,
// base_course, top_course, left_end, right_end. Collective. Throws InputError as WallLayout does,
// and Error when a part outgrows 32-bit local indices.
MeshPart generateWall(MPI_Comm comm, const WallConfig& config);

// This rank's part of the wall's exterior surface, never the volume: RCB over face centroids, a
// node owned by the lowest rank that shares it, ids as in the full mesh, faces in the order of id.
// `jitter` moves each node by up to its amplitude times the element edge of each axis, a function
// of seed and node id alone. Collective; errors as above.
SurfacePart generateWallSurface(MPI_Comm comm, const WallConfig& config,
                                const WallJitter& jitter = WallJitter());

} // namespace brickwall::io
