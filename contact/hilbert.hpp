// Hilbert codes: 63-bit keys of points along a space filling curve without jumps (Skilling, "Programming the Hilbert
// curve", AIP Conf. Proc. 707, 2004). Runs of neighbours on it are more compact than on the Morton curve: clusters of
// sixteen nodes of a brick wall meet half as many blocks of faces.
#pragma once

#include "contact/morton.hpp"

namespace brickwall::contact {

KOKKOS_INLINE_FUNCTION std::uint64_t hilbertCode(const MortonGrid& grid, const Vec3& point) {
  constexpr int bits = morton_bits / 3;
  std::uint32_t cell[3];
  for (int d = 0; d < 3; ++d)
    cell[d] = cellOf(grid, point, d);
  for (std::uint32_t bit = 1u << (bits - 1); bit > 1; bit >>= 1) {
    const std::uint32_t below = bit - 1;
    for (int d = 0; d < 3; ++d) {
      if (cell[d] & bit) {
        cell[0] ^= below;
      } else {
        const std::uint32_t swap = (cell[0] ^ cell[d]) & below;
        cell[0] ^= swap;
        cell[d] ^= swap;
      }
    }
  }
  cell[1] ^= cell[0];
  cell[2] ^= cell[1];
  std::uint32_t flip = 0;
  for (std::uint32_t bit = 1u << (bits - 1); bit > 1; bit >>= 1)
    if (cell[2] & bit)
      flip ^= bit - 1;
  std::uint64_t code = 0;
  for (int d = 0; d < 3; ++d)
    code |= spreadBits(cell[d] ^ flip) << (2 - d);
  return code;
}

} // namespace brickwall::contact
