// Morton codes: 63-bit Z-order keys of points in a box (G. M. Morton 1966; paper, section 5).
// Neighbouring points mostly get neighbouring keys, so sorting by them makes tree nodes compact and
// the queries of one chunk similar.
#pragma once

#include "contact/base/box.hpp"

#include <cstdint>

namespace brickwall::contact {

using morton_code = std::uint64_t;
constexpr int morton_bits = 63; // 21 per axis

// A grid of 2^21 cubic cells along the longest edge of a box. The cells are cubes whatever the
// shape of the box: a wall is thin.
struct MortonGrid {
  double lower[3] = {0, 0, 0};
  double cells_per_length = 0;

  MortonGrid() = default;
  explicit MortonGrid(const Box& all) {
    if (all.empty())
      return;
    double edge = 0;
    for (int d = 0; d < 3; ++d) {
      lower[d] = all.lower[d];
      edge = maxOf(edge, all.upper[d] - all.lower[d]);
    }
    if (edge > 0)
      cells_per_length = 2097151.0 / edge; // 2^21 - 1; all in cell 0 when the box is one point
  }
};

// Spreads the low 21 bits of v to every third bit.
KOKKOS_INLINE_FUNCTION std::uint64_t spreadBits(std::uint64_t v) {
  v &= 0x1fffff;
  v = (v | v << 32) & 0x001f00000000ffff;
  v = (v | v << 16) & 0x001f0000ff0000ff;
  v = (v | v << 8) & 0x100f00f00f00f00f;
  v = (v | v << 4) & 0x10c30c30c30c30c3;
  v = (v | v << 2) & 0x1249249249249249;
  return v;
}

// Points outside the box of the grid get the nearest cell; coordinates that are not finite get cell
// 0 or the last.
KOKKOS_INLINE_FUNCTION std::uint32_t cellOf(const MortonGrid& grid, const Vec3& point, int d) {
  const double cell = (point[d] - grid.lower[d]) * grid.cells_per_length;
  return static_cast<std::uint32_t>(cell > 0 ? minOf(cell, 2097151.0) : 0.0); // NaN: 0
}

KOKKOS_INLINE_FUNCTION morton_code mortonCode(const MortonGrid& grid, const Vec3& point) {
  morton_code code = 0;
  for (int d = 0; d < 3; ++d)
    code |= spreadBits(cellOf(grid, point, d)) << (2 - d);
  return code;
}

} // namespace brickwall::contact
