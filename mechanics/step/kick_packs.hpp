// The kick of packs of consecutive nodes with their terms of the ledger. Included by
// central_difference.cpp and the sweeps over free bricks only.
#pragma once

#include "contact/base/lane_sums.hpp"
#include "contact/base/lanes.hpp"
#include "contact/base/pack_memory.hpp"
#include "mechanics/step/kick_kernel.hpp"

namespace brickwall::mechanics {

// Ledger sums of one of the other kinds of forces. Host code.
template <int kind, int W>
class OtherLaneSums {
public:
  using Real = PackOf<W>;
  static constexpr int num_terms = numOtherKickTerms(kind);

  // `force` is zero where a node is not owned.
  void add(const Real (&force)[3], const NodeKick<Real>& kick, double dt,
           const SplitScale (&scales)[4]) {
    Real term[max_other_kick_terms];
    kick.otherTerms(force, dt, term);
    for (int t = 0; t < num_terms; ++t)
      _lanes.add(t, term[t], scales[otherScale(t)]);
    _lanes.endRow();
  }
  void foldInto(KickSums& sums, const SplitScale (&scales)[4]) {
    const SplitScale* of_terms[num_terms];
    int index[num_terms];
    for (int t = 0; t < num_terms; ++t) {
      of_terms[t] = &scales[otherScale(t)];
      index[t] = otherKickTerm(kind, t);
    }
    _lanes.foldInto(sums, index, of_terms);
  }

private:
  LaneSums<num_terms, W> _lanes;
};

// Kicks packs of consecutive nodes and accumulates their ledger sums. Host code.
template <int kinds, int W>
class PackKicker {
public:
  using Real = PackOf<W>;
  using Integer = IntPackOf<W>;
  using Mask = MaskPackOf<W>;

  PackKicker(const KickNode<kinds>& node_kick, KickSums& sums)
      : _node_kick(node_kick), _sums(sums), _limit(node_kick.test.limit * node_kick.test.limit),
        _scales{SplitScale::of(node_kick.scales.energy), SplitScale::of(node_kick.scales.power),
                SplitScale::of(node_kick.scales.momentum),
                SplitScale::of(node_kick.scales.angular)},
        _has_constraints(node_kick.boundary.any) {}
  ~PackKicker() { fold(); }
  PackKicker(const PackKicker&) = delete;
  PackKicker& operator=(const PackKicker&) = delete;

  // Whether kickPlain() applies to nodes [first, first + W): no damping, no prescribed motion.
  KOKKOS_FORCEINLINE_FUNCTION bool isFree(std::int64_t first) const {
    if (_node_kick.boundary.mass_damping > 0)
      return false;
    if (!_has_constraints)
      return true;
    std::uint16_t words[3 * W / 2], any = 0;
    memcpy(words, &_node_kick.boundary.motion(first, 0), sizeof words);
    for (const std::uint16_t word : words)
      any |= word;
    return any == 0;
  }
  // The same for the first `count` nodes.
  bool isFree(std::int64_t first, int count) const {
    if (_node_kick.boundary.mass_damping > 0)
      return false;
    unsigned char any = 0;
    if (_has_constraints)
      for (int k = 0; k < 3 * count; ++k)
        any |= (&_node_kick.boundary.motion(first, 0))[k];
    return any == 0;
  }

  // Kicks nodes [first, first + W), all owned, by the internal force `f` alone.
  KOKKOS_FORCEINLINE_FUNCTION void kickPlain(std::int64_t first, const Integer (&f)[3]) {
    kickLanes(
        first, W, f, f, [](const Real& a) { return a; }, [] { return firstLanes<W>(W); });
  }
  // Kicks the first `count` nodes; `owned` marks those that are owned.
  __attribute__((noinline)) void kickSome(std::int64_t first, int count, const Integer (&f)[3],
                                          const Mask& owned) {
    kickLanes(
        first, count, f, f, [&](const Real& a) { return whereOrZero(owned, a); },
        [&] { return owned; });
  }

  // Kicks one node. Not inlined: it is rare and would fill the instruction cache of the sweeps.
  __attribute__((noinline)) void kickOne(std::int64_t node,
                                         const std::int64_t (&columns)[3 * kinds]) {
    _node_kick.kickByColumns(node, columns, _sums);
  }

