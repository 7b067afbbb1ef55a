// Resolution of forces. Forces are rounded to a fixed-point quantum, a fraction of the force of the
// strongest element (contact/base/fixed_point.hpp); bodies that are much softer or finer may lose
// accuracy.
#pragma once

#include "io/mesh/mesh_part.hpp"
#include "mechanics/element/material.hpp"

#include <mpi.h>

#include <string>
#include <vector>

namespace brickwall::miniapp {

// Rounding relative to a block's force at a strain of one, (lambda + 2 mu) h^2 with h the longest
// edge of an element: the limit of a warning and that of an error.
constexpr double coarse_forces = 1e-9, too_coarse_forces = 1e-6;

// Warnings for blocks whose weakest element is affected by the rounding of forces, the same on all
// ranks. Throws InputError if forces of usual strains would be lost. `materials` [block].
// Collective.
std::vector<std::string> checkForceRange(MPI_Comm comm, const io::MeshPart& part,
                                         const std::vector<mechanics::Material>& materials);

} // namespace brickwall::miniapp
