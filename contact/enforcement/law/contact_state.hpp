// The state of contacts in a step: what the contact law (contact_law.hpp) reads of them and what it
// finds, for one contact (Real = double) or for one in each SIMD lane.
#pragma once

#include "contact/base/lane_arrays.hpp"
#include "contact/enforcement/law/contact_history.hpp"

namespace brickwall::contact {

template <class Real>
struct ContactState {
  static constexpr int width = NumLanes<Real>::value;
  using Value = LaneArray<Real>;
  using Vector = LaneTriple<Real>;

  // At x^{n+1}
  Vector normal; // n
  Vector motion; // of the pushing point in this step with respect to the face point, length
  Value penetration; // P, length
  Value inverse_mass; // 1/m_red, 1/mass
  Value activation_stiffness; // k if the contact is new, force/length
  Value cap_factor; // of the bound of k, eq. (12)

  // Of the contact history; without meaning unless the contact is persistent.
  Value is_persistent; // 1: the contact continues one of the last step; 0: it is new
  Value has_changed_face; // 1: it continues on another face, or at other points
  Value last_depth, last_offset, last_stiffness, last_stored, last_fade_weight, was_new;
  Value contact_work; // work of the last forces on the contact, energy
  Value closing_at_last_point; // approach of this step along the last normal, length
  // factor of p at a change of faces: sqrt(w of the last face / w of this one)
  Value depth_factor;

  // Results; see Interaction.
  Value offset, depth, stiffness, stored, closing, first_force, first_damping;
  Value fade_weight;
  Value spring_energy; // at the half step, 0 of a new contact
  Value recoverable; // to record for the ledger, energy

  KOKKOS_FORCEINLINE_FUNCTION void recall(int lane, const Interaction& last) {
    last_depth[lane] = last.depth;
    last_offset[lane] = last.offset;
    last_stiffness[lane] = last.stiffness;
    last_stored[lane] = last.stored;
    last_fade_weight[lane] = last.fade_weight;
    was_new[lane] = last.is_new;
  }
  KOKKOS_FORCEINLINE_FUNCTION void recallNone(int lane) {
    last_depth[lane] = last_offset[lane] = last_stored[lane] = was_new[lane] = 0;
    last_stiffness[lane] = last_fade_weight[lane] = 1;
  }
  KOKKOS_FORCEINLINE_FUNCTION void write(int lane, Interaction& now) const {
    now.offset = offset[lane];
    now.depth = depth[lane];
    now.stiffness = stiffness[lane];
    now.fade_weight = fade_weight[lane];
    now.stored = stored[lane];
    now.force = now.first_force = first_force[lane];
    now.damping = now.first_damping = first_damping[lane];
    now.closing = closing[lane];
    now.is_new = is_persistent[lane] == 0;
    now.inverse_mass = inverse_mass[lane];
  }
};

} // namespace brickwall::contact
