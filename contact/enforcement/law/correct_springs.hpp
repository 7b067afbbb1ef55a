// The energy-neutral correction (correct_pair.hpp) of node-to-face contacts with a normal spring
// and no other force, for as many contacts at once as there are SIMD lanes. Nodal forces change by
// the difference of the rounded forces.
#pragma once

#include "contact/base/lane_arrays.hpp"
#include "contact/enforcement/law/correct_pair.hpp"
#include "contact/enforcement/law/pair_forces.hpp"

namespace brickwall::contact {
namespace correct_springs {

// Input, filled one contact after the other.
template <class Real>
struct Gathered {
  LaneArray<Real> force, first_force, damping, first_damping, depth, offset, stored, is_new;
  LaneArray<Real> closing, inverse_mass, response, weight[4];
  LaneTriple<Real> normal, acceleration, corner_acceleration[4];

  KOKKOS_FORCEINLINE_FUNCTION void gather(int lane, const Interaction& pair,
                                          const CorrectPair& correct) {
    force[lane] = pair.force;
    first_force[lane] = pair.first_force;
    damping[lane] = pair.damping;
    first_damping[lane] = pair.first_damping;
    depth[lane] = pair.depth;
    offset[lane] = pair.offset;
    stored[lane] = pair.stored;
    is_new[lane] = pair.is_new;
    closing[lane] = pair.closing;
    inverse_mass[lane] = pair.inverse_mass;
    response[lane] = correct.isProposal() ? 0 : correct.responseOf(pair);
    normal.set(lane, pair.normal);
    acceleration.set(lane, rowOf(correct.accelerations.nodes, pair.point.node[0]));
    Vec3 of_corner[4];
    correct.faces.corners(pair.face_index, correct.accelerations.nodes,
                          correct.accelerations.ghosts, of_corner);
    for (int j = 0; j < 4; ++j) {
      corner_acceleration[j].set(lane, of_corner[j]);
      weight[j][lane] = pair.weight[j];
    }
  }
};

// Corrected forces and the resulting changes, in quanta, of the forces on the node and on the
// corners.
template <class Real>
struct Corrected {
  LaneArray<Real> force, damping;
  PairQuanta<Real> change;
  LaneArray<Real> fits; // 1: the forces before and after the correction fit the fixed point

  KOKKOS_FORCEINLINE_FUNCTION bool changes(int lane, const Interaction& pair) const {
    return CorrectPair::isChange(force[lane] - pair.force, pair.first_force) ||
           CorrectPair::isChange(damping[lane] - pair.damping, pair.first_force);
  }
};

template <class Real>
KOKKOS_INLINE_FUNCTION void evaluate(const Gathered<Real>& gathered, const CorrectPair& correct,
                                     const PairForces& add, Corrected<Real>& corrected) {
  const Triple<Real> normal = gathered.normal;
  Triple<Real> relative = gathered.acceleration;
  Real weight[4];
  for (int j = 0; j < 4; ++j) {
    weight[j] = gathered.weight[j];
    const Triple<Real> with = relative - weight[j] * Triple<Real>(gathered.corner_acceleration[j]);
    relative = where(weight[j] == Real(0.0), relative, with);
  }
  SpringState<Real> spring;
  spring.force = gathered.force;
  spring.first_force = gathered.first_force;
  spring.depth = gathered.depth;
  spring.offset = gathered.offset;
  spring.stored = gathered.stored;
  spring.is_new = !(Real(gathered.is_new) == Real(0.0));
  KickedPairOf<Real> motion =
      correct.kicked(Real(gathered.closing), Real(gathered.inverse_mass), dot(normal, relative));
  Real force = neutralForce(spring, motion);
  if (!correct.isProposal()) {
    motion.mobility =
        correct.mobilityOf(Real(magnitude(force - spring.force)), Real(gathered.response), motion);
    force = neutralForce(spring, motion);
  }
  const Real damping = maxOf(Real(gathered.first_damping), -force);
  corrected.force = force;
  corrected.damping = damping;
  if (correct.isProposal())
    return;
  PairQuanta<Real> before;
  add.round(spring.force + Real(gathered.damping), normal, Real(0.0), weight, before);
  add.round(force + damping, normal, Real(0.0), weight, corrected.change);
  corrected.fits = where(before.fits & corrected.change.fits, Real(1.0), Real(0.0));
  corrected.change.subtract(before);
}

} // namespace correct_springs

// Whether correctSprings() may take an interaction, on own faces or ghosts.
KOKKOS_FORCEINLINE_FUNCTION bool hasOnlySpring(const Interaction& pair, const PairForces& add) {
  return !add.has_friction && add.face_corners == 4 && pair.fade_weight == 1 && pair.point.isNode();
}

// Prefetch distance, in interactions.
constexpr std::int64_t pairs_ahead = 64;

// Proposes the changes of the `count` listed interactions, or applies them, as correctOne()
// does for one (interaction_set.cpp); is_changed(number) stores whether the force is to change, and
// `num_changed` counts those. `add` adds to the magnitudes of the proposals, or to the forces.
// Interactions whose forces do not fit the fixed point are left unchanged and moved to the front of
// `numbers`; returns how many they are. pairOf(number) is an interaction of `pairs`, from
// pairs.interactions or loaded before.
template <class PairOf>
KOKKOS_INLINE_FUNCTION int
correctSprings(const ContactHistory& pairs, const PairOf& pairOf, const CorrectPair& correct,
               const PairForces& add, std::int64_t* numbers, int count,
               const View<unsigned char*>& is_changed, std::int64_t& num_changed) {
  using namespace correct_springs;
  using Real = Lanes;
  constexpr int width = NumLanes<Real>::value;
  Gathered<Real> gathered;
  Corrected<Real> corrected;
  int num_left = 0;
  for (int first = 0; first < count; first += width) {
    const int last = minOf(first + width, count) - 1;
    for (int lane = 0; lane < width; ++lane) {
      const std::int64_t number = numbers[minOf(first + lane, last)];
      pairs.interactions.prefetch(minOf(number + pairs_ahead, pairs.count - 1));
      gathered.gather(lane, pairOf(number), correct);
    }
    evaluate(gathered, correct, add, corrected);
    if (width > 1 && correct.isProposal())
      for (int lane = 0; first + lane <= last; ++lane) {
        const Interaction& pair = pairOf(numbers[first + lane]);
        if (corrected.changes(lane, pair))
          add.prefetchTarget(pair.point.node[0], pair.face_index);
      }
    for (int lane = 0; first + lane <= last; ++lane) {
      const std::int64_t number = numbers[first + lane];
      const Interaction& pair = pairOf(number);
      const bool changes = corrected.changes(lane, pair);
      if (correct.isProposal()) {
        is_changed(number) = changes;
        if (changes)
          add.addMagnitude(pair, corrected.force[lane] - pair.force);
      } else if (corrected.fits[lane] == 0) {
        numbers[num_left++] = number;
        continue;
      } else if (changes) {
        pairs.interactions.setMember(number, &Interaction::force, corrected.force[lane]);
        pairs.interactions.setMember(number, &Interaction::damping, corrected.damping[lane]);
        add.add(pair, corrected.change, 1, lane);
      }
      if (changes)
        correct.mark(pair);
      num_changed += changes;
    }
  }
  return num_left;
}

} // namespace brickwall::contact
