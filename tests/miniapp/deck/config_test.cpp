// From decks to the structs of the program: every key, checks of several keys, former names, all
// decks of inputs/, and many broken decks.
#include "contact/base/error.hpp"
#include "miniapp/deck/config.hpp"
#include "tests/support/expect_contains.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

namespace {

using namespace brickwall;
using namespace brickwall::miniapp;

const std::filesystem::path inputs = BRICKWALL_INPUTS;

std::string textOf(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

const std::string smallest = "[wall]\nbricks = [2, 1, 3]\nbrick = [0.2, 0.1, 0.1]\n"
                             "elements = [8, 4, 4]\n"
                             "[material.brick]\ndensity = 2000.0\nyoungs_modulus = 1e9\n"
                             "poissons_ratio = 0.2\n[time]\nend = 1.0\n";

std::string faultsOf(const std::string& text, const std::vector<std::string>& overrides = {}) {
  try {
    parseConfig(text, "a.toml", overrides);
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

TEST(Config, ReadsTheDefaultDeck) {
  const Config config = parseConfig(textOf(inputs / "brick_wall.toml"), "brick_wall.toml");
  ASSERT_TRUE(config.wall.has_value());
  EXPECT_FALSE(config.mesh.has_value());
  EXPECT_GE(config.wall->bricks[0], 8);
  EXPECT_GE(config.wall->bricks[2], 10);
  EXPECT_GE(config.wall->elements[1], 4);
  ASSERT_NE(config.materialOf("brick"), nullptr);
  EXPECT_EQ(config.materialOf("half_brick"), config.materialOf("brick"));
  EXPECT_EQ(config.materialOf("stone"), nullptr);
  EXPECT_EQ(config.materialOf("brick")->model, mechanics::MaterialModel::neo_hookean);
  ASSERT_EQ(config.pressures.size(), 1u);
  EXPECT_EQ(config.pressures[0].side_set, "front");
  EXPECT_EQ(config.pressures[0].pulse.shape, PulseKind::half_sine);
  EXPECT_TRUE(config.pressures[0].follower);
  ASSERT_EQ(config.fixed.size(), 1u);
  EXPECT_EQ(config.fixed[0].node_set, "base_course");
  EXPECT_EQ(config.fixed[0].components, (std::array<bool, 3>{true, true, true}));
}

TEST(Config, NeedsOnlyAWallAMaterialAndAnEndTime) {
  const Config config = parseConfig(smallest, "a.toml");
  EXPECT_EQ(config.wall->ends, Ends::flush);
  EXPECT_EQ(config.formulation, Formulation::one_point);
  EXPECT_EQ(config.mass, NodalMass::inertia);
  EXPECT_TRUE(config.contact.enabled);
  EXPECT_EQ(config.contact.self, SelfContact::automatic);
  EXPECT_EQ(config.contact.guard, GuardAction::cut);
  EXPECT_EQ(config.search.method, SearchMethod::cluster);
  EXPECT_FALSE(config.search.shuffle);
  EXPECT_TRUE(config.search.local);
  EXPECT_EQ(config.search.margin, 0.1);
  EXPECT_FALSE(config.search.has_margin); // `brickwall search` then searches each time
  EXPECT_FALSE(config.viscosity.any());
  EXPECT_EQ(config.mass_damping, 0);
  EXPECT_EQ(config.time.safety, 0.9);
  EXPECT_DOUBLE_EQ(config.contact.penalty, 0.9);
  EXPECT_EQ(config.time.bound, StepBound::lanczos);
  EXPECT_FALSE(config.time.steps.has_value());
  EXPECT_EQ(config.limits.stop[gauge_energy], 0.1);
  EXPECT_EQ(config.limits.stop[gauge_momentum], 1e-6);
  EXPECT_EQ(config.limits.stop[gauge_contact], HUGE_VAL);
  EXPECT_EQ(config.limits.warn[gauge_penetration], 0.1);
  EXPECT_EQ(config.search.audit, 0);
  EXPECT_EQ(config.contact.scheme, contact::Scheme::energy_neutral);
  EXPECT_TRUE(config.skip.resting_bodies && config.skip.free_bricks && config.skip.lattices &&
              config.skip.stationary_contact);
}

// Decks of the release before.
TEST(Config, AcceptsFormerNames) {
  const std::string former = "[spare]\nresting_bodies = false\nstill_contact = false\n[element]\n"
                             "formulation = \"tlps\"\n[output]\nfile_format = \"classic\"\n";
  const std::string present =
      "[skip]\nresting_bodies = false\nstationary_contact = false\n[element]\n"
      "formulation = \"one_point\"\n[output]\nfile_format = \"64bit_offset\"\n";
  const Config config = parseConfig(smallest + former, "a.toml");
  EXPECT_EQ(config.resolved_deck, parseConfig(smallest + present, "a.toml").resolved_deck);
  EXPECT_FALSE(config.skip.resting_bodies || config.skip.stationary_contact);
  ASSERT_EQ(config.warnings.size(), 4u);
  EXPECT_CONTAINS(config.warnings[0], "a.toml:11: [spare] is the former name of [skip]");
  const std::vector<std::string> overrides = {"spare.lattices=false", "element.formulation=tlps"};
  const Config set = parseConfig(smallest + former, "a.toml", overrides);
  EXPECT_FALSE(set.skip.lattices);
  ASSERT_EQ(set.warnings.size(), 6u);
  EXPECT_CONTAINS(set.warnings[4], "--set spare.lattices=false: [spare] is the former name");
  EXPECT_CONTAINS(set.warnings[5], "\"tlps\" is the former name of \"one_point\"");
  EXPECT_TRUE(parseConfig(smallest + present, "a.toml").warnings.empty());
}

// With damping contact takes the same share of the step as without: s/4 + zeta sqrt(s) = 0.9/4.
TEST(Config, LeavesLessPenaltyToDampedContactUnlessGiven) {
  const std::string damped = smallest + "[contact]\ndamping = 0.2\n";
  const Config config = parseConfig(damped, "a.toml");
  EXPECT_NEAR(0.25 * config.contact.penalty + 0.2 * std::sqrt(config.contact.penalty), 0.225,
              1e-15);
  EXPECT_EQ(parseConfig(config.resolved_deck, "a.toml").contact.penalty, config.contact.penalty);
  EXPECT_EQ(parseConfig(damped + "penalty = 0.75\n", "a.toml").contact.penalty, 0.75);
}

TEST(Config, ReadsEveryKey) {
  const Config config = parseConfig(
      "title = \"All\"\n[mesh]\nfile = \"sub/m.exo\"\n"
      "[material.a]\nmodel = \"svk\"\ndensity = 1\nyoungs_modulus = 2\npoissons_ratio = -0.5\n"
      "[material.b]\nmodel = \"linear\"\ndensity = 1\nyoungs_modulus = 2\npoissons_ratio = 0\n"
      "[element]\nformulation = \"full\"\nmass = \"row_sum\"\n"
      "[[load.pressure]]\nside_set = \"s\"\nshape = \"friedlander\"\npeak = 5\nduration = 2\n"
      "start = 0.5\ndecay = 3\ndistribution = \"gaussian\"\ncenter = [1, 2, 3]\nradius = 4\n"
      "wave_speed = 340\nfollower = false\n"
      "[gravity]\nacceleration = [0, 0, -9.81]\n"
      "[damping]\nmass = 3\n[viscosity]\nlinear = 0.06\nquadratic = 1.2\n"
      "[[boundary.fixed]]\nnode_set = \"n\"\ncomponents = [\"z\", \"x\"]\n"
      "[[boundary.velocity]]\nnode_set = \"m\"\nvelocity = [1, 0, 0]\ncomponents = [\"x\"]\n"
      "shape = \"triangle\"\nduration = 1\n"
      "[[initial.velocity]]\nvelocity = [0, 1, 0]\n"
      "[[initial.velocity]]\nbody = 3\nvelocity = [0, 2, 0]\n"
      "[[initial.velocity]]\nblock = \"a\"\nvelocity = [0, 3, 0]\n"
      "[[initial.velocity]]\nangular_velocity = [0, 0, 4]\ncenter = [1, 2, 3]\n"
      "[[initial.deformation]]\nbody = 2\ngradient = [0.1, 0, 0, 0, -0.2, 0, 0.3, 0, 0]\n"
      "center = [4, 5, 6]\n"
      "[contact]\nenabled = false\ntolerance = 0.1\npenalty = 0.25\nself = \"always\"\n"
      "lateral_tolerance = 0.2\nguard = \"stop\"\n"
      "[search]\nmethod = \"reference\"\nreuse = { margin = 0.25 }\njitter = 0.1\n"
      "drift = 0.2\nrepetitions = 3\nwarmup = 0\nseed = 9\nshuffle = true\nlocal = false\n"
      "audit = 5\n"
      "[skip]\nresting_bodies = false\nfree_bricks = false\nlattices = false\n"
      "stationary_contact = false\n"
      "[time]\nend = 1\nsafety = 0.5\nbound = \"element\"\nsteps = 7\ncheck_interval = 11\n"
      "[output]\ninterval = 0.1\nhistory_interval = 0.01\nfile_format = \"netcdf4\"\n"
      "precision = \"single\"\nfields = [\"von_mises\", \"displacement\"]\n"
      "[limits]\nenergy_error = 0.2\nmomentum_error = 1e-12\nwall_time = 60\n"
      "[limits.warn]\nhourglass_share = 0.3\ncontact_error = 0.01\n",
      "/decks/a.toml");
  EXPECT_EQ(config.title, "All");
  EXPECT_FALSE(config.skip.resting_bodies || config.skip.free_bricks || config.skip.lattices ||
               config.skip.stationary_contact);
  EXPECT_EQ(config.mesh->file, "/decks/sub/m.exo"); // relative to the deck
  ASSERT_EQ(config.materials.size(), 2u);
  EXPECT_EQ(config.materials[0].block, "a");
  EXPECT_EQ(config.materials[0].material.model, mechanics::MaterialModel::svk);
  EXPECT_EQ(config.materials[0].material.poisson, -0.5);
  EXPECT_EQ(config.formulation, Formulation::full);
  EXPECT_EQ(config.mass, NodalMass::row_sum);
  const PressureConfig& load = config.pressures.at(0);
  EXPECT_EQ(load.pulse.shape, PulseKind::friedlander);
  EXPECT_EQ(*load.pulse.duration, 2);
  EXPECT_EQ(load.pulse.start, 0.5);
  EXPECT_EQ(load.pulse.decay, 3);
  EXPECT_EQ(load.distribution, Distribution::gaussian);
  EXPECT_EQ(load.center, (Triple{1, 2, 3}));
  EXPECT_EQ(load.radius, 4);
  EXPECT_EQ(load.wave_speed, 340);
  EXPECT_FALSE(load.follower);
  EXPECT_EQ(config.gravity, (Triple{0, 0, -9.81}));
  EXPECT_EQ(config.mass_damping, 3);
  EXPECT_EQ(config.viscosity.linear, 0.06);
  EXPECT_EQ(config.viscosity.quadratic, 1.2);
  EXPECT_EQ(config.fixed.at(0).components, (std::array<bool, 3>{true, false, true}));
  EXPECT_EQ(config.prescribed.at(0).pulse.shape, PulseKind::triangle);
  ASSERT_EQ(config.initial_velocities.size(), 4u);
  EXPECT_FALSE(config.initial_velocities[0].body.has_value());
  EXPECT_EQ(*config.initial_velocities[1].body, 3);
  EXPECT_EQ(*config.initial_velocities[2].block, "a");
  EXPECT_EQ(config.initial_velocities[2].velocity, (Triple{0, 3, 0}));
  EXPECT_EQ(config.initial_velocities[3].velocity, (Triple{0, 0, 0}));
  EXPECT_EQ(config.initial_velocities[3].angular_velocity, (Triple{0, 0, 4}));
  EXPECT_EQ(config.initial_velocities[3].center, (Triple{1, 2, 3}));
  const InitialDeformationConfig& deformation = config.initial_deformations.at(0);
  EXPECT_EQ(*deformation.body, 2);
  EXPECT_EQ(deformation.gradient, (std::array<double, 9>{0.1, 0, 0, 0, -0.2, 0, 0.3, 0, 0}));
  EXPECT_EQ(deformation.center, (Triple{4, 5, 6}));
  EXPECT_FALSE(config.contact.enabled);
  EXPECT_EQ(config.contact.self, SelfContact::always);
  EXPECT_EQ(config.contact.guard, GuardAction::stop);
  EXPECT_EQ(config.search.method, SearchMethod::reference);
  EXPECT_EQ(config.search.seed, 9);
  EXPECT_EQ(config.search.audit, 5);
  EXPECT_TRUE(config.search.shuffle);
  EXPECT_FALSE(config.search.local);
  EXPECT_EQ(config.search.margin, 0.25);
  EXPECT_TRUE(config.search.has_margin);
  EXPECT_EQ(*config.time.steps, 7);
  EXPECT_EQ(config.time.bound, StepBound::element);
  EXPECT_EQ(config.output.file_format, io::FileFormat::netcdf4);
  EXPECT_EQ(config.output.precision, Precision::float32);
  EXPECT_EQ(config.output.fields,
            (std::vector<OutputField>{OutputField::von_mises, OutputField::displacement}));
  EXPECT_EQ(config.limits.stop[gauge_energy], 0.2);
  EXPECT_EQ(config.limits.stop[gauge_momentum], 1e-12);
  EXPECT_EQ(config.limits.warn[gauge_hourglass], 0.3);
  EXPECT_EQ(config.limits.warn[gauge_contact], 0.01);
  EXPECT_EQ(*config.limits.wall_time, 60);
  EXPECT_EQ(parseConfig(config.resolved_deck, "b.toml").resolved_deck, config.resolved_deck);
}

TEST(Config, ChecksWhatConcernsSeveralKeys) {
  EXPECT_CONTAINS(faultsOf(smallest, {"wall.elements=[7,4,4]"}), "an odd number of elements");
  EXPECT_EQ(faultsOf(smallest, {"wall.elements=[7,4,4]", "wall.ends=ragged"}), "");
  EXPECT_EQ(faultsOf(smallest, {"wall.elements=[7,4,4]", "wall.bricks=[3,1,1]"}), "");
  EXPECT_CONTAINS(faultsOf(smallest, {"mesh.file=a.exo"}), "found [mesh] beside [wall]");
  EXPECT_CONTAINS(faultsOf("[time]\nend = 1\n"), "neither [wall] nor [mesh]");
  EXPECT_CONTAINS(faultsOf("[mesh]\nfile = \"\"\n[time]\nend = 1\n"),
                  "[mesh] file: found an empty path, expected the path of an Exodus file");
  EXPECT_CONTAINS(faultsOf("[time]\nend = 1\n"), "found no material");
  EXPECT_CONTAINS(faultsOf(smallest, {"contact.penalty=1.7"}),
                  "no stable step of use, expected a value below 1.552941; contact.edges = false");
  EXPECT_CONTAINS(faultsOf(smallest, {"contact.penalty=0.9", "contact.damping=1"}),
                  "expected a value below 0.127069 with this contact.damping");
  EXPECT_EQ(faultsOf(smallest, {"contact.penalty=1.7", "contact.edges=false"}), "");
  EXPECT_CONTAINS(faultsOf(smallest, {"output.fields=[]"}),
                  "found a list of 0, expected a list of one or more words of \"displacement\"");
  EXPECT_EQ(faultsOf("seed = 1\n[[case]]\ndeck = \"a.toml\"\n"),
            "a.toml: found [[case]], the mark of a study file, expected a deck; brickwall study "
            "a.toml runs it");
  EXPECT_CONTAINS(faultsOf(smallest, {"material.stone.density=1"}), "found the name \"stone\"");
  const std::string load = smallest + "[[load.pressure]]\nside_set = \"front\"\npeak = 1.0\n";
  EXPECT_CONTAINS(faultsOf(load), "no duration for shape \"half_sine\"");
  EXPECT_EQ(faultsOf(load, {"load.pressure[0].shape=step"}), "");
  EXPECT_CONTAINS(faultsOf(load, {"load.pressure[0].duration=0"}), "above 0");
  EXPECT_CONTAINS(faultsOf(load, {"load.pressure[0].distribution=gaussian"}),
                  "a gaussian without \"center\"");
  EXPECT_CONTAINS(faultsOf(load, {"load.pressure[0].radius=1"}), "beside a uniform distribution");
  const std::string initial = smallest + "[[initial.velocity]]\nvelocity = [1, 0, 0]\n";
  EXPECT_EQ(faultsOf(initial, {"initial.velocity[0].brick=[2,0,1]"}), ""); // half, brick, half
  EXPECT_CONTAINS(faultsOf(initial, {"initial.velocity[0].brick=[2,0,0]"}), "outside of the wall");
  EXPECT_CONTAINS(
      faultsOf(initial, {"initial.velocity[0].brick=[0,0,0]", "initial.velocity.0.body=1"}),
      "several of block, brick and body");
  const std::string spin = smallest + "[[initial.velocity]]\nbody = 0\n";
  EXPECT_CONTAINS(faultsOf(spin), "neither velocity nor angular_velocity");
  EXPECT_EQ(faultsOf(spin, {"initial.velocity[0].angular_velocity=[0,0,1]"}), "");
  EXPECT_CONTAINS(faultsOf(initial, {"initial.velocity[0].center=[0,0,1]"}),
                  "center without angular_velocity");
  EXPECT_CONTAINS(faultsOf(initial, {"initial.velocity[0].angular_velocity=[0,1]"}), "list of 3");
  EXPECT_CONTAINS(faultsOf(smallest, {"viscosity.linear=-0.1"}), "at least 0");
  EXPECT_CONTAINS(faultsOf(smallest, {"output.fields=[\"stress\", \"vonmises\"]"}),
                  "did you mean \"von_mises\"?");
  EXPECT_CONTAINS(faultsOf(smallest, {"output.fields=[]"}), "output.fields");
  EXPECT_CONTAINS(faultsOf(smallest, {"viscosity.quadratic=11"}), "at most 10");
  EXPECT_CONTAINS(faultsOf(smallest, {"damping.mass=-1"}), "at least 0");
  const std::string deformed = smallest + "[[initial.deformation]]\nbrick = [1, 0, 0]\n";
  EXPECT_CONTAINS(faultsOf(deformed), "gradient");
  EXPECT_EQ(faultsOf(deformed, {"initial.deformation[0].gradient=[0.1,0,0,0,0,0,0,0,0]"}), "");
  EXPECT_CONTAINS(faultsOf(deformed, {"initial.deformation[0].gradient=[0.1,0,0]"}), "list of 9");
  EXPECT_CONTAINS(faultsOf(deformed, {"initial.deformation[0].gradient=[-1.1,0,0,0,0,0,0,0,0]"}),
                  "turns bodies inside out");
  EXPECT_CONTAINS(faultsOf(deformed, {"initial.deformation[0].brick=[2,0,0]"}),
                  "outside of the wall");
  EXPECT_EQ(faultsOf(load, {"load.pressure[0].shape=sin_squared", "load.pressure[0].duration=1"}),
            "");
  EXPECT_CONTAINS(faultsOf(load, {"load.pressure[0].shape=sin_squared"}),
                  "no duration for shape \"sin_squared\"");
}

TEST(Config, RefusesMotionsThatContradictEachOther) {
  const std::string fixed =
      smallest + // 10 lines
      "[[boundary.fixed]]\nnode_set = \"base\"\ncomponents = [\"x\", \"z\"]\n";
  const std::string both = fixed + "[[boundary.velocity]]\nnode_set = \"base\"\n"
                                   "velocity = [1, 2, 3]\n";
  EXPECT_CONTAINS(faultsOf(both),
                  "a.toml:14: [[boundary.velocity]]: found another motion of x, z of "
                  "node set \"base\" than in a.toml:11, expected one motion of each");
  EXPECT_EQ(faultsOf(both, {"boundary.velocity[0].components=[\"y\"]"}), "");
  EXPECT_EQ(faultsOf(both, {"boundary.velocity[0].velocity=[0,2,0]"}), ""); // 0 is fixed
  EXPECT_EQ(faultsOf(both, {"boundary.velocity[0].node_set=top_course"}), "");
  EXPECT_EQ(faultsOf(fixed + "[[boundary.fixed]]\nnode_set = \"base\"\n"), ""); // twice the same
  EXPECT_CONTAINS(faultsOf(fixed, {"boundary.velocity[0].node_set=base",
                                   "boundary.velocity[0].velocity=[0,0,1]"}),
                  "--set boundary.velocity[0].node_set=base: [[boundary.velocity]]: found another "
                  "motion of z");
  const std::string twice = both + "[[boundary.velocity]]\nnode_set = \"base\"\n"
                                   "components = [\"y\"]\nvelocity = [0, 2, 0]\n";
  const std::string only_y = "boundary.velocity[0].components=[\"y\"]";
  EXPECT_EQ(faultsOf(twice, {only_y}), "");
  EXPECT_CONTAINS(
      faultsOf(twice, {only_y, "boundary.velocity[1].start=0.5"}),
      "a.toml:17: [[boundary.velocity]]: found another motion of y of node set \"base\" "
      "than in a.toml:14");
  EXPECT_CONTAINS(faultsOf(smallest + "[[boundary.fixed]]\n[[boundary.fixed]]\n"), "no key");
}

// A brick of one element is an edge thick: contact that reaches as far would find nodes of its far
// side inside it.
TEST(Config, ContactDoesNotReachThroughABrick) {
  EXPECT_EQ(faultsOf(smallest + "[contact]\ntolerance = 0.45\n"), "");
  EXPECT_CONTAINS(faultsOf(smallest + "[contact]\ntolerance = 0.5\n"), "at most 0.45");
}

TEST(Config, ReadsAllDecksOfTheProject) {
  int decks = 0;
  for (const auto& entry : std::filesystem::directory_iterator(inputs)) {
    if (entry.path().extension() != ".toml")
      continue;
    SCOPED_TRACE(entry.path().string());
    const std::string text = textOf(entry.path());
    EXPECT_EQ(text.compare(0, 10, "# Problem:"), 0) << "a header comment opens each deck";
    for (const char* part : {"# Reference:", "# Units:", "# Expected:", "title = "})
      EXPECT_CONTAINS(text, part);
    const Config config = parseConfig(text, entry.path().string());
    EXPECT_EQ(parseConfig(config.resolved_deck, "resolved.toml").resolved_deck,
              config.resolved_deck);
    ++decks;
  }
  EXPECT_GE(decks, 10);
}

TEST(Config, SaysTheSameOnEveryRank) {
  const Config config =
      readConfig(MPI_COMM_WORLD, (inputs / "two_bars.toml").string(), {"time.steps=3"});
  EXPECT_EQ(*config.time.steps, 3);
  EXPECT_THROW(readConfig(MPI_COMM_WORLD, (inputs / "two_bars.toml").string(), {"time.end=-1"}),
               InputError);
  EXPECT_THROW(readConfig(MPI_COMM_WORLD, "nowhere.toml", {}), InputError);
}

// Every message of a broken deck is of the form "path:LINE: ...".
void expectLines(const std::string& message, int lines, const std::string& text) {
  std::istringstream stream(message);
  int reported = 0;
  for (std::string line; std::getline(stream, line);) {
    if (line.compare(0, 2, "  ") == 0)
      continue; // excerpt
    ASSERT_EQ(line.compare(0, 7, "a.toml:"), 0) << line << "\nfrom:\n" << text;
    const int number = std::atoi(line.c_str() + 7);
    ASSERT_GE(number, 1) << line;
    ASSERT_LE(number, lines) << line;
    ++reported;
  }
  ASSERT_GT(reported, 0);
}

TEST(Config, SurvivesBrokenDecks) {
  const std::string original = textOf(inputs / "brick_wall.toml");
  std::mt19937 random(20160701); // a fixed seed: a failure can be repeated
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  const std::string alphabet = "[]{}=\"'#.,-+_\\\n\r\t 0123456789eExnaif\xEF\xBB\x80\x01";
  int broken = 0;
  for (int trial = 0; trial < 1500; ++trial) {
    std::string text = original;
    const std::size_t mutations = 1 + below(4);
    for (std::size_t m = 0; m < mutations; ++m) {
      const std::size_t at = below(text.size());
      switch (below(6)) {
      case 0:
        text[at] = alphabet[below(alphabet.size())];
        break;
      case 1:
        text.insert(at, 1, alphabet[below(alphabet.size())]);
        break;
      case 2:
        text.erase(at, 1 + below(20));
        break;
      case 3: // a piece repeated elsewhere
        text.insert(below(text.size()), text.substr(at, 1 + below(60)));
        break;
      case 4: // cut off
        if (below(10) == 0)
          text.resize(1 + at);
        break;
      default: // any byte
        text[at] = static_cast<char>(below(256));
      }
    }
    const std::string message = faultsOf(text);
    if (message.empty())
      continue;
    ++broken;
    const int lines = 1 + static_cast<int>(std::count(text.begin(), text.end(), '\n'));
    expectLines(message, lines, text);
    if (HasFatalFailure())
      return;
  }
  EXPECT_GT(broken, 400); // the rest fell into comments or changed a value
}

} // namespace
