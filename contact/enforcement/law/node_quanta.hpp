// The normal force of a node-to-face contact in quanta, of one contact or of as many as there are
// lanes.
#pragma once

#include "contact/base/fixed_pack.hpp"
#include "contact/base/lane_arrays.hpp"
#include "contact/enforcement/law/pair_forces.hpp"

namespace brickwall::contact {

// The same quanta as PairForces::round().
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
  // Leaves the change since `before`.
  KOKKOS_FORCEINLINE_FUNCTION void subtract(const NodeQuanta& before) {
    for (int d = 0; d < 3; ++d) {
      on_node[d] = on_node[d] - before.on_node[d];
      for (int j = 0; j < 4; ++j)
        on_corner[j][d] = on_corner[j][d] - before.on_corner[j][d];
    }
  }
};

// The quanta of all lanes, stored to be read one contact after the other.
template <class Real>
struct LaneQuanta {
  static constexpr int width = NumLanes<Real>::value;
  std::int64_t on_node[3][width], on_corner[4][3][width];

  KOKKOS_FORCEINLINE_FUNCTION void keep(const NodeQuanta<Real>& quanta) {
    for (int d = 0; d < 3; ++d) {
      storeLanes(quanta.on_node[d], on_node[d]);
      for (int j = 0; j < 4; ++j)
        storeLanes(quanta.on_corner[j][d], on_corner[j][d]);
    }
  }
  KOKKOS_FORCEINLINE_FUNCTION PairQuanta of(int lane) const {
    PairQuanta quanta;
    for (int d = 0; d < 3; ++d) {
      quanta.on_point[0][d] = on_node[d][lane];
      quanta.on_point[1][d] = 0;
      for (int j = 0; j < 4; ++j)
        quanta.on_corner[j][d] = on_corner[j][d][lane];
    }
    return quanta;
  }
};

} // namespace brickwall::contact
