// Penetration depth of two hexahedra, point-wise: the shortest translation that separates them, by
// the separating axis theorem (S. Gottschalk, M. C. Lin, D. Manocha, OBBTree, SIGGRAPH 1996). It is
// the least overlap of the projections of both on the normals of their faces and on the common
// normals of their edges. On any other axis they overlap at least as far, so additional axes do no
// harm.
#pragma once

#include "contact/base/vec3.hpp"

namespace brickwall::contact {

// Corners in Exodus order. Sides may be warped: the convex hull is tested, from which a side
// deviates by half its warp at most. Corners may coincide, as those of a wedge do.
struct Hexahedron {
  Vec3 corner[8];
};

namespace hexahedron {

// Sine below which two axes count as parallel: their overlaps differ by that fraction of a length.
constexpr double parallel = 1e-9;

// A set of directions without repeats.
struct Directions {
  static constexpr int most = 24;

  Vec3 unit[most];
  int count = 0;

  KOKKOS_INLINE_FUNCTION void add(const Vec3& direction) {
    const double length = norm(direction);
    if (!(length > 0))
      return;
    const Vec3 u = (1 / length) * direction;
    for (int i = 0; i < count; ++i)
      if (norm(cross(u, unit[i])) < parallel)
        return;
    unit[count++] = u;
  }
};

// Calls visit(a, b, c, d) for the corners of each side, in the order around it.
template <class Visit>
KOKKOS_INLINE_FUNCTION void forSides(const Hexahedron& hex, const Visit& visit) {
  constexpr int sides[6][4] = {{0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6},
                               {0, 4, 7, 3}, {0, 3, 2, 1}, {4, 5, 6, 7}};
  for (int side = 0; side < 6; ++side)
    visit(hex.corner[sides[side][0]], hex.corner[sides[side][1]], hex.corner[sides[side][2]],
          hex.corner[sides[side][3]]);
}

// Distance between the diagonals of a side; 0 if it is flat.
KOKKOS_INLINE_FUNCTION double warpOf(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 normal = cross(c - a, d - b);
  const double length = norm(normal);
  return length > 0 ? std::fabs(dot(normal, b - a)) / length : 0;
}
KOKKOS_INLINE_FUNCTION double largestWarp(const Hexahedron& hex) {
  double largest = 0;
  forSides(hex, [&](const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    largest = maxOf(largest, warpOf(a, b, c, d));
  });
  return largest;
}

// Normals of the hull; for warped sides those of both divisions into triangles.
KOKKOS_INLINE_FUNCTION Directions normalsOf(const Hexahedron& hex) {
  Directions normals;
  forSides(hex, [&](const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    normals.add(cross(b - a, d - a));
    normals.add(cross(c - b, a - b));
    normals.add(cross(d - c, b - c));
    normals.add(cross(a - d, c - d));
  });
  return normals;
}

// Edges of the hull; for warped sides also the diagonals.
KOKKOS_INLINE_FUNCTION Directions edgesOf(const Hexahedron& hex) {
  Directions edges;
  forSides(hex, [&](const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    edges.add(b - a);
    edges.add(c - b);
    edges.add(d - c);
    edges.add(a - d);
    if (warpOf(a, b, c, d) > parallel * norm(c - a)) {
      edges.add(c - a);
      edges.add(d - b);
    }
  });
  return edges;
}

// The projection of a hexahedron on an axis through `origin`.
struct Projection {
  double low = HUGE_VAL, high = -HUGE_VAL;

  KOKKOS_INLINE_FUNCTION Projection(const Hexahedron& hex, const Vec3& axis, const Vec3& origin) {
    for (int i = 0; i < 8; ++i) {
      const double at = dot(axis, hex.corner[i] - origin);
      low = minOf(low, at);
      high = maxOf(high, at);
    }
  }
};

// The distance that `a` must move along the axis, in either direction, to be separate from `b`;
// negative: minus their distance.
KOKKOS_INLINE_FUNCTION double overlapAlong(const Hexahedron& a, const Hexahedron& b,
                                           const Vec3& axis) {
  const Projection of_a(a, axis, a.corner[0]), of_b(b, axis, a.corner[0]);
  return minOf(of_a.high - of_b.low, of_b.high - of_a.low);
}

} // namespace hexahedron

// Penetration depth of two hexahedra, length. If it is at most `shallow`, any value up to `shallow`
// may be returned.
KOKKOS_INLINE_FUNCTION double overlapDepth(const Hexahedron& a, const Hexahedron& b,
                                           double shallow) {
  using namespace hexahedron;
  double depth = HUGE_VAL;
  const auto isShallowAlong = [&](const Vec3& axis) {
    depth = minOf(depth, overlapAlong(a, b, axis));
    return depth <= shallow;
  };
  const Directions normals[2] = {normalsOf(a), normalsOf(b)};
  for (const Directions& of_one : normals)
    for (int i = 0; i < of_one.count; ++i)
      if (isShallowAlong(of_one.unit[i]))
        return depth;
  const Directions edges_a = edgesOf(a), edges_b = edgesOf(b);
  for (int i = 0; i < edges_a.count; ++i)
    for (int j = 0; j < edges_b.count; ++j) {
      const Vec3 across = cross(edges_a.unit[i], edges_b.unit[j]);
      const double sine = norm(across);
      if (sine > parallel && isShallowAlong((1 / sine) * across))
        return depth;
    }
  return depth;
}

} // namespace brickwall::contact
