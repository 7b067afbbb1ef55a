// Whether one fixed-point quantum serves all bodies of a scene: forces are rounded to a share of the strongest element's
// (contact/base/fixed_point.hpp), which bodies that are very much softer or finer do not feel in their own.
#pragma once

#include "io/mesh/mesh_part.hpp"
#include "mechanics/element/material.hpp"

#include <mpi.h>

#include <string>
#include <vector>

namespace brickwall::miniapp {

// Of a block's force at a strain of one, (lambda + 2 mu) h^2, h the longest edge of an element: rounding that is told of, and
// rounding that is refused.
constexpr double coarse_forces = 1e-9, too_coarse_forces = 1e-6;

// Warnings of blocks whose weakest element feels the rounding of forces. Collective; the same on all ranks. Throws InputError
// where forces of usual strains would be lost. `materials` [block].
std::vector<std::string> checkForceRange(MPI_Comm comm, const io::MeshPart& part,
                                         const std::vector<mechanics::Material>& materials);

} // namespace brickwall::miniapp
