// The kick of one node with its terms of the ledger, and their arithmetic in lanes
// (kick_packs.hpp).
#pragma once

#include "contact/base/lane_sums.hpp"
#include "mechanics/ledger/ledger_sums.hpp"
#include "mechanics/ledger/sum_limbs.hpp"
#include "mechanics/loads/boundary_conditions.hpp"

namespace brickwall::mechanics {

// Ledger terms that every kicked node has, numbered consecutively.
constexpr int num_plain_kick_terms = 10;
enum PlainKickTerm : int {
  plain_kinetic,
  plain_shadow,
  plain_work, // of the internal force
  plain_power,
  plain_momentum,
  plain_angular = plain_momentum + 3
};
KOKKOS_INLINE_FUNCTION constexpr int plainKickTerm(int term) {
  return term < plain_work
             ? kick_kinetic + term
             : (term == plain_work
                    ? kickWork(internal_force)
                    : (term == plain_power ? +kick_power : kick_momentum + term - plain_momentum));
}
struct PlainKickTerms {
  static constexpr int index[num_plain_kick_terms] = {
      plainKickTerm(0), plainKickTerm(1), plainKickTerm(2), plainKickTerm(3), plainKickTerm(4),
      plainKickTerm(5), plainKickTerm(6), plainKickTerm(7), plainKickTerm(8), plainKickTerm(9)};
};

// The scale of a plain term: energy, power, momentum, angular.
KOKKOS_INLINE_FUNCTION constexpr int plainScale(int term) {
  return term < plain_power ? 0 : (term == plain_power ? 1 : (term < plain_angular ? 2 : 3));
}

// Ledger terms of one of the other kinds of forces: the first numOtherKickTerms() of [work,
// impulse, moment, magnitude of the impulse].
constexpr int max_other_kick_terms = 8;
KOKKOS_INLINE_FUNCTION constexpr int numOtherKickTerms(int kind) {
  return kind == external_force ? +max_other_kick_terms : (kind == contact_force ? 4 : 1);
}
KOKKOS_INLINE_FUNCTION constexpr int otherKickTerm(int kind, int term) {
  return term == 0 ? kickWork(kind)
                   : (term == 7 ? +kick_load_magnitude
                                : (term >= 4 ? kick_moment_external + term - 4
                                             : (kind == contact_force ? +kick_impulse_contact
                                                                      : +kick_impulse_external) +
                                                   term - 1));
}

// The scale of such a term, as plainScale().
KOKKOS_INLINE_FUNCTION constexpr int otherScale(int term) {
  return term == 0 ? 0 : (term < 4 || term == 7 ? 2 : 3);
}

// Ledger sums of one thread of a device: those of the plain terms and of contact in registers, the
// others, to which few nodes add, in the memory of `others`.
template <class Others>
struct DeviceKickSums {
  Others& others;
  const SplitScale (&scales)[4];
  SplitSums<num_plain_kick_terms> plain;
  SplitSums<numOtherKickTerms(contact_force)> contact;

  KOKKOS_INLINE_FUNCTION void fold() {
    plain.foldInto(
        others, [](int t) { return plainKickTerm(t); },
        [&](int t) -> const SplitScale& { return scales[plainScale(t)]; });
    contact.foldInto(
        others, [](int t) { return otherKickTerm(contact_force, t); },
        [&](int t) -> const SplitScale& { return scales[otherScale(t)]; });
  }
};

// Operands of a node's kick: the velocity `old` before it, mass, current position x and internal
// force.
template <class Real>
struct NodeKick {
  Real old[3], v[3], x[3], force[3], mass;