  // Kicks the first `count` nodes by all forces and constraints.
  void kick(std::int64_t first, int count) {
    if (!(count == W ? isFree(first) : isFree(first, count))) {
      for (int lane = 0; lane < count; ++lane)
        _node_kick(first + lane, _sums);
      return;
    }
    const KickNode<kinds>& k = _node_kick;
    Integer f[kinds][3], total[3];
    bool any_of[kinds] = {};
    prefetchOperands(first + 8 * W);
    for (int kind = 0; kind < kinds; ++kind)
      if (kind == internal_force || k.acts[kind]) {
        for (int i = 0; i < 3; ++i)
          f[kind][i] = loadSome<Integer>(&k.forces(first, 3 * kind + i), count);
        std::uint64_t bits[W];
        storePack(Integer(f[kind][0].v | f[kind][1].v | f[kind][2].v), bits);
        any_of[kind] = anyBitIn(bits);
      }
    for (int i = 0; i < 3; ++i) {
      total[i] = f[internal_force][i];
      for (int kind = internal_force + 1; kind < kinds; ++kind)
        if (any_of[kind])
          total[i] = total[i] + f[kind][i];
    }
    const Mask owned = loadFlags<W>(&k.is_owned(first), count);
    const auto ifOwned = [&](const Real& a) { return whereOrZero(owned, a); };
    const NodeKick<Real> kick =
        kickLanes(first, count, f[internal_force], total, ifOwned, [&] { return owned; });
    forOthers([&](auto& sums, int kind) {
      if (!any_of[kind])
        return;
      Real force[3];
      for (int i = 0; i < 3; ++i)
        force[i] = ifOwned(k.quantum * toReal(f[kind][i]));
      sums.add(force, kick, k.dt, _scales);
    });
  }

private:
  KOKKOS_FORCEINLINE_FUNCTION void prefetchOperands(std::int64_t node) const {
    const KickNode<kinds>& k = _node_kick;
    for (int column = 0; column < 3 * kinds; ++column)
      if (column < 3 || k.acts[column / 3])
        prefetch(k.forces.data() + column * k.forces.stride(1) + node);
    for (int line = 0; line < 3; ++line) {
      const std::int64_t at = 3 * node + W * line;
      prefetch(k.velocity.data() + at);
      prefetch(k.displacement.data() + at);
      prefetch(k.reference.data() + at);
    }
    prefetch(k.mass.data() + node);
  }

  // Kicks by `total`, of which `f` is the internal force. `ifOwned` sets a number to 0 in the lanes
  // that are not owned; `owned` returns the mask.
  template <class IfOwned, class Owned>
  KOKKOS_FORCEINLINE_FUNCTION NodeKick<Real>
  kickLanes(std::int64_t first, int count, const Integer (&f)[3], const Integer (&total)[3],
            const IfOwned& ifOwned, const Owned& owned) {
    const KickNode<kinds>& k = _node_kick;
    NodeKick<Real> kick;
    Real total_force[3];
    loadSomeTriples(&k.velocity(first, 0), count, kick.old);
    loadSumOfTriples(&k.reference(first, 0), &k.displacement(first, 0), count, kick.x);
    kick.mass = loadSome<Real>(&k.mass(first), count);
    for (int i = 0; i < 3; ++i) {
      kick.force[i] = k.quantum * toReal(f[i]);
      total_force[i] = k.quantum * toReal(total[i]);
    }
    kick.accelerate(total_force, k.dt, k.boundary.gravity);
    storeSomeTriples(kick.v, count, &k.velocity(first, 0));
    kick.mass = ifOwned(kick.mass);
    for (int i = 0; i < 3; ++i)
      kick.force[i] = ifOwned(kick.force[i]);
    Real term[num_plain_kick_terms];
    kick.terms(k.dt, term);
    for (int t = 0; t < num_plain_kick_terms; ++t)
      _lanes.add(t, term[t], _scales[plainScale(t)]);
    _lanes.endRow();
    if (__builtin_expect(++_rows == LaneSums<num_plain_kick_terms, W>::max_rows, 0))
      fold();
    if (__builtin_expect(_limit < HUGE_VAL, 0))
      countFast(kick.v[0], kick.v[1], kick.v[2], owned());
    return kick;
  }

  // verb(its OtherLaneSums, kind) of each of the kinds after internal_force.
  template <class Verb>
  void forOthers(const Verb& verb) {
    if constexpr (kinds > contact_force)
      verb(_contact, contact_force);
    if constexpr (kinds > external_force)
      verb(_external, external_force);
    if constexpr (kinds > viscous_force)
      verb(_viscous, viscous_force);
  }

  __attribute__((noinline)) void countFast(Real vx, Real vy, Real vz, Mask owned) {
    const Real v[3] = {vx, vy, vz};
    const Vec3& around = _node_kick.test.around;
    const Real apart[3] = {v[0] - around.x, v[1] - around.y, v[2] - around.z};
    const Real square = NodeKick<Real>::dotOf(apart, apart);
    const Mask fast = (!(square <= Real(_limit))) & owned;
    if (isAny(fast))
      for (int lane = 0; lane < W; ++lane)
        _sums.sum[kick_fast_nodes].high -= fast.v[lane];
  }
  __attribute__((noinline)) void fold() {
    const SplitScale* scales[num_plain_kick_terms];
    for (int t = 0; t < num_plain_kick_terms; ++t)
      scales[t] = &_scales[plainScale(t)];
    _lanes.foldInto(_sums, PlainKickTerms::index, scales);
    forOthers([&](auto& sums, int) { sums.foldInto(_sums, _scales); });
    _rows = 0;
  }

  const KickNode<kinds>& _node_kick;
  KickSums& _sums;
  double _limit;
  SplitScale _scales[4]; // energy, power, momentum, angular
  bool _has_constraints;
  LaneSums<num_plain_kick_terms, W> _lanes;
  OtherLaneSums<contact_force, W> _contact;
  OtherLaneSums<external_force, W> _external;
  OtherLaneSums<viscous_force, W> _viscous;
  int _rows = 0;
};

} // namespace brickwall::mechanics
