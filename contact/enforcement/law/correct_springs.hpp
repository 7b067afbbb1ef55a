// The energy-neutral correction (correct_pair.hpp) of node-to-face contacts with a normal spring
// and no other force, for as many contacts at once as there are SIMD lanes. Nodal forces change by
// the difference of the rounded forces.
#pragma once

#include "contact/base/lane_arrays.hpp"
#include "contact/enforcement/law/correct_pair.hpp"
#include "contact/enforcement/law/pair_forces.hpp"

namespace brickwall::contact {
namespace correct_springs {

// Input [quantity][xyz][lane], filled one contact after the other.
template <class Real>
struct Gathered {
  static constexpr int width = NumLanes<Real>::value;
  double force[width], first_force[width], damping[width], first_damping[width];
  double depth[width], offset[width], stored[width], is_new[width];
  double closing[width], inverse_mass[width], normal[3][width], weight[4][width];
  double acceleration[3][width], corner_acceleration[4][3][width];

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
    for (int d = 0; d < 3; ++d) {
      normal[d][lane] = pair.normal[d];
      acceleration[d][lane] = correct.accelerations(pair.point.node[0], d);
    }
    Vec3 of_corner[4];
    correct.faces.corners(pair.face_index, correct.accelerations, correct.ghost_accelerations,
                          of_corner);
    for (int j = 0; j < 4; ++j) {
      for (int d = 0; d < 3; ++d)
        corner_acceleration[j][d][lane] = of_corner[j][d];
      weight[j][lane] = pair.weight[j];
    }
  }
};

// Corrected forces and the resulting changes, in quanta, of the forces on the node and on the
// corners.
template <class Real>
struct Corrected {
  static constexpr int width = Gathered<Real>::width;
  double force[width], damping[width];
  PairQuanta<Real> change;
  double fits[width]; // 1: the forces before and after the correction fit the fixed point

  // Returns whether the force changes.
  KOKKOS_FORCEINLINE_FUNCTION bool scatter(int lane, Interaction& pair,
                                           const PairForces& add) const {
    if (force[lane] == pair.force && damping[lane] == pair.damping)
      return false;
    pair.force = force[lane];
    pair.damping = damping[lane];
    add.add(pair, change, 1, lane);
    return true;
  }
};

template <class Real>
KOKKOS_INLINE_FUNCTION void evaluate(const Gathered<Real>& gathered, const CorrectPair& correct,
                                     const PairForces& add, Corrected<Real>& corrected) {
  const Triple<Real> normal = loadTriple<Real>(gathered.normal);
  Triple<Real> relative = loadTriple<Real>(gathered.acceleration);
  Real weight[4];
  for (int j = 0; j < 4; ++j) {
    weight[j] = loadLanes<Real>(gathered.weight[j]);
    const Triple<Real> with =
        relative - weight[j] * loadTriple<Real>(gathered.corner_acceleration[j]);
    relative = where(weight[j] == Real(0.0), relative, with);
  }
  SpringState<Real> spring;
  spring.force = loadLanes<Real>(gathered.force);
  spring.first_force = loadLanes<Real>(gathered.first_force);
  spring.depth = loadLanes<Real>(gathered.depth);
  spring.offset = loadLanes<Real>(gathered.offset);
  spring.stored = loadLanes<Real>(gathered.stored);
  spring.is_new = !(loadLanes<Real>(gathered.is_new) == Real(0.0));
  const KickedPairOf<Real> motion =
      correct.kicked(loadLanes<Real>(gathered.closing), loadLanes<Real>(gathered.inverse_mass),
                     dot(normal, relative));
  const Real force = correct.relaxed(spring.force, neutralForce(spring, motion));
  const Real damping = maxOf(loadLanes<Real>(gathered.first_damping), -force);
  PairQuanta<Real> before, after;
  add.round(spring.force + loadLanes<Real>(gathered.damping), normal, Real(0.0), weight, before);
  add.round(force + damping, normal, Real(0.0), weight, after);
  storeLanes(where(before.fits & after.fits, Real(1.0), Real(0.0)), corrected.fits);
  after.subtract(before);
  corrected.change = after;
  storeLanes(force, corrected.force);
  storeLanes(damping, corrected.damping);
}

} // namespace correct_springs

// Whether correctSprings() may take an interaction, on own faces or ghosts.
KOKKOS_FORCEINLINE_FUNCTION bool hasOnlySpring(const Interaction& pair, const PairForces& add) {
  return !add.has_friction && add.face_corners == 4 && pair.fade_weight == 1 && pair.point.isNode();
}

// Prefetch distance, in interactions.
constexpr std::int64_t pairs_ahead = 64;

// Corrects the `count` listed interactions as correctForce() corrects one; is_changed(number)
// stores whether the force has changed, and `num_changed` counts those that have. Interactions
// whose forces do not fit the fixed point are left unchanged and moved to the front of `numbers`;
// returns how many they are.
KOKKOS_INLINE_FUNCTION int correctSprings(const ContactHistory& pairs, const CorrectPair& correct,
                                          const PairForces& add, std::int64_t* numbers, int count,
                                          const View<unsigned char*>& is_changed,
                                          std::int64_t& num_changed) {
  using namespace correct_springs;
  using Real = Lanes;
  constexpr int width = Gathered<Real>::width;
  Gathered<Real> gathered;
  Corrected<Real> corrected;
  int num_left = 0;
  for (int first = 0; first < count; first += width) {
    const int last = minOf(first + width, count) - 1;
    for (int lane = 0; lane < width; ++lane) {
      const std::int64_t number = numbers[minOf(first + lane, last)];
      pairs.prefetch(minOf(number + pairs_ahead, pairs.count - 1));
      gathered.gather(lane, pairs.interactions(number), correct);
    }
    evaluate(gathered, correct, add, corrected);
    for (int lane = 0; first + lane <= last; ++lane) {
      const std::int64_t number = numbers[first + lane];
      if (corrected.fits[lane] == 0) {
        numbers[num_left++] = number;
        continue;
      }
      is_changed(number) = corrected.scatter(lane, pairs.interactions(number), add);
      num_changed += is_changed(number);
    }
  }
  return num_left;
}

} // namespace brickwall::contact