  // v = old + (dt/m) total + dt g. A node without elements has no mass.
  KOKKOS_FORCEINLINE_FUNCTION void accelerate(const Real (&total)[3], double dt,
                                              const Vec3& gravity) {
    const Real per_mass = whereNotZero(mass, Real(dt / mass));
    for (int i = 0; i < 3; ++i)
      v[i] = (old[i] + per_mass * total[i]) + dt * gravity[i];
  }
  KOKKOS_FORCEINLINE_FUNCTION void terms(double dt, Real (&term)[num_plain_kick_terms]) const {
    Real momentum[3], mean[3];
    for (int i = 0; i < 3; ++i) {
      momentum[i] = mass * v[i];
      mean[i] = old[i] + v[i];
    }
    term[plain_kinetic] = 0.5 * dotOf(momentum, v);
    term[plain_shadow] = 0.5 * dotOf(momentum, old);
    term[plain_work] = (0.5 * dt) * dotOf(force, mean);
    term[plain_power] = -dotOf(force, old);
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      term[plain_momentum + i] = momentum[i];
      term[plain_angular + i] = x[j] * momentum[k] - x[k] * momentum[j];
    }
  }
  // Work, impulse, moment and magnitude of the impulse of another force. The magnitude has the sign
  // of dt, so that a kick that is taken back in part takes its part back.
  KOKKOS_FORCEINLINE_FUNCTION void otherTerms(const Real (&other)[3], double dt,
                                              Real (&term)[max_other_kick_terms]) const {
    Real mean[3], impulse[3];
    for (int i = 0; i < 3; ++i) {
      mean[i] = 0.5 * (old[i] + v[i]);
      impulse[i] = dt * other[i];
    }
    term[0] = dt * dotOf(other, mean);
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      term[1 + i] = impulse[i];
      term[4 + i] = x[j] * impulse[k] - x[k] * impulse[j];
    }
    term[7] = dt * squareRoot(dotOf(other, other));
  }
  KOKKOS_FORCEINLINE_FUNCTION static Real dotOf(const Real (&a)[3], const Real (&b)[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  }
};

// The kick of a node with columns for the first `kinds` force kinds.
template <int kinds>
struct KickNode {
  View<const double*[3]> reference, displacement;
  View<double* [3]> velocity;
  View<const double*> mass;
  View<const unsigned char*> is_owned;
  ForceColumns forces;
  double quantum, dt;
  BoundaryConditions::DuringStep boundary;
  LedgerScales scales;
  SpeedTest test;
  KindFlags acts = {{true, true, true, true}}; // NodalForces::acts
  View<const unsigned char*> may_touch = {}; // NodalForces::may_touch
  DriftAhead ahead = {}; // where nodes are kicked one by one

  // The impulse of mass-proportional damping between two velocities: -dt alpha m (old + v)/2.
  KOKKOS_INLINE_FUNCTION Vec3 dampingImpulse(double m, const Vec3& old, const Vec3& v) const {
    return (-0.5 * dt * boundary.mass_damping * m) * (old + v);
  }

