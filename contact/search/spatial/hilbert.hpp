// Hilbert codes: keys of points along a space filling curve without jumps (J. Skilling,
// "Programming the Hilbert curve", AIP Conf. Proc. 707, 2004). Runs of neighbours are more compact
// than on the Morton curve: clusters of sixteen nodes of a brick wall overlap half as many blocks
// of faces.
#pragma once

#include "contact/search/spatial/morton.hpp"

#include <cmath>

namespace brickwall::contact {

// Bits per axis that distinguish points `spacing` apart in a grid through a box of extent `length`:
// cells of about a sixteenth of the spacing. Fewer bits make the sort shorter.
inline int hilbertBits(double length, double spacing) {
  constexpr int most = morton_bits / 3;
  if (!(spacing > 0) || !(length > 0))
    return most;
  return static_cast<int>(
      minOf(maxOf(std::ceil(std::log2(length / spacing)) + 4, 1.0), double(most)));
}

// The code has 3 * bits bits. There are no branches, since half of them would be mispredicted.
KOKKOS_INLINE_FUNCTION std::uint64_t hilbertCode(const MortonGrid& grid, const Vec3& point,
                                                 int bits) {
  std::uint32_t cell[3];
  for (int d = 0; d < 3; ++d)
    cell[d] = cellOf(grid, point, d) >> (morton_bits / 3 - bits);
  for (std::uint32_t bit = 1u << (bits - 1); bit > 1; bit >>= 1) {
    const std::uint32_t below = bit - 1;
    for (int d = 0; d < 3; ++d) {
      const std::uint32_t is_set = 0u - ((cell[d] & bit) != 0); // all ones or none
      const std::uint32_t swap = (cell[0] ^ cell[d]) & below & ~is_set;
      cell[0] ^= swap | (below & is_set);
      cell[d] ^= swap; // no effect for d = 0
    }
  }
  cell[1] ^= cell[0];
  cell[2] ^= cell[1];
  std::uint32_t flip = 0;
  for (std::uint32_t bit = 1u << (bits - 1); bit > 1; bit >>= 1)
    flip ^= (bit - 1) & (0u - ((cell[2] & bit) != 0));
  std::uint64_t code = 0;
  for (int d = 0; d < 3; ++d)
    code |= spreadBits(cell[d] ^ flip) << (2 - d);
  return code;
}

} // namespace brickwall::contact
