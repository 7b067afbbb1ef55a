// Decomposition by Zoltan's recursive coordinate bisection, with 64-bit ids.
#pragma once

#include "contact/base/backend.hpp"

#include <mpi.h>

#include <vector>

namespace brickwall::io {

// Where points in the plane of a cut go: to both sides, so that these get equal shares, or together
// to one side. Parts of a lattice of elements are then lattices, and each cut is within a plane of
// points of equal shares. Coordinates in a plane have to be equal bit for bit.
enum class CutPlanes { divided, whole };

// Rank that each of this rank's points (element or face centroids) belongs to: [point]. `ids` are
// unique over all ranks; `points` is [point][xyz]; ranks get equal sums of `weights` [point], or
// equal numbers of points if these are empty on all ranks. Fewer points than ranks, ranks without
// points and coincident points are fine. Collective. Throws Error naming the Zoltan call that
// failed.
std::vector<int> partitionPoints(MPI_Comm comm, const std::vector<global_id>& ids,
                                 const std::vector<double>& points,
                                 const std::vector<float>& weights = {},
                                 CutPlanes cut_planes = CutPlanes::divided);

} // namespace brickwall::io
