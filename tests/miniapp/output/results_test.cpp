// The fields of the Exodus files (output.fields) against exact answers, read back from the files.
#include "contact/base/mpi.hpp"
#include "io/exodus/results_reader.hpp"
#include "mechanics/element/stress_measures.hpp"
#include "miniapp/output/earlier_results.hpp"
#include "miniapp/output/results.hpp"
#include "miniapp/output/run_output.hpp"
#include "tests/miniapp/simulation/case.hpp"
#include "tests/support/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>

namespace brickwall::miniapp::testing {
namespace {

using brickwall::testing::TemporaryFolder;
using verification::Case;

const MPI_Comm world = MPI_COMM_WORLD;

// Two unit cubes of 2 x 2 x 2 elements that meet at x = 1; their material is rho = E = 1.
std::string twoCubes(const std::string& poisson, const std::string& fields) {
  return "[wall]\nbricks = [2, 1, 1]\nbrick = [1.0, 1.0, 1.0]\nelements = [2, 2, 2]\n"
         "ends = \"ragged\"\n[material.brick]\ndensity = 1\nyoungs_modulus = 1\n"
         "poissons_ratio = " +
         poisson + "\n[time]\nend = 200\n[output]\nfields = [" + fields + "]\n";
}

// A simulation with its results so far, of this rank.
struct CubesRun {
  explicit CubesRun(const std::string& deck)
      : scene(deck), folder(world), recorder(world, Timing::normal),
        results(world, folder / "run", scene.config, scene.scene, recorder) {
    scene.simulation.start();
  }
  void stepUntil(double time) {
    while (scene.simulation.clock().time < time)
      scene.simulation.step();
  }
  void write() {
    results.writeStep(scene.simulation);
    reader = std::make_unique<io::ResultsReader>(results.fileName());
  }
  std::vector<double> nodal(const std::string& name) const {
    return reader->nodal(reader->numSteps(), placeOf(reader->nodalNames(), name));
  }
  std::vector<double> element(const std::string& name) const {
    return reader->element(reader->numSteps(), placeOf(reader->elementNames(), name));
  }
  // Calls check(local node, whether it is on a body other than the first) at the nodes of the plane
  // x_axis = 1; returns their number on all ranks.
  int forJoint(int axis, const std::function<void(int, bool)>& check) const {
    const io::MeshPart& part = scene.scene.part;
    std::vector<char> is_second(part.node_ids.size());
    for (int elem = 0; elem < part.numElems(); ++elem)
      for (int corner = 0; corner < 8; ++corner)
        is_second[part.elem_nodes[8 * elem + corner]] = part.elem_body[elem] > 0;
    int found = 0;
    for (int node = 0; node < part.numNodes(); ++node)
      if (std::fabs(part.coordinates[3 * node + axis] - 1) < 1e-9) {
        check(node, is_second[node] != 0);
        found += scene.scene.node_is_owned[node];
      }
    return allReduce(world, found, MPI_SUM);
  }

