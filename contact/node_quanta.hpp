// The force of a contact of a node along the normal, with nothing besides, in quanta: of one or of as many as there are lanes.
#pragma once

#include "contact/base/fixed_pack.hpp"
#include "contact/base/lane_arrays.hpp"
#include "contact/pair_forces.hpp"

namespace brickwall::contact {

// Quanta as PairForces::round() gives them.
template <class Real>
struct NodeQuanta {
  using Integer = decltype(toFixed(Real()));
  Integer on_node[3], on_corner[4][3];
  typename MaskOf<Real>::type fits;

  KOKKOS_FORCEINLINE_FUNCTION NodeQuanta(const Real& force, const Triple<Real>& normal,
                                         const Real (&weight)[4], double inverse_quantum) {
    fits = fitsFixedPoint(fixed_point_share * inverse_quantum * force);
    const Real along[3] = {normal.x, normal.y, normal.z};
    for (int d = 0; d < 3; ++d) {
      const Real whole = inverse_quantum * (force * along[d]);
      on_node[d] = toFixed(whole);
      Integer rest = -on_node[d];
      for (int j = 0; j < 3; ++j) {
        on_corner[j][d] = toFixed(-weight[j] * whole);
        rest = rest - on_corner[j][d];
      }
      on_corner[3][d] = rest;
    }
  }
};

} // namespace brickwall::contact
