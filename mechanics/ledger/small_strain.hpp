// How far linear materials are from where they hold. They take e = (H + H^T)/2 for the strain E = e + H^T H/2 of the displacement
// gradient H: a rotation by w radians, of which E knows nothing, is to them a stretch of -w^2/2 across its axis, and a body that
// keeps turning with u = t w x X grows by +w^2 t^2/2 instead.
#pragma once

#include "mechanics/mesh/hex_mesh.hpp"

#include <mpi.h>

namespace brickwall::mechanics {

// Beyond it a linear material errs by more than 1 % of the length of its fibres: turned by 8 degrees, for one.
constexpr double large_left_out_strain = 0.01;

struct NeglectedStrain {
  double strain = 0; // largest entry of H^T H/2 on its diagonal, at the centre
  global_id elem = INT64_MAX; // the lowest id of those with it

  KOKKOS_INLINE_FUNCTION NeglectedStrain& operator+=(const NeglectedStrain& b) {
    if (b.strain > strain || (b.strain == strain && b.elem < elem))
      *this = b;
    return *this;
  }
};

// The most that an element of linear material leaves out, of all ranks; 0 without such. Collective.
NeglectedStrain neglectedStrain(const exec_space& space, MPI_Comm comm, const HexMesh& mesh,
                                const View<const double* [3]>& displacement);

} // namespace brickwall::mechanics
