// Magnitudes of scenes against values by hand.
#include "miniapp/scene/magnitudes.hpp"
#include "tests/miniapp/scene/mesh_scene.hpp"

namespace brickwall::miniapp::testing {
namespace {

// Three courses of bricks of 4 x 2 x 1 with half bricks in the middle course; density 2 and E = 8
// at nu = 0, so that waves have the speed 2.
Config wallOf(const std::string& blocks) {
  return parseConfig("[wall]\nbricks = [2, 1, 3]\nbrick = [4, 2, 1]\nelements = [8, 4, 2]\n"
                     "[material.brick]\ndensity = 2.0\nyoungs_modulus = 8.0\npoissons_ratio = 0.0\n"
                     "[time]\nend = 8.0\n" +
                         blocks,
                     "deck.toml");
}
Magnitudes found(const Config& config, double dt) {
  return magnitudesOf(MPI_COMM_WORLD, config, makeScene(exec_space(), MPI_COMM_WORLD, config), dt);
}
std::string warningOf(const std::string& blocks, std::int64_t steps = 1000) {
  const Config config = wallOf(blocks);
  const auto warnings = absurdMagnitudes(config, found(config, 0.1), steps);
  EXPECT_LE(warnings.size(), 1u);
  return warnings.empty() ? "" : warnings[0];
}
void expectWords(const std::string& text, const std::string& words) {
  EXPECT_NE(text.find(words), std::string::npos) << text;
}
std::string pressure(const std::string& side, const std::string& keys) {
  return "[[load.pressure]]\nside_set = \"" + side + "\"\n" + keys;
}

TEST(Magnitudes, OfAWallAreThoseByHand) {
  const Config config =
      wallOf("[gravity]\nacceleration = [0, 0, -10]\n" +
             pressure("front", "peak = 3.0\nstart = 0.1\nduration = 0.5\n") + // half sine
             pressure("left", "shape = \"step\"\npeak = -0.5\nstart = 6.0\n") +
             pressure("top", "shape = \"triangle\"\npeak = 4.0\nduration = 1.0\n"));
  const Magnitudes wall = found(config, 0.1);
  EXPECT_DOUBLE_EQ(wall.shortest_crossing, 0.5); // 1/2
  EXPECT_DOUBLE_EQ(wall.longest_crossing, 2.0); // 4/2
  EXPECT_DOUBLE_EQ(wall.mass, 96.0); // 2 x 8 x 2 x 3
  EXPECT_EQ(wall.frequency, 0) << "its foot is free";
  ASSERT_EQ(wall.speeds.size(), 3u);
  EXPECT_NEAR(wall.speeds[0], 3 / 3.14159265358979 / 4, 1e-14); // 3 (2 0.5/pi) over 2 x 2
  EXPECT_NEAR(wall.speeds[1], 0.5 * 2 / 8, 1e-15); // until the end, over 2 x 4
  EXPECT_NEAR(wall.speeds[2], 4 * 0.5 / 2, 1e-15); // over 2 x 1
  EXPECT_EQ(wall.elements_through, 2);
  EXPECT_DOUBLE_EQ(wall.joint_pressure, 60.0); // 2 x 10 x 3
  EXPECT_STREQ(wall.pressure_source, "weight");
  const double softness = jointSoftness(config.mass, 2);
  EXPECT_NEAR(wall.penetration, softness * 2 * 0.01 * 60 / (0.9 * 2 * 0.5), 1e-14);
  EXPECT_NEAR(wall.joint_compliance, softness * 2 * 0.16 / 0.9, 1e-14); // c dt/h = 0.4
}

// 1.8751^2/(2 pi) = 0.559591, 2/sqrt(12) = 0.577350, sqrt(8/2)/3^2 = 0.222222
TEST(Magnitudes, FrequencyIsThatOfTheHeightAboveWhatIsFixed) {
  const auto frequencyWith = [](const std::string& set, const std::string& more = "") {
    return found(wallOf("[[boundary.fixed]]\nnode_set = \"" + set + "\"\n" + more), 0.1).frequency;
  };
  EXPECT_NEAR(frequencyWith("base"), 0.0717956, 1e-7);
  EXPECT_NEAR(frequencyWith("base_course"), 0.0717956 * 9 / 4, 1e-7);
  EXPECT_EQ(frequencyWith("top_course"), 0);
  EXPECT_EQ(frequencyWith("base", "components = [\"z\"]\n"), 0);
}

TEST(Magnitudes, ErrorsAndJointsAreThoseOfTheMasses) {
  const double errors[2][3] = {{0.084, 0.0157, 0.0039}, {0.235, 0.05, 0.013}}; // V22
  const double softness[] = {1.9, 1.3, 1.1};
  for (int i = 0; i < 3; ++i) {
    const int n = 2 << i;
    EXPECT_NEAR(frequencyError(NodalMass::inertia, n), errors[0][i], 0.02 * errors[0][i]);
    EXPECT_NEAR(frequencyError(NodalMass::row_sum, n), errors[1][i], 0.04 * errors[1][i]);
    EXPECT_NEAR(jointSoftness(NodalMass::inertia, n), softness[i], 0.01);
    EXPECT_EQ(jointSoftness(NodalMass::row_sum, n), 1);
  }
  EXPECT_EQ(jointSoftness(NodalMass::inertia, 1), 1);
}

TEST(Magnitudes, OfAMeshAreThoseByHandOnAnyRanks) {
  const MeshFile mesh(oneBrick({4, 4, 4}), [](io::MeshPart&) {});
  const Magnitudes brick =
      found(mesh.config("[[initial.velocity]]\nvelocity = [0, 0.03, 0.04]\n"), 0.5);
  const double speed = std::sqrt(0.7 / (1.3 * 0.4)); // (1 - nu)/((1 + nu) (1 - 2 nu))
  EXPECT_NEAR(brick.shortest_crossing, 4 / speed, 1e-14);
  EXPECT_NEAR(brick.longest_crossing, 4 / speed, 1e-14);
  EXPECT_NEAR(brick.mass, 64.0, 1e-12);
  EXPECT_EQ(brick.frequency, 0.0);
  EXPECT_TRUE(brick.speeds.empty());
  EXPECT_NEAR(brick.joint_pressure, 0.05 * speed, 1e-15);
  EXPECT_STREQ(brick.pressure_source, "impact");
}

TEST(Magnitudes, AreNotAbsurdInAnyConsistentUnits) {
  EXPECT_EQ(warningOf(""), "");
  EXPECT_EQ(warningOf("[gravity]\nacceleration = [0, 0, -1e-3]\n"), "");
  EXPECT_EQ(warningOf(pressure("front", "peak = 0.7\nduration = 0.5\n")), "");
  EXPECT_EQ(warningOf("", 1000000000), "");
}

TEST(Magnitudes, AreAbsurdWhereBodiesWouldBeCrushedOrRunsNeverEnd) {
  expectWords(warningOf(pressure("front", "peak = 0.79\nduration = 8.0\n")),
              "load.pressure[0] gives a brick the speed 1.00"); // 0.79 x 16/pi / 4
  expectWords(warningOf(pressure("front", "peak = 0.81\nduration = 1e-3\n")),
              "the pressure 0.81 (load) exceeds a tenth of the modulus lambda + 2 mu = 8");
  const std::string moving =
      "[[boundary.velocity]]\nnode_set = \"base\"\nvelocity = [0, 0, 0.21]\n";
  expectWords(warningOf(moving), // 2 x 2 x 0.21
              "the pressure 0.84 (prescribed velocity) exceeds a tenth of the modulus");
  EXPECT_EQ(warningOf(moving + "components = [\"x\", \"y\"]\n"), "");
  expectWords(warningOf("", 1000000001), "the run has 1000000001 steps");
}

TEST(Magnitudes, RunsShorterThanAWaveAndVeryLongOnesAreDoubtful) {
  Config config = wallOf("");
  const Magnitudes magnitudes = found(config, 0.1);
  const auto warningAt = [&](double end) {
    config.time.end = end;
    const auto warnings = absurdMagnitudes(config, magnitudes, 1000);
    return warnings.empty() ? std::string() : warnings[0];
  };
  EXPECT_EQ(warningAt(1.01 * magnitudes.shortest_crossing), "");
  expectWords(warningAt(0.99 * magnitudes.shortest_crossing), "the run ends at time");
  EXPECT_EQ(warningAt(0.99e6 * magnitudes.longest_crossing), "");
  expectWords(warningAt(1.01e6 * magnitudes.longest_crossing),
              "waves cross the largest body 1.01e+06");
}

// The wave speed is sqrt(E/density).
TEST(Magnitudes, WaveSpeedsAreJudgedInTheUnitsThatGravitySuggests) {
  const auto warningFor = [](double density, double youngs, const std::string& gravity) {
    Config config = wallOf("[gravity]\nacceleration = [0, 0, -" + gravity + "]\n");
    for (auto& entry : config.materials) {
      entry.material.density = density;
      entry.material.youngs = youngs;
    }
    Magnitudes magnitudes; // judged elsewhere
    magnitudes.shortest_crossing = 1;
    magnitudes.longest_crossing = 1;
    const auto warnings = absurdMagnitudes(config, magnitudes, 1000);
    EXPECT_LE(warnings.size(), 1u);
    return warnings.empty() ? std::string() : warnings[0];
  };
  // steel in the sets of miniapp/deck/reference.md, and in cm, g and s
  EXPECT_EQ(warningFor(7850, 2.1e11, "9.81"), "");
  EXPECT_EQ(warningFor(7.85e-9, 2.1e5, "9810"), "");
  EXPECT_EQ(warningFor(7.85e-6, 210, "9.81e-3"), "");
  EXPECT_EQ(warningFor(7.85, 2.1, "9.81e-10"), "");
  EXPECT_EQ(warningFor(7.85, 2.1e12, "981"), "");
  EXPECT_EQ(warningFor(7850, 2.1e11, "2.0"), "") << "not on the earth";
  // mixed sets
  expectWords(warningFor(2000, 20e9, "9810"),
              "material.brick has the wave speed 3162.28, and gravity 9810 suggests mm and s: "
              "expected 20000 to 2e+07");
  expectWords(warningFor(2e-6, 20e9, "9.81"), "suggests m and s: expected 20 to 20000");
  expectWords(warningFor(7850, 2.1e5, "9.81"), "the wave speed 5.17219");
  expectWords(warningFor(7.85e-6, 2.1e5, "9.81"), "the wave speed 163559");
  expectWords(warningFor(7.85e6, 2.1e11, "9.81"), "the density 7.85e+06: expected at most 25000");
  // without gravity
  EXPECT_EQ(warningFor(7850, 2.1e11, "0"), "");
  EXPECT_EQ(warningFor(1, 1, "0"), "");
  expectWords(
      warningFor(7850, 2.1e14, "0"),
      "the wave speed 163559, and the density 7850 suggests kg/m3: expected 20 to 20000 m/s");
  expectWords(warningFor(7.85e6, 2.1e11, "0"), "the density 7.85e+06");
  EXPECT_EQ(warningFor(7.85e-9, 2.1e5, "0"), "");
  expectWords(warningFor(2e-6, 20e9, "0"),
              "the wave speed 1e+08: expected at most 20000 m/s, which are 2e7 mm/s");
}

} // namespace
} // namespace brickwall::miniapp::testing
