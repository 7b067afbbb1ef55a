// Loads that cannot act as intended.
#include "mechanics/loads/pressure_load.hpp"
#include "miniapp/scene/load_warnings.hpp"
#include "tests/mechanics/support/quad_loads.hpp"
#include "tests/miniapp/scene/mesh_scene.hpp"

namespace brickwall::miniapp::testing {
namespace {

// Warnings for one load on the front of a brick of 4 x 4 x 4 unit elements until time 8 in steps of
// 0.1, as a mesh and as a wall.
std::vector<std::string> warningsOf(const std::string& load, bool as_wall) {
  const std::string block = "[[load.pressure]]\npeak = 1.0\nside_set = \"front\"\n" + load;
  const MeshFile mesh(oneBrick({4, 4, 4}), [](io::MeshPart&) {});
  const Config config =
      as_wall ? parseConfig("[wall]\nbricks = [1, 1, 1]\nbrick = [4, 4, 4]\nelements = [4, 4, 4]\n"
                            "[material.brick]\ndensity = 1.0\nyoungs_modulus = 1.0\n"
                            "poissons_ratio = 0.3\n[time]\nend = 8.0\n" +
                                block,
                            "deck.toml")
              : mesh.config(block);
  return loadWarnings(MPI_COMM_WORLD, config, makeMeshPart(MPI_COMM_WORLD, config), 0.1);
}
void expectWarning(const std::string& load, const std::string& words) {
  for (const bool as_wall : {false, true}) {
    const auto warnings = warningsOf(load, as_wall);
    ASSERT_EQ(warnings.size(), words.empty() ? 0u : 1u) << load;
    if (!words.empty()) {
      EXPECT_NE(warnings[0].find(words), std::string::npos) << warnings[0];
    }
  }
}

const std::string gaussian = "duration = 1.0\ndistribution = \"gaussian\"\n";

TEST(LoadWarnings, ReportPulsesThatBeginTooLate) {
  expectWarning("duration = 1.0\nstart = 7.9\n", "");
  expectWarning("duration = 1.0\nstart = 8.0\n", "it starts at 8");
  const std::string away = gaussian + "center = [2, -3, 2]\nradius = 4.0\n";
  expectWarning(away + "wave_speed = 0.3\n", "its wave reaches");
  expectWarning(away + "wave_speed = 0.4\n", "");
  expectWarning(away + "wave_speed = 0.4\nstart = 0.6\n", "its wave reaches");
  expectWarning(away + "wave_speed = 1e-320\n", "its wave reaches");
}

TEST(LoadWarnings, ReportPulsesThatAStepDoesNotResolve) { // of 0.1
  expectWarning("duration = 0.1\n", "");
  expectWarning("duration = 0.099\n", "lasts 0.099, less than a step of 0.1");
}

TEST(LoadWarnings, ReportPrescribedVelocitiesThatBeginTooLate) {
  const std::string step = "duration = 1.0\n[[boundary.velocity]]\nnode_set = \"back\"\n"
                           "velocity = [0, 1, 0]\n";
  expectWarning(step + "start = 7.9\n", "");
  expectWarning(step + "start = 8.0\n",
                "boundary.velocity[0] only holds its nodes: it starts at 8");
}

TEST(LoadWarnings, ReportADeckInWhichNothingActs) {
  const MeshFile mesh(oneBrick({1, 1, 1}), [](io::MeshPart&) {});
  const auto warnsFor = [&](const std::string& blocks) {
    const Config config = mesh.config(blocks);
    const auto warnings =
        loadWarnings(MPI_COMM_WORLD, config, makeMeshPart(MPI_COMM_WORLD, config), 0.1);
    return !warnings.empty() && warnings[0].find("nothing will move") == 0;
  };
  const std::string moving = "[[boundary.velocity]]\nnode_set = \"base\"\nvelocity = [0, 0, 1]\n";
  const std::string deformed = "[[initial.deformation]]\ngradient = [0, 0, 0, 0, 0, 0, 0, 0, ";
  EXPECT_TRUE(warnsFor(""));
  EXPECT_TRUE(warnsFor("[[boundary.fixed]]\nnode_set = \"base\"\n"));
  EXPECT_TRUE(warnsFor(moving + "components = [\"x\"]\n"));
  EXPECT_TRUE(warnsFor("[[initial.velocity]]\nvelocity = [0, 0, 0]\n"));
  EXPECT_TRUE(warnsFor(deformed + "0]\n"));
  EXPECT_TRUE(warnsFor("[[load.pressure]]\nside_set = \"top\"\nshape = \"step\"\npeak = 0.0\n"));
  EXPECT_FALSE(warnsFor("[[load.pressure]]\nside_set = \"top\"\nshape = \"step\"\npeak = -1.0\n"));
  EXPECT_FALSE(warnsFor("[gravity]\nacceleration = [0, 0, -1]\n"));
  EXPECT_FALSE(warnsFor(moving));
  EXPECT_FALSE(warnsFor("[[initial.velocity]]\nangular_velocity = [0, 1, 0]\n"));
  EXPECT_FALSE(warnsFor(deformed + "0.1]\n"));
}

TEST(LoadWarnings, ReportGaussiansThatAreFinerThanTheFacesOrFarAway) {
  expectWarning(gaussian + "center = [2, 0, 2]\nradius = 0.56\n", "");
  expectWarning(gaussian + "center = [2, 0, 2]\nradius = 0.54\n", "is finer than the mesh");
  expectWarning(gaussian + "center = [2, 0, 2]\nradius = 1e-9\n", "is finer than the mesh");
  expectWarning(gaussian + "center = [2, -10, 2]\nradius = 2.5\n", "");
  expectWarning(gaussian + "center = [2, -10, 2]\nradius = 2.0\n", "has almost no effect");
}

// The bound is compared with the loads of a gaussian at several positions on a large flat grid of
// faces of a x b.
TEST(LoadWarnings, TheBoundOfAGaussiansForceErrorIsSharp) {
  constexpr double a = 1, b = 0.7, pi = 3.14159265358979323846;
  for (const double radius : {0.4, 0.5, 0.6}) {
    double worst = 0;
    for (const double x : {0.0, 0.25, 0.5})
      for (const double y : {0.0, 0.25, 0.5}) {
        mechanics::Pressure pressure;
        pressure.peak = 1;
        pressure.gaussian = true;
        pressure.centre = {x * a, y * b, 0};
        pressure.radius = radius / std::sqrt(2.0);
        double force = 0;
        for (int i = -6; i < 6; ++i)
          for (int j = -8; j < 8; ++j) {
            const Vec3 X[4] = {{i * a, j * b, 0},
                               {(i + 1) * a, j * b, 0},
                               {(i + 1) * a, (j + 1) * b, 0},
                               {i * a, (j + 1) * b, 0}};
            Vec3 load[4];
            mechanics::testing::quadLoads(mechanics::MeanPressure(pressure, {}), X, X, load);
            for (const Vec3& corner : load)
              force -= corner.z;
          }
        worst = std::max(worst, std::fabs(force / (pi * radius * radius) - 1));
      }
    const double bound = gaussianForceError(a, b, radius);
    EXPECT_LE(worst, bound * (1 + 1e-3)); // the constants have four digits
    EXPECT_GE(worst, 0.9 * bound) << radius; // the second terms need not have the same sign
  }
}

TEST(MeshScene, ANameOfTwoSetsIsRefusedIfTheDeckUsesIt) {
  const MeshFile mesh(oneBrick({2, 2, 2}), [](io::MeshPart& part) {
    part.side_sets[1].name = part.side_sets[0].name;
    part.node_sets[1].name = part.node_sets[0].name;
  });
  const std::string sides = faultOf(mesh.config("[[load.pressure]]\nside_set = \"front\"\n"
                                                "peak = 1.0\nduration = 1.0\n"));
  EXPECT_NE(sides.find(mesh.path() + " has 2 side sets 'front' (ids "), std::string::npos) << sides;
  const std::string nodes = faultOf(mesh.config("[[boundary.fixed]]\nnode_set = \"base\"\n"));
  EXPECT_NE(nodes.find(mesh.path() + " has 2 node sets 'base' (ids "), std::string::npos) << nodes;
  EXPECT_EQ(faultOf(mesh.config("[[load.pressure]]\nside_set = \"left\"\n"
                                "peak = 1.0\nduration = 1.0\n")),
            "");
}

} // namespace
} // namespace brickwall::miniapp::testing
