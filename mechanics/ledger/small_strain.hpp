// Validity of the linear material. It uses e = (H + H^T)/2 instead of the strain E = e + H^T H/2 of
// the displacement gradient H. A rotation by w radians, for which E = 0, gives e = -w^2/2 across
// its axis; a body that keeps rotating with u = t w x X grows by +w^2 t^2/2 instead.
#pragma once

#include "mechanics/mesh/hex_mesh.hpp"

#include <mpi.h>

namespace brickwall::mechanics {

// Above this value a linear material errs by more than 1 % of the length of its fibres, for example
// after a rotation by 8 degrees.
constexpr double large_neglected_strain = 0.01;

struct NeglectedStrain {
  double strain = 0; // largest diagonal entry of H^T H/2 at the centre
  global_id elem = INT64_MAX; // lowest id of the elements with this strain

  KOKKOS_INLINE_FUNCTION NeglectedStrain& operator+=(const NeglectedStrain& b) {
    if (b.strain > strain || (b.strain == strain && b.elem < elem))
      *this = b;
    return *this;
  }
};

// The largest strain that an element of a linear material neglects, over all ranks; 0 without such
// elements. Collective.
NeglectedStrain neglectedStrain(const exec_space& space, MPI_Comm comm, const HexMesh& mesh,
                                const View<const double* [3]>& displacement);

} // namespace brickwall::mechanics