  Case scene;
  TemporaryFolder folder;
  PhaseRecorder recorder;
  Results results;
  std::unique_ptr<io::ResultsReader> reader;

private:
  static int placeOf(const std::vector<std::string>& names, const std::string& name) {
    const auto found = std::find(names.begin(), names.end(), name);
    EXPECT_NE(found, names.end()) << name;
    return static_cast<int>(found - names.begin());
  }
};

TEST(Results, HaveTheFieldsOfTheDeckInTheOrderOfTheTable) {
  std::string deck = twoCubes("0.2", "\"brick_id\", \"principal_stress\", \"contact_gap\", "
                                     "\"displacement\", \"contact_gap\""); // one of them twice
  io::ResultsConfig config = resultsConfig(parseConfig(deck, "a.toml"));
  EXPECT_EQ(config.nodal_names, (std::vector<std::string>{"displacement_x", "displacement_y",
                                                          "displacement_z", "contact_gap"}));
  EXPECT_EQ(
      config.element_names,
      (std::vector<std::string>{"principal_stress_1", "principal_stress_2", "principal_stress_3"}));
  EXPECT_TRUE(config.write_brick_id);
  EXPECT_FALSE(config.write_processor_id);

  deck.erase(deck.find("[output]"));
  config = resultsConfig(parseConfig(deck, "a.toml"));
  EXPECT_EQ(
      config.nodal_names,
      (std::vector<std::string>{"displacement_x", "displacement_y", "displacement_z", "velocity_x",
                                "velocity_y", "velocity_z", "force_contact_x", "force_contact_y",
                                "force_contact_z", "contact_status", "contact_gap"}));
  EXPECT_EQ(config.element_names,
            (std::vector<std::string>{"stress_xx", "stress_yy", "stress_zz", "stress_xy",
                                      "stress_yz", "stress_zx", "pressure", "energy_density"}));
  EXPECT_TRUE(config.write_brick_id);
}

// Uniaxial strain F = diag(1 + e, 1, 1) of a neo-Hookean body, mechanics/theory.md (6), (7):
// sigma_xx = (mu (J^2 - 1) + lambda ln J)/J, sigma_yy = sigma_zz = lambda ln J/J, with J = 1 + e.
// About 50 operations per value.
TEST(Results, OfUniformStretchAreExact) {
  CubesRun run(twoCubes("0.25",
                        "\"stress\", \"von_mises\", \"principal_stress\", \"strain_energy\", "
                        "\"energy_density\", \"processor_id\"") +
               "[[initial.deformation]]\ngradient = [0.125, 0, 0, 0, 0, 0, 0, 0, 0]\n");
  run.write();
  const double lambda = 0.4, mu = 0.4, J = 1.125;
  const double side = lambda * std::log(J) / J, along = side + mu * (J * J - 1) / J;
  const double density =
      0.5 * mu * (J * J - 1) - mu * std::log(J) + 0.5 * lambda * std::log(J) * std::log(J);
  const auto expectAll = [&](const char* name, double exact) {
    for (const double value : run.element(name))
      EXPECT_NEAR(value, exact, 100 * 1.1e-16) << name;
  };
  expectAll("stress_xx", along);
  expectAll("stress_yy", side);
  expectAll("stress_xy", 0);
  expectAll("von_mises", along - side);
  expectAll("principal_stress_1", along);
  expectAll("principal_stress_2", side);
  expectAll("principal_stress_3", side);
  expectAll("energy_density", density);
  expectAll("strain_energy", density / 8); // of elements with edges of 1/2
  expectAll("processor_id", rankOf(world));
}

// At rest the pressure on the end is that of the joint, at nodes in corners, on edges and in faces,
// but for changes of normals and areas by the strain, 1e-6. Damped by alpha = 1, all motion falls
// by exp(-t/2), 6e-44 until the end; forces at corners, 6e-8, are multiples of 2^-54.
TEST(Results, OfCubesAtRestUnderAKnownPressureAreExact) {
  CubesRun run(twoCubes("0.0", "\"displacement\", \"contact_pressure\", \"contact_gap\", "
                               "\"contact_status\", \"force_contact\", \"slip_velocity\"") +
               "[[load.pressure]]\nside_set = \"right\"\nshape = \"step\"\npeak = 1e-6\n"
               "[[boundary.fixed]]\nnode_set = \"left_end\"\n[damping]\nmass = 1.0\n");
  run.stepUntil(199);
  run.write();
  const double load = 1e-6, tolerance = load * load;
  const auto pressure = run.nodal("contact_pressure"), gap = run.nodal("contact_gap");
  const auto status = run.nodal("contact_status"), force = run.nodal("force_contact_x");
  const auto x = run.nodal("displacement_x"), slip = run.nodal("slip_velocity_y");
  double of_joint[2] = {0, 0}; // displacement of the first and the second cube; uniform
  run.forJoint(0, [&](int node, bool is_second) { of_joint[is_second] = x[node]; });
  allReduce(world, of_joint, 2, MPI_MIN); // both are negative
  const int in_joint = run.forJoint(0, [&](int node, bool is_second) {
    EXPECT_NEAR(pressure[node], load, tolerance);
    EXPECT_EQ(status[node], 1);
    EXPECT_NEAR(gap[node], of_joint[1] - of_joint[0], tolerance);
    EXPECT_EQ(is_second, force[node] > 0);
    EXPECT_NEAR(slip[node], 0, tolerance);
  });
  EXPECT_EQ(in_joint, 18);
  EXPECT_NEAR(of_joint[0], -load, 2 * tolerance); // E = 1; second order of the neo-Hookean model
  EXPECT_LT(of_joint[1], of_joint[0]);
  for (std::size_t node = 0; node < pressure.size(); ++node)
    EXPECT_EQ(pressure[node] > 0, status[node] > 0);
}

// Four cubes in a square, under the same pressure on all four sides: the nodes at the edges where
// all meet are pressed on two sides. The cubes move by up to 1e-6 past each other's edges, which
// takes up to 1e-6/(0.1/2) of the force of the nodes there (contact.edge_tolerance).
TEST(Results, HaveOnePressureOfTwoSides) {
  std::string deck = twoCubes("0.0", "\"contact_pressure\"") + "[damping]\nmass = 1.0\n";
  deck.replace(deck.find("[2, 1, 1]"), 9, "[2, 2, 1]");
  for (const char* side : {"left", "right", "front", "back"})
    deck += std::string("[[load.pressure]]\nside_set = \"") + side +
            "\"\nshape = \"step\"\npeak = 1e-6\n";
  CubesRun run(deck);
  run.stepUntil(199);
  run.write();
  const auto pressure = run.nodal("contact_pressure");
  for (const int axis : {0, 1})
    EXPECT_EQ(run.forJoint(axis, [&](int node, bool) { EXPECT_NEAR(pressure[node], 1e-6, 2e-11); }),
              4 * 9);
}

// Two half cubes that a pressure of 1e-6 holds on a fixed cube, moved with a prescribed velocity.
std::string slidingCubes(const std::string& fields, const std::string& speed,
                         const std::string& friction) {
  std::string deck = twoCubes("0.0", fields);
  deck.replace(deck.find("[2, 1, 1]"), 9, "[1, 1, 2]");
  deck.replace(deck.find("ragged"), 6, "flush");
  return deck +
         "[[load.pressure]]\nside_set = \"top\"\nshape = \"step\"\npeak = 1e-6\n"
         "[[boundary.fixed]]\nnode_set = \"base_course\"\n"
         "[[boundary.velocity]]\nnode_set = \"top_course\"\nvelocity = [" +
         speed +
         ", 0, 0]\n"
         "components = [\"x\", \"y\"]\n[damping]\nmass = 1.0\n"
         "[contact]\nfriction = " +
         friction + "\n";
}

// Two half cubes slide on a fixed cube with a prescribed velocity and mu = 0.5. Their slip is that
// velocity, the nodes of the cube see the opposite; friction is mu times the normal force and no
// part of the pressure. The slip of 2e-5 takes up to 2e-5/(0.1/2) of the force of the nodes beyond
// the edge (contact.edge_tolerance), which the others bear.
TEST(Results, OfSlidingBodiesAreExact) {
  const double speed = 1e-7, load = 1e-6, friction = 0.5;
  CubesRun run(
      slidingCubes("\"contact_pressure\", \"force_contact\", \"slip_velocity\"", "1e-7", "0.5"));
  run.stepUntil(199);
  run.write();
  const double relative = 199 * speed / 0.05;
  const auto pressure = run.nodal("contact_pressure");
  const auto slip_x = run.nodal("slip_velocity_x"), slip_z = run.nodal("slip_velocity_z");
  const auto force_x = run.nodal("force_contact_x"), force_z = run.nodal("force_contact_z");
  double sums[2] = {0, 0}; // forces on the sliding bodies
  const int in_joint = run.forJoint(2, [&](int node, bool slides) {
    EXPECT_NEAR(slip_x[node], slides ? speed : -speed, relative * speed);
    EXPECT_NEAR(slip_z[node], 0, relative * speed);
    EXPECT_NEAR(pressure[node], load, relative * load);
    if (slides && run.scene.scene.node_is_owned[node]) {
      sums[0] += force_x[node];
      sums[1] += force_z[node];
    }
  });
  EXPECT_EQ(in_joint, 9 + 12);
  allReduce(world, sums, 2, MPI_SUM);
  EXPECT_NEAR(sums[1], load, relative * load);
  EXPECT_NEAR(sums[0], -friction * sums[1], relative * load);
}

// With and without friction, at rest under the load: a sliding node slips by all of its further
// motion, since its spring is stretched to the limit, a sticking one not at all. All slips together
// are not longer than the motion.
TEST(Results, OfSlipAreTheMotionThatTheSpringDoesNotTake) {
  const auto expectSlip = [](const char* speed, const char* friction, double share) {
    CubesRun run(slidingCubes("\"slip_distance\"", speed, friction));
    const auto& clock = run.scene.simulation.clock();
    run.stepUntil(150);
    run.write();
    const auto before = run.nodal("slip_distance");
    const double begin = clock.time, motion = std::stod(speed);
    run.stepUntil(199);
    run.write();
    const auto after = run.nodal("slip_distance");
    const double further = share * motion * (clock.time - begin);
    const int in_joint = run.forJoint(2, [&](int node, bool) {
      EXPECT_NEAR(after[node] - before[node], further, 199 * motion / 0.05 * further);
      EXPECT_LE(after[node], motion * clock.time);
    });
    EXPECT_EQ(in_joint, 9 + 12);
  };
  expectSlip("1e-7", "0.5", 1);
  expectSlip("1e-7", "0", 1);
  expectSlip("1e-10", "0.5", 0);
}

// Two elements side by side: each corner of the joint is a candidate of the three faces that meet
// in the opposite corner.
TEST(Results, CountCandidatePairsOfFaces) {
  std::string deck = twoCubes("0.0", "\"candidate_pairs\", \"search_time\"");
  deck.replace(deck.find("[2, 2, 2]"), 9, "[1, 1, 1]");
  CubesRun run(deck);
  run.scene.simulation.step();
  run.write();
  for (const double pairs : run.element("candidate_pairs"))
    EXPECT_EQ(pairs, 4 * 3);
  for (const double seconds : run.element("search_time"))
    EXPECT_EQ(seconds, run.recorder.seconds("contact::search"));
}

TEST(Results, HaveZeroFieldsWithoutContact) {
  CubesRun run(twoCubes("0.0", "\"contact_pressure\", \"slip_velocity\", \"slip_distance\", "
                               "\"candidate_pairs\"") +
               "[contact]\nenabled = false\n");
  run.write();
  for (const char* name : {"contact_pressure", "slip_velocity_x", "slip_distance"})
    for (const double value : run.nodal(name))
      EXPECT_EQ(value, 0);
  for (const double value : run.element("candidate_pairs"))
    EXPECT_EQ(value, 0);
}

TEST(StressMeasures, OfKnownStressesAreThoseByHand) {
  using mechanics::principalStresses;
  using mechanics::vonMises;
  double principal[3];
  const double uniaxial[6] = {0, -3, 0, 0, 0, 0}, shear[6] = {0, 0, 0, 0, 0, 2};
  EXPECT_EQ(vonMises(uniaxial), 3);
  EXPECT_NEAR(vonMises(shear), 2 * std::sqrt(3.0), 1e-15);
  principalStresses(uniaxial, principal);
  EXPECT_EQ(principal[0], 0);
  EXPECT_EQ(principal[2], -3);
  principalStresses(shear, principal);
  EXPECT_NEAR(principal[0], 2, 1e-15);
  EXPECT_NEAR(principal[1], 0, 1e-15);
  EXPECT_NEAR(principal[2], -2, 1e-15);
  // Eigenvalues 1, 2, 4: Q diag Q^T with the rotation by the Pythagorean angle (3, 4, 5) about z
  // and then x; sqrt(((2 - 1)^2 + (4 - 2)^2 + (4 - 1)^2)/2) = sqrt(7).
  const double c = 0.6, s = 0.8;
  const double Q[3][3] = {{c, -s, 0}, {c * s, c * c, -s}, {s * s, s * c, c}}, value[3] = {4, 1, 2};
  double a[3][3] = {};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k)
        a[i][j] += Q[i][k] * value[k] * Q[j][k];
  const double turned[6] = {a[0][0], a[1][1], a[2][2], a[0][1], a[1][2], a[2][0]};
  principalStresses(turned, principal);
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(principal[i], (i == 0 ? 4 : i == 1 ? 2 : 1), 1e-14);
  EXPECT_NEAR(vonMises(turned), std::sqrt(7.0), 1e-14);
}

// A run of three ranks was killed among the renames of its files, or before them; it continues one
// of two ranks. A file of another deck is none of its files.
TEST(EarlierResults, AreReplacedAsAWholeOrNotAtAll) {
  const auto textOf = [](const std::string& path) {
    std::string text;
    std::ifstream(path) >> text;
    return text;
  };
  for (const bool were_complete : {true, false}) {
    const TemporaryFolder folder(world);
    const std::string base = folder / "a.exo", foreign = base + ".b.exo.new";
    const std::vector<std::string> before = {base + ".2.0", base + ".2.1"},
                                   after = {base + ".3.0", base + ".3.1", base + ".3.2"};
    if (rankOf(world) == 0) {
      for (const std::string& file : before)
        std::ofstream(file) << "before";
      for (const std::string& file : after)
        std::ofstream(file + ".new") << "after";
      std::ofstream(foreign) << "foreign";
      if (were_complete) {
        std::ofstream(base + ".new.ranks") << "3 2\n";
        std::filesystem::rename(after[1] + ".new", after[1]);
      }
    }
    EarlierResults::endReplacement(world, base);
    for (const std::string& file : before)
      EXPECT_EQ(textOf(file), were_complete ? "" : "before");
    for (const std::string& file : after) {
      EXPECT_EQ(textOf(file), were_complete ? "after" : "");
      EXPECT_FALSE(std::filesystem::exists(file + ".new"));
    }
    EXPECT_EQ(textOf(foreign), "foreign");
    EXPECT_FALSE(std::filesystem::exists(base + ".new.ranks"));
  }
}

TEST(Ticker, IsDueOnceAnIntervalAndInEachStepIfIntervalsAreTooShortToCount) {
  Ticker counted(0.1, false), uncounted(1e-320, false);
  int due = 0;
  for (int step = 0; step <= 100; ++step) {
    due += counted.due(0.01 * step);
    EXPECT_EQ(uncounted.due(0.01 * step), step > 0);
  }
  EXPECT_EQ(due, 10);
  EXPECT_EQ(counted.last(), 10);
  EXPECT_EQ(uncounted.last(), 0);
}

} // namespace
} // namespace brickwall::miniapp::testing
