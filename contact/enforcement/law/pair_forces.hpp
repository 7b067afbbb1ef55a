// Nodal forces of one interaction as integers, eq. (35) of theory.md: each is rounded once; the
// last corner takes the remainder, so that the sum over the pair is exactly zero. Kernel part.
#pragma once

#include "contact/base/fixed_pack.hpp"
#include "contact/base/lane_arrays.hpp"
#include "contact/enforcement/law/coulomb_friction.hpp"
#include "contact/enforcement/law/node_owners.hpp"
#include "contact/surface/face_access.hpp"

namespace brickwall::contact {

// The forces of one interaction in quanta, or of one in each lane. `fits` is false if a force is
// not finite or too large.
template <class Real>
struct PairQuanta {
  using Integer = decltype(toFixed(Real()));
  using Integers = LaneIntegers<Real, Integer>;
  Integers on_point[2][3]; // [node of the pushing point][xyz]
  Integers on_corner[4][3]; // [corner][xyz]; corners without weight are not set
  typename MaskOf<Real>::type fits;

  // The force on the pushing point, of which `share` acts on its second node, and its opposite on
  // the corners of the face, with `besides` on single nodes along the normal, if given.
  template <int face_corners>
  KOKKOS_FORCEINLINE_FUNCTION void
  set(const Triple<Real>& force, const Triple<Real>& normal, const Real& share,
      const Real (&weight)[4], double inverse_quantum, const NormalForces* besides = nullptr) {
    const Real forces[3] = {force.x, force.y, force.z}, along[3] = {normal.x, normal.y, normal.z};
    for (int d = 0; d < 3; ++d) {
      const Real whole = inverse_quantum * forces[d];
      const auto partOf = [&](const Real& part, double beside) {
        return besides == nullptr ? part : part + (inverse_quantum * along[d]) * beside;
      };
      const Integer rounded = toFixed(whole);
      if constexpr (face_corners == 2) {
        const Integer on_end = toFixed(partOf(share * whole, besides ? besides->on_end : 0));
        on_point[1][d] = on_end;
        on_point[0][d] = rounded - on_end;
      } else {
        on_point[0][d] = rounded;
      }
      Integer rest = -rounded;
      for (int j = 0; j < face_corners - 1; ++j) {
        const Integer part =
            toFixed(partOf(-weight[j] * whole, besides ? besides->on_corner[j] : 0));
        on_corner[j][d] = part;
        rest = rest - part;
      }
      on_corner[face_corners - 1][d] = rest;
    }
  }
  // Leaves the change since `before`, of a pair with four corners.
  KOKKOS_FORCEINLINE_FUNCTION void subtract(const PairQuanta& before) {
    for (int d = 0; d < 3; ++d) {
      on_point[0][d] = Integer(on_point[0][d]) - Integer(before.on_point[0][d]);
      for (int j = 0; j < 4; ++j)
        on_corner[j][d] = Integer(on_corner[j][d]) - Integer(before.on_corner[j][d]);
    }
  }
};

// Contact forces in quanta. They are partial sums: the caller returns ghost_corners to their owners
// (reverseSum) and sums over the ranks that share a node.
struct ContactForces {
  View<std::int64_t* [3]> nodes; // [surface node][xyz]
  View<std::int64_t* [12]> ghost_corners; // [ghost face][3 * corner + xyz]; rows [0, ghosts.count)
};

// Limit of a pair's forces, as a share of the fixed-point range, since a node takes part in several
// pairs.
constexpr double fixed_point_share = 4;
inline double largestPairForce(const Quantum& quantum) {
  return fixed_point_limit / fixed_point_share * quantum.value;
}

struct PairForces {
  // The bound of loops over corners: with a constant one, devices keep arrays in registers.
  static constexpr int max_corners = 4;

  FaceAccess faces = {{}, GhostFaces::none()};
  ContactForces target;
  double inverse_quantum = 1;
  int face_corners = 4; // 4; 2 if only the first two corners of a face carry weight
  bool has_friction = false;
  bool is_alone = false; // no other thread adds at the same time
  NodeOwners owners; // if areKnown(), addOthers() completes `target` after the kernel

  // Normal forces only.
  template <class Real>
  KOKKOS_FORCEINLINE_FUNCTION void round(const Real& force, const Triple<Real>& normal,
                                         const Real& share, const Real (&weight)[4],
                                         PairQuanta<Real>& quanta) const {
    if (face_corners == 4)
      quanta.template set<4>(force * normal, normal, share, weight, inverse_quantum);
    else
      quanta.template set<2>(force * normal, normal, share, weight, inverse_quantum);
    quanta.fits = fitsFixedPoint(fixed_point_share * inverse_quantum * force);
  }
  // All forces. Without friction `friction` is not read; `fading` is read only if fade_weight < 1.
  KOKKOS_INLINE_FUNCTION void round(const Interaction& pair, const FrictionSpring& friction,
                                    const FadingForce& fading, PairQuanta<double>& quanta) const {
    Vec3 force = (pair.force + pair.damping) * pair.normal;
    double largest = pair.force + pair.damping;
    NormalForces besides;
    if (has_friction) {
      force += friction.force;
      largest += norm(friction.force);
      addCouple(friction, pair, face_corners, besides);
    }
    if (pair.fade_weight < 1) {
      force += fading.on_node;
      largest += norm(fading.on_node);
      besides.add(fading.normal);
    }
    largest += std::fabs(besides.on_end);
    for (int j = 0; j < max_corners; ++j)
      largest += j < face_corners ? std::fabs(besides.on_corner[j]) : 0.0;
    if (face_corners == 4)
      quanta.set<4>(triple(force), triple(pair.normal), pair.point.share, pair.weight,
                    inverse_quantum, &besides);
    else
      quanta.set<2>(triple(force), triple(pair.normal), pair.point.share, pair.weight,
                    inverse_quantum, &besides);
    quanta.fits = fitsFixedPoint(fixed_point_share * inverse_quantum * largest);
  }
  KOKKOS_INLINE_FUNCTION void round(const ContactHistory& pairs, std::int64_t i,
                                    PairQuanta<double>& quanta) const {
    const Interaction& pair = pairs.interactions(i);
    round(pair, has_friction ? pairs.friction(i) : FrictionSpring(),
          pair.fade_weight < 1 ? pairs.fading(i) : FadingForce(), quanta);
  }

