// Surfaces that are difficult for a search in floats: boxes that are equal in floats but not in
// doubles, identical boxes, one box that overlaps all others. They complement the random surfaces
// of search_cases.hpp.
#pragma once

#include "tests/contact/search/search_cases.hpp"

#include <limits>

namespace brickwall::contact::test {

// Corners near a lattice, each coordinate off by at most two units in the last place: boxes barely
// touch, or barely do not.
inline void addTouching(SurfaceCase& c, Random& random, double offset, double spacing) {
  addQuads(c, 40 + random.below(80), 12, random, [&](int q, int k) {
    Random at(static_cast<std::uint64_t>(q) + 1000 * c.seed);
    Point x{};
    for (int d = 0; d < 3; ++d) {
      x[d] = offset + spacing * (at.below(4) + (d < 2 ? (k + d) / 2 % 2 : 0));
      for (int ulps = random.below(3); ulps > 0; --ulps)
        x[d] = std::nextafter(x[d], random.chance(0.5) ? HUGE_VAL : -HUGE_VAL);
    }
    return x;
  });
}

inline SurfaceCase makeHardCase(std::uint64_t seed, int num_ranks) {
  SurfaceCase c;
  Random random(seed + 5000);
  c.seed = seed;
  switch (seed % 6) {
  case 0:
    c.kind = "touching to the last place";
    addTouching(c, random, 0, 0.5);
    break;
  case 1:
    c.kind = "touching to the last place, inflated";
    addTouching(c, random, 1, 0.5);
    c.node_tolerance = random.chance(0.5) ? 0.25 : 0.1;
    c.face_tolerance = random.chance(0.5) ? 0.25 : 0.15;
    break;
  case 2: { // far from the origin, where a float is as wide as the mesh
    c.kind = "touching, far out";
    const double offset = random.chance(0.5) ? 1e9 : -3e13;
    addTouching(c, random, offset, 0.5);
    break;
  }
  case 3: {
    c.kind = "jittered wall, far out";
    addWall(c, random, 1 + random.below(2));
    moveNodes(c, random, 0.01, 0.005);
    for (auto& node : c.nodes)
      for (int d = 0; d < 3; ++d) {
        node.x_old[d] += 1e7 * (d - 1.5);
        node.x_new[d] += 1e7 * (d - 1.5);
      }
    c.node_tolerance = 0.02;
    c.face_tolerance = 0.03;
    break;
  }
  case 4:
    c.kind = "all the same";
    addQuads(c, 200, 5, random, [](int, int k) { return Point{k % 2 * 1.0, k / 2 * 1.0, 0.1}; });
    break;
  default: { // one face over all others
    c.kind = "one huge box";
    addWall(c, random, 1);
    moveNodes(c, random, 0.01, 0.005);
    std::array<int, 4> corners{};
    for (int k = 0; k < 4; ++k)
      corners[k] =
          addNode(c, 9999, {k % 2 == 0 ? -50. : 50., k / 2 == 0 ? -50. : 50., 50. - k * 30});
    addFace(c, 9999, corners);
    c.node_tolerance = c.face_tolerance = 0.025;
    break;
  }
  }
  distribute(c, random, num_ranks);
  return c;
}

} // namespace brickwall::contact::test
