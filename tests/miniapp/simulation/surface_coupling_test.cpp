// Masses of the contact surface.
#include "miniapp/simulation/surface_coupling.hpp"

#include "contact/base/to_device.hpp"
#include "contact/surface/face_attributes.hpp"

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <utility>

namespace brickwall::miniapp {
namespace {

// The share of the stable step that contact takes is one of nodal masses, but its stiffness by area
// comes from surface masses. So the mass that the faces of a side give a node, their surface mass
// times a quarter of their area, is nowhere above the nodal mass; at the lightest node it is equal.
TEST(SurfaceCoupling, SurfaceMassesAreThoseOfTheLightestNode) {
  const exec_space space;
  for (const std::string mass : {"inertia", "row_sum"}) {
    const Config config = parseConfig(
        "[wall]\nbricks = [1, 1, 1]\nbrick = [0.2, 0.1, 0.1]\nelements = [4, 2, 2]\n"
        "[material.brick]\ndensity = 2000\nyoungs_modulus = 20e9\npoissons_ratio = 0.2\n"
        "[element]\nmass = \"" +
            mass + "\"\n[time]\nend = 1e-3\n",
        "case.toml");
    const Scene scene = makeScene(space, MPI_COMM_SELF, config);
    const mechanics::BoundaryConditions free(space, scene.mesh.num_nodes, {}, {});
    const contact::Surface surface = SurfaceCoupling(space, MPI_COMM_SELF, scene, free).surface();
    const auto attributes = toHost(surface.face_attributes);
    const auto nodes = toHost(scene.skin.face_to_nodes);
    const auto sides = toHost(scene.skin.face_to_side);
    const auto nodal_mass = toHost(scene.mass);
    constexpr double quarter = 0.25 * 0.05 * 0.05; // of the area of a face
    std::map<std::pair<int, int>, double> of_faces; // [node, side]
    for (int face = 0; face < scene.skin.num_faces; ++face) {
      const auto& values = contact::attributesAt<const contact::FaceAttributes>(attributes, face);
      for (int j = 0; j < 4; ++j) {
        EXPECT_EQ(values.corner_mass[j], nodal_mass(nodes(face, j)));
        of_faces[{nodes(face, j), sides(face)}] += values.surface_mass * quarter;
      }
    }
    double least = HUGE_VAL;
    for (const auto& [key, share] : of_faces)
      least = minOf(least, nodal_mass(key.first) / share);
    EXPECT_NEAR(least, 1, 1e-12) << mass;
  }
}

} // namespace
} // namespace brickwall::miniapp
