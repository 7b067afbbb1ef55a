// Magnitudes of a scene in which a mistake in the units of its deck shows: `brickwall check` prints
// them, and a run warns of absurd ones too.
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
  // Lowest natural frequency in bending across the wall, 1/time: of a cantilever that is one piece
  // (Euler-Bernoulli), (1.8751^2/(2 pi)) (t/sqrt(12)) sqrt(E/density)/H^2. H is the height above
  // the fixed base or base course; 0 if neither is fixed.
  double frequency = 0;
  std::vector<double> speeds; // [pressure] of a brick, by impulse over mass per area, length/time
  int elements_through = 0; // a brick, along its shortest edge
  // Pressure in joints: the largest of peak loads, of the weight on the base of a wall, of impacts
  // of equal bodies at the initial velocities v and -v, density c v, and of the wave that nodes
  // prescribed to move at v send into a body at rest, density c v too.
  double joint_pressure = 0;
  const char* pressure_source = "";
  // Of joints under it, length: contact/theory.md, equation (42), for the shortest edge of all
  // faces and the least density, exact for matching meshes with element.mass = "row_sum"; of walls,
  // times jointSoftness().
  double penetration = 0;
  double joint_compliance = 0; // in elements of that edge
};

// Magnitudes of `config` where `scene` is its scene or, of a wall, a smaller one of the same
// bricks.
// `dt` is the time step. Collective; the same on all ranks.
Magnitudes magnitudesOf(MPI_Comm comm, const Config& config, const Scene& scene, double dt);

// How much softer than with row sums joints of bricks with n elements through their thickness are:
// 1.9, 1.3 and 1.1 times for n = 2, 4 and 8 with masses that have the inertia of the body, which
// are smaller at its surface. A single element cannot have it, and keeps its row sums.
inline double jointSoftness(NodalMass mass, int n) {
  return mass == NodalMass::row_sum || n < 2 ? 1 : 1 + 2.7 * std::pow(n, -1.585);
}

// Relative frequency error (rms) of the first modes of a brick with n >= 2 elements through its
// thickness, fitted to verification case V22: 8.4, 1.57 and 0.39 % for n = 2, 4 and 8; with row
// sums 23.5, 5.0 and 1.30 %.
inline double frequencyError(NodalMass mass, int n) {
  const double square = static_cast<double>(n) * n, fourth = square * square;
  return mass == NodalMass::row_sum ? 0.82 / square * (1 + 2.3 / fourth)
                                    : 0.247 / square * (1 + 5.76 / fourth);
}

// Densities and wave speeds of solids to compare those of the deck with, in SI units, and the wave
// speeds in the units of length and time that gravity suggests.
std::string usualValues(const Config& config);

// One line for each magnitude that is absurd, or rare, in any consistent set of units, and for wave
// speeds outside 20 to 20,000 m/s: where gravity is that of the earth, in the units of length and
// time that it suggests (m-s, mm-s, mm-ms, cm-s, cm-us); otherwise in m-s if the density is of a
// solid in kg/m3 (100 to 25,000), or else beyond 2e7, which is mm/s.
std::vector<std::string> absurdMagnitudes(const Config& config, const Magnitudes& magnitudes,
                                          std::int64_t steps);

} // namespace brickwall::miniapp
