// Resultant force and moment of a scene.
#pragma once

#include "tests/contact/enforcement/support/scene_run.hpp"

namespace brickwall::contact::testing {

struct Resultant {
  std::array<std::int64_t, 3> sum = {0, 0, 0}; // quanta
  Vec3 moment; // about the origin, quanta * length
  double reach = 0; // largest distance from the origin of a node with a force
};

inline Resultant resultantOf(const Scene& scene,
                             const std::vector<std::array<std::int64_t, 3>>& force) {
  Resultant r;
  for (std::size_t i = 0; i < force.size(); ++i) {
    for (int d = 0; d < 3; ++d)
      r.sum[d] += force[i][d];
    const Vec3 f = {static_cast<double>(force[i][0]), static_cast<double>(force[i][1]),
                    static_cast<double>(force[i][2])};
    r.moment += cross(scene.x_new[i], f);
    if (norm(f) > 0)
      r.reach = std::max(r.reach, norm(scene.x_new[i]));
  }
  return r;
}

// A pair rounds at most eight numbers along each axis to half a quantum. The moments of both sides
// cancel up to the rounding of doubles, here below one more quantum.
inline double momentOfRounding(const Resultant& r, std::int64_t num_pairs) {
  return std::sqrt(3.0) * 8 * static_cast<double>(num_pairs) * r.reach;
}

// Rotation about the unit vector `axis` through `centre`.
struct Turn {
  Vec3 axis, centre;
  double angle;

  Vec3 operator()(const Vec3& x) const {
    const Vec3 r = x - centre, along = dot(axis, r) * axis;
    return centre + along + std::cos(angle) * (r - along) + std::sin(angle) * cross(axis, r);
  }
  void all(Scene& scene) const {
    for (Vec3& x : scene.x_new)
      x = (*this)(x);
  }
  void body(Scene& scene, int b) const {
    for (std::size_t i = 0; i < scene.x_new.size(); ++i)
      if (scene.node_body[i] == b)
        scene.x_new[i] = (*this)(scene.x_new[i]);
  }
};

} // namespace brickwall::contact::testing