  // Applies damping and prescribed motion to the free velocity; `reaction` is the impulse of the
  // prescribed motion.
  KOKKOS_INLINE_FUNCTION void constrain(const int (&motion)[3], const Vec3& total,
                                        NodeKick<double>& kick, Vec3& reaction) const {
    const Vec3 old = {kick.old[0], kick.old[1], kick.old[2]};
    Vec3 v = {kick.v[0], kick.v[1], kick.v[2]};
    if (boundary.mass_damping > 0) {
      const double half = 0.5 * dt * boundary.mass_damping;
      v = (1 / (1 + half)) * (v - half * old);
    }
    if (boundary.any)
      for (int i = 0; i < 3; ++i) {
        if (motion[i] == 0)
          continue;
        v[i] = boundary.velocityOf(motion[i])[i];
        reaction[i] =
            kick.mass * (v[i] - old[i]) - dt * (total[i] + kick.mass * boundary.gravity[i]);
        if (boundary.mass_damping > 0)
          reaction[i] -= dampingImpulse(kick.mass, old, v)[i];
      }
    for (int i = 0; i < 3; ++i)
      kick.v[i] = v[i];
  }

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t node, KickSums& sums) const {
    kickByStoredColumns(node, sums);
  }
  KOKKOS_FORCEINLINE_FUNCTION bool mayTouch(std::int64_t node) const {
    return may_touch.extent(0) == 0 || may_touch(node) != 0;
  }
  template <class Sums> // KickSums or a DeviceKickSums
  KOKKOS_INLINE_FUNCTION void kickByStoredColumns(std::int64_t node, Sums& sums,
                                                  bool has_contact = true) const {
    std::int64_t columns[3 * kinds];
    for (int kind = 0; kind < kinds; ++kind)
      for (int i = 0; i < 3; ++i)
        columns[3 * kind + i] =
            acts[kind] && (kind != contact_force || has_contact) ? forces(node, 3 * kind + i) : 0;
    kickByColumns(node, columns, sums);
  }

  template <class Sums>
  KOKKOS_INLINE_FUNCTION void
  kickByColumns(std::int64_t node, const std::int64_t (&columns)[3 * kinds], Sums& sums) const {
    NodeKick<double> kick;
    double moved[3], total[3];
    int motion[3] = {};
    for (int i = 0; i < 3; ++i) {
      kick.old[i] = velocity(node, i);
      kick.x[i] = reference(node, i);
      moved[i] = displacement(node, i);
      if (boundary.any)
        motion[i] = boundary.motion(node, i);
    }
    kick.mass = mass(node);
    const bool is_kept = is_owned(node) != 0;
    startLoads();
    for (int i = 0; i < 3; ++i) {
      std::int64_t sum = 0;
      for (int kind = 0; kind < kinds; ++kind)
        sum += columns[3 * kind + i];
      total[i] = quantum * static_cast<double>(sum);
      kick.force[i] = quantum * static_cast<double>(columns[3 * internal_force + i]);
      kick.x[i] += moved[i];
    }
    kick.accelerate(total, dt, boundary.gravity);
    Vec3 reaction;
    constrain(motion, {total[0], total[1], total[2]}, kick, reaction);
    for (int i = 0; i < 3; ++i)
      velocity(node, i) = kick.v[i];
    if (ahead.displacement.extent(0) > 0)
      for (int i = 0; i < 3; ++i)
        ahead.displacement(node, i) = moved[i] + ahead.dt * kick.v[i];
    if (!is_kept)
      return;
    double contact[3] = {};
    if constexpr (kinds > contact_force)
      for (int i = 0; i < 3; ++i)
        contact[i] = quantum * static_cast<double>(columns[3 * contact_force + i]);
    addPlainAndContactTerms(contact, kick, sums);
    addOtherTerms(node, kick, reaction, othersOf(sums));
  }
  KOKKOS_INLINE_FUNCTION static KickSums& othersOf(KickSums& sums) { return sums; }
  template <class Others>
  KOKKOS_INLINE_FUNCTION static Others& othersOf(DeviceKickSums<Others>& sums) {
    return sums.others;
  }

  KOKKOS_INLINE_FUNCTION void addPlainAndContactTerms(const double (&contact)[3],
                                                      const NodeKick<double>& kick,
                                                      KickSums& sums) const {
    double term[num_plain_kick_terms];
    kick.terms(dt, term);
    for (int t = 0; t < num_plain_kick_terms; ++t)
      sums.add(plainKickTerm(t), term[t], scaleOf(plainScale(t)));
    addTermsOf(contact_force, contact, kick, sums);
  }
  template <class Others>
  KOKKOS_INLINE_FUNCTION void addPlainAndContactTerms(const double (&contact)[3],
                                                      const NodeKick<double>& kick,
                                                      DeviceKickSums<Others>& sums) const {
    double term[num_plain_kick_terms], of_contact[max_other_kick_terms];
    kick.terms(dt, term);
    for (int t = 0; t < num_plain_kick_terms; ++t)
      sums.plain.add(t, term[t], sums.scales[plainScale(t)]);
    sums.plain.endRow();
    if (isZero({contact[0], contact[1], contact[2]}))
      return;
    kick.otherTerms(contact, dt, of_contact);
    for (int t = 0; t < numOtherKickTerms(contact_force); ++t)
      sums.contact.add(t, of_contact[t], sums.scales[otherScale(t)]);
    sums.contact.endRow();
  }

  template <class Sums>
  KOKKOS_INLINE_FUNCTION void addTermsOf(int kind, const double (&force)[3],
                                         const NodeKick<double>& kick, Sums& sums) const {
    if (isZero({force[0], force[1], force[2]}))
      return;
    double term[max_other_kick_terms];
    kick.otherTerms(force, dt, term);
    for (int t = 0; t < numOtherKickTerms(kind); ++t)
      sums.add(otherKickTerm(kind, t), term[t], scaleOf(otherScale(t)));
  }
  // The loop over kinds, which is not unrolled, also keeps the sums out of a device's registers.
  template <class Sums>
  KOKKOS_INLINE_FUNCTION void addOtherTerms(std::int64_t node, const NodeKick<double>& kick,
                                            const Vec3& reaction, Sums& sums) const {
    const Vec3 old = {kick.old[0], kick.old[1], kick.old[2]}, v = {kick.v[0], kick.v[1], kick.v[2]};
    const Vec3 x = {kick.x[0], kick.x[1], kick.x[2]}, mean = 0.5 * (old + v);
    unsigned flags = 0; // see NodalForces::acts
    for (int kind = contact_force + 1; kind < kinds; ++kind)
      flags |= static_cast<unsigned>(acts[kind]) << kind;
    for (int kind = contact_force + 1; flags >> kind != 0; ++kind)
      if ((flags >> kind & 1u) != 0) {
        double force[3];
        for (int i = 0; i < 3; ++i)
          force[i] = quantum * static_cast<double>(forces(node, 3 * kind + i));
        addTermsOf(kind, force, kick, sums);
      }
    if (!isZero(reaction))
      addImpulse(sums, x, reaction, mean, kick_work_reaction, kick_impulse_reaction,
                 kick_moment_reaction);
    if (boundary.mass_damping > 0)
      addImpulse(sums, x, dampingImpulse(kick.mass, old, v), mean, kick_work_damping,
                 kick_impulse_damping, kick_moment_damping);
    const Vec3 apart = v - test.around;
    if (!(dot(apart, apart) <= test.limit * test.limit))
      sums.add(kick_fast_nodes, LimbSum{1, 0, 0});
  }

  // Adds an impulse that has no force column, with its work and its moment.
  template <class Sums>
  KOKKOS_INLINE_FUNCTION void addImpulse(Sums& sums, const Vec3& x, const Vec3& impulse,
                                         const Vec3& mean_velocity, int work_term, int impulse_term,
                                         int moment_term) const {
    sums.add(work_term, dot(impulse, mean_velocity), scales.energy);
    addVector(sums, impulse_term, impulse, scales.momentum);
    addVector(sums, moment_term, cross(x, impulse), scales.angular);
  }
  template <class Sums>
  KOKKOS_INLINE_FUNCTION static void addVector(Sums& sums, int first, const Vec3& value,
                                               const LimbScale& scale) {
    for (int i = 0; i < 3; ++i)
      sums.add(first + i, value[i], scale);
  }
  KOKKOS_INLINE_FUNCTION const LimbScale& scaleOf(int scale) const { // see plainScale()
    return scale == 0
               ? scales.energy
               : (scale == 1 ? scales.power : (scale == 2 ? scales.momentum : scales.angular));
  }
  KOKKOS_INLINE_FUNCTION static bool isZero(const Vec3& a) {
    return a.x == 0 && a.y == 0 && a.z == 0;
  }
};

