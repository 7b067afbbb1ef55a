// Nodal forces of one interaction as integers, eq. (35) of theory.md: each is rounded once; the
// last corner takes the remainder, so that the sum over the pair is exactly zero. Kernel part.
#pragma once

#include "contact/base/fixed_point.hpp"
#include "contact/enforcement/law/coulomb_friction.hpp"
#include "contact/surface/face_access.hpp"

namespace brickwall::contact {

// [node of the pushing point][xyz], [corner][xyz]; corners from `face_corners` on are not set.
struct PairQuanta {
  std::int64_t on_point[2][3];
  std::int64_t on_corner[4][3];
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
  FaceAccess faces = {{}, GhostFaces::none()};
  ContactForces target;
  double inverse_quantum = 1;
  int face_corners = 4; // 4; 2 if only the first two corners of a face carry weight
  bool has_friction = false;
  bool is_alone = false; // no other thread adds at the same time

  // Returns false if a force is not finite or too large. Without friction `friction` is not read;
  // `fading` is read only if fade_weight < 1.
  KOKKOS_INLINE_FUNCTION bool round(const Interaction& pair, const FrictionSpring& friction,
                                    const FadingForce& fading, PairQuanta& quanta) const {
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
    for (int j = 0; j < face_corners; ++j)
      largest += std::fabs(besides.on_corner[j]);
    if (!fitsFixedPoint(fixed_point_share * inverse_quantum * largest))
      return false;
    for (int d = 0; d < 3; ++d) {
      const double whole = inverse_quantum * force[d];
      const double per_normal = inverse_quantum * pair.normal[d];
      const std::int64_t rounded = roundToFixed(whole);
      quanta.on_point[1][d] =
          pair.point.isNode()
              ? 0
              : roundToFixed(pair.point.share * whole + per_normal * besides.on_end);
      quanta.on_point[0][d] = rounded - quanta.on_point[1][d];
      std::int64_t rest = -rounded;
      for (int j = 0; j < face_corners - 1; ++j) {
        quanta.on_corner[j][d] =
            roundToFixed(-pair.weight[j] * whole + per_normal * besides.on_corner[j]);
        rest -= quanta.on_corner[j][d];
      }
      quanta.on_corner[face_corners - 1][d] = rest;
    }
    return true;
  }

  KOKKOS_INLINE_FUNCTION bool round(const ContactHistory& pairs, std::int64_t i,
                                    PairQuanta& quanta) const {
    const Interaction& pair = pairs.interactions(i);
    return round(pair, has_friction ? pairs.friction(i) : FrictionSpring(),
                 pair.fade_weight < 1 ? pairs.fading(i) : FadingForce(), quanta);
  }

  // `sign` 1 adds the forces, -1 removes them.
  KOKKOS_INLINE_FUNCTION void add(const Interaction& pair, const PairQuanta& quanta,
                                  int sign) const {
    if (is_alone)
      addBy<Alone>(pair, quanta, sign);
    else
      addBy<Together>(pair, quanta, sign);
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
  template <class How>
  KOKKOS_FORCEINLINE_FUNCTION void addBy(const Interaction& pair, const PairQuanta& quanta,
                                         int sign) const {
    addTo<How>(target.nodes, pair.point.node[0], 0, quanta.on_point[0], sign);
    if (!pair.point.isNode())
      addTo<How>(target.nodes, pair.point.node[1], 0, quanta.on_point[1], sign);
    const int face = pair.face_index;
    if (faces.isOwn(face))
      for (int j = 0; j < face_corners; ++j)
        addTo<How>(target.nodes, faces.surface.face_to_nodes(face, j), 0, quanta.on_corner[j],
                   sign);
    else
      for (int j = 0; j < face_corners; ++j)
        addTo<How>(target.ghost_corners, faces.ghostOf(face), 3 * j, quanta.on_corner[j], sign);
  }
  template <class How, class ViewType>
  KOKKOS_FORCEINLINE_FUNCTION static void addTo(const ViewType& rows, int row, int first,
                                                const std::int64_t (&values)[3], int sign) {
    for (int d = 0; d < 3; ++d)
      How::add(rows(row, first + d), sign * values[d]);
  }
};

} // namespace brickwall::contact
