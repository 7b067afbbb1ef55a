// Magnitudes of a scene in which a mistake in the units of its deck shows, for `brickwall check`.
#pragma once

#include "miniapp/scene/scene.hpp"

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace brickwall::miniapp {

struct Magnitudes {
  // Times in which a compression wave crosses a body along the shortest and the longest edge of
  // any body's box, in the slowest material of that body.
  double shortest_crossing = HUGE_VAL, longest_crossing = 0; // time
  double mass = 0; // of all bodies
  // The next three are of walls only.
  // Lowest natural frequency in bending across the wall, 1/time: of a cantilever on the base that
  // is one piece (Euler-Bernoulli), (1.8751^2/(2 pi)) (t/sqrt(12)) sqrt(E/density)/H^2.
  double frequency = 0;
  std::vector<double> speeds; // [pressure] of a brick, by impulse over mass per area, length/time
  int elements_through = 0; // a brick, along its shortest edge
  // Pressure in joints: the largest of peak loads, of the weight on the base of a wall, and of
  // impacts of equal bodies at the initial velocities v and -v, density c v.
  double joint_pressure = 0;
  const char* pressure_source = "";
  // Of joints under it, length: contact/theory.md, equation (42), for the shortest edge of all faces
  // and the least density. It is exact for matching meshes with element.mass = "row_sum"; with
  // "inertia" joints are 1.9, 1.3 and 1.1 times as soft at 2, 4 and 8 elements through a brick.
  double penetration = 0;
  double joint_compliance = 0; // in elements of that edge
};

// Magnitudes of `config` where `scene` is its scene or, of a wall, a smaller one of the same bricks.
// `dt` is the time step. Collective; the same on all ranks.
Magnitudes magnitudesOf(MPI_Comm comm, const Config& config, const Scene& scene, double dt);

// Relative frequency error (rms) of the first modes of a brick with n elements through its
// thickness, measured by verification case V22 (8.4, 1.57 and 0.39 % for n = 2, 4, 8).
inline double frequencyError(int n) {
  return 0.25 / (static_cast<double>(n) * n);
}

// One line for each magnitude that is absurd, or rare, in any consistent set of units, and for wave
// speeds outside 20 to 20,000 m/s: where gravity is that of the earth, in the units of length and
// time that it suggests (m-s, mm-s, mm-ms, cm-s, cm-us), otherwise beyond 2e7, which is mm/s.
std::vector<std::string> absurdMagnitudes(const Config& config, const Magnitudes& magnitudes,
                                          std::int64_t steps);

} // namespace brickwall::miniapp