// Kicks nodes first, first + stride, ... one by one, for sumStrided().
template <int kinds>
struct KickStrided {
  KickNode<kinds> node_kick;
  SplitScale scales[4]; // energy, power, momentum, angular
  int num_nodes;
  SumList<num_kick_terms> listed;

  KickStrided(const KickNode<kinds>& kick, int nodes)
      : node_kick(kick), scales{SplitScale::of(kick.scales.energy),
                                SplitScale::of(kick.scales.power),
                                SplitScale::of(kick.scales.momentum),
                                SplitScale::of(kick.scales.angular)},
        num_nodes(nodes) {
    for (int t = 0; t < num_plain_kick_terms; ++t)
      listed.add(plainKickTerm(t));
    for (int kind = contact_force; kind < kinds; ++kind)
      for (int t = 0; kick.acts[kind] && t < numOtherKickTerms(kind); ++t)
        listed.add(otherKickTerm(kind, t));
    if (kick.boundary.any) {
      listed.add(kick_work_reaction);
      listed.add(kick_impulse_reaction, 3);
      listed.add(kick_moment_reaction, 3);
    }
    if (kick.boundary.mass_damping > 0) {
      listed.add(kick_work_damping);
      listed.add(kick_impulse_damping, 3);
      listed.add(kick_moment_damping, 3);
    }
    listed.add(kick_fast_nodes);
  }

  template <class Sums>
  KOKKOS_INLINE_FUNCTION void operator()(std::int64_t first, std::int64_t stride,
                                         Sums& sums) const {
    DeviceKickSums<Sums> mine{sums, scales, {}, {}};
    bool has_contact = first < num_nodes && node_kick.mayTouch(first);
    for (std::int64_t node = first; node < num_nodes; node += stride) {
      const bool next_has = node_kick.mayTouch(minOf<std::int64_t>(node + stride, num_nodes - 1));
      node_kick.kickByStoredColumns(node, mine, has_contact);
      has_contact = next_has;
      if (mine.plain.rows() == mine.plain.max_rows)
        mine.fold();
    }
    mine.fold();
  }
};

} // namespace brickwall::mechanics