  // The forces of one lane. `sign` 1 adds them, -1 removes them.
  template <class Real>
  KOKKOS_INLINE_FUNCTION void add(const Interaction& pair, const PairQuanta<Real>& quanta, int sign,
                                  int lane = 0) const {
    if (is_alone)
      addBy<Alone>(pair, quanta, sign, lane);
    else if (fills_lanes && owners.areKnown())
      addBy<Together, true>(pair, quanta, sign, lane);
    else
      addBy<Together>(pair, quanta, sign, lane);
  }

  // Prefetches what the forces of a pair of this node and face are added to.
  KOKKOS_FORCEINLINE_FUNCTION void prefetchTarget(int node, int face) const {
    prefetchRow(target.nodes, node);
    faces.prefetchCorners(face, target.nodes);
  }
  // Adds the magnitudes, along each axis, of the nodal forces by which a normal force `change`
  // acts; beyond the fixed-point range nothing.
  KOKKOS_INLINE_FUNCTION void addMagnitude(const Interaction& pair, double change) const {
    const double along[3] = {pair.normal.x, pair.normal.y, pair.normal.z};
    PairQuanta<double> quanta;
    for (int d = 0; d < 3; ++d) {
      const double whole = std::fabs(inverse_quantum * along[d] * change);
      quanta.on_point[0][d] = toFixed(std::fabs(1 - pair.point.share) * whole);
      quanta.on_point[1][d] = toFixed(std::fabs(pair.point.share) * whole);
      for (int j = 0; j < max_corners; ++j)
        if (j < face_corners)
          quanta.on_corner[j][d] = toFixed(std::fabs(pair.weight[j]) * whole);
    }
    add(pair, quanta, 1);
  }

private:
  struct Alone {
    KOKKOS_FORCEINLINE_FUNCTION static void add(std::int64_t& to, std::int64_t value) {
      to += value;
    }
  };
  struct Together {
    KOKKOS_FORCEINLINE_FUNCTION static void add(std::int64_t& to, std::int64_t value) {
      Kokkos::atomic_add(&to, value);
    }
  };

  // `by_owner`: without atomic operations at the nodes that this thread owns.
  template <class How, bool by_owner = false, class Real>
  KOKKOS_FORCEINLINE_FUNCTION void addBy(const Interaction& pair, const PairQuanta<Real>& quanta,
                                         int sign, int lane) const {
    const int thread = by_owner ? threadNumber() : 0;
    addToNode<How, by_owner>(pair.point.node[0], quanta.on_point[0], sign, lane, thread);
    if (!pair.point.isNode())
      addToNode<How, by_owner>(pair.point.node[1], quanta.on_point[1], sign, lane, thread);
    const int face = pair.face_index;
    if (faces.isOwn(face))
      for (int j = 0; j < max_corners; ++j) {
        if (j < face_corners)
          addToNode<How, by_owner>(faces.surface.face_to_nodes(face, j), quanta.on_corner[j], sign,
                                   lane, thread);
      }
    else
      for (int j = 0; j < max_corners; ++j) {
        if (j < face_corners)
          addTo<How>(target.ghost_corners, faces.ghostOf(face), 3 * j, quanta.on_corner[j], sign,
                     lane);
      }
  }
  template <class How, bool by_owner, class Integers>
  KOKKOS_FORCEINLINE_FUNCTION void addToNode(int node, const Integers (&values)[3], int sign,
                                             int lane, int thread) const {
    if (!by_owner) {
      addTo<How>(target.nodes, node, 0, values, sign, lane);
    } else if (owners.owns(thread, NodeOwners::blockOf(node))) {
      addTo<Alone>(target.nodes, node, 0, values, sign, lane);
    } else {
      addTo<How>(owners.by_others, node, 0, values, sign, lane);
      storeShared(owners.has_others(NodeOwners::blockOf(node)), static_cast<unsigned char>(1));
    }
  }
  template <class How, class ViewType, class Integers>
  KOKKOS_FORCEINLINE_FUNCTION static void addTo(const ViewType& rows, int row, int first,
                                                const Integers (&values)[3], int sign, int lane) {
    for (int d = 0; d < 3; ++d)
      How::add(rows(row, first + d), sign * values[d][lane]);
  }
};

} // namespace brickwall::contact
