// Loads, boundary conditions and initial conditions.
#include "mechanics/element/material.hpp"
#include "miniapp/deck/block_keys.hpp"
#include "miniapp/deck/boundary_conflicts.hpp"
#include "miniapp/deck/deck_blocks.hpp"

namespace brickwall::miniapp {
namespace {

using io::BlockKind;
using io::Deck;

void pulseKeys(BlockKeys& keys, PulseConfig& pulse) {
  keys.add("shape", pulse.shape,
           "variation over the duration T, with t from start: step: 1; half_sine: sin(pi t/T); "
           "sin_squared: sin(pi t/T)^2; triangle: linear up to T/2, then down to 0; friedlander: "
           "(1 - t/T) exp(-decay t/T)");
  keys.add("start", pulse.start, "time at which the pulse begins").in("s").atLeast(0);
  keys.add("duration", pulse.duration,
           "length T of the pulse; only a step may lack it, which then lasts for ever")
      .in("s")
      .above(0);
  keys.add("decay", pulse.decay, "only for friedlander, where the default is 1.0")
      .optional()
      .atLeast(0);
}

void pressureKeys(BlockKeys& keys, PressureConfig& load) {
  keys.add("side_set", load.side_set,
           "name of the side set; walls have front (y = 0), back, left (x = 0), right, bottom and "
           "top")
      .mustBeGiven();
  keys.add("peak", load.peak, "largest pressure; a negative one pulls").in("Pa").mustBeGiven();
  keys.add("distribution", load.distribution,
           "gaussian: peak exp(-(r/radius)^2) at the distance r from center");
  keys.add("center", load.center, "only for gaussian, which needs it: place of the peak")
      .in("m")
      .optional();
  keys.add("radius", load.radius, "only for gaussian, which needs it").in("m").optional().above(0);
  keys.add("wave_speed", load.wave_speed,
           "only for gaussian: the pulse arrives r/wave_speed after `start`; 0: everywhere at once")
      .in("m/s")
      .optional()
      .atLeast(0);
  keys.add(
      "follower", load.follower,
      "true: the load acts on the deformed face, along its normal; false: on the undeformed face");
  pulseKeys(keys, load.pulse);
}

void gravityKeys(BlockKeys& keys, Config& config) {
  keys.add("acceleration", config.gravity, "vector, such as [0, 0, -9.81]").in("m/s2");
}

void viscosityKeys(BlockKeys& keys, mechanics::BulkViscosity& viscosity) {
  keys.add("linear", viscosity.linear, "coefficient b1; 0.06 is usual for shocks")
      .atLeast(0)
      .atMost(2);
  keys.add("quadratic", viscosity.quadratic,
           "coefficient b2, in compression only; 1.2 is usual for strong shocks")
      .atLeast(0)
      .atMost(10);
}

void dampingKeys(BlockKeys& keys, Config& config) {
  keys.add("mass", config.mass_damping,
           "alpha of the force -alpha m v on a node of mass m and velocity v")
      .in("1/s")
      .atLeast(0);
}

void componentsKey(BlockKeys& keys, std::array<bool, 3>& components) {
  keys.add("components", components,
           "directions that are prescribed; nodes are free in the others");
}

void fixedKeys(BlockKeys& keys, FixedConfig& fixed) {
  keys.add(
          "node_set", fixed.node_set,
          "name of the node set; walls have base (z = 0), base_course and top_course (all nodes of "
          "the course), left_end and right_end")
      .mustBeGiven();
  componentsKey(keys, fixed.components);
}

void prescribedKeys(BlockKeys& keys, PrescribedVelocityConfig& prescribed) {
  keys.add("node_set", prescribed.node_set, "name, as of [[boundary.fixed]]").mustBeGiven();
  keys.add("velocity", prescribed.velocity, "vector, which the pulse multiplies")
      .in("m/s")
      .mustBeGiven();
  componentsKey(keys, prescribed.components);
  pulseKeys(keys, prescribed.pulse);
}

void selectionKeys(BlockKeys& keys, InitialSelection& selection) {
  keys.add("block", selection.block, "name of an element block");
  keys.add("brick", selection.brick,
           "a brick of the wall: its indices along, across and of the course, from 0")
      .atLeast(0);
  keys.add("body", selection.body,
           "number of a body, from 0: its brick_id in the Exodus results less 1")
      .atLeast(0);
}

void initialVelocityKeys(BlockKeys& keys, InitialVelocityConfig& initial) {
  selectionKeys(keys, initial);
  keys.add("velocity", initial.velocity,
           "velocity of the point center, and of all without rotation")
      .in("m/s");
  keys.add("angular_velocity", initial.angular_velocity,
           "rotation about center: angular_velocity x (X - center) is added, X the position")
      .in("rad/s");
  keys.add("center", initial.center, "centre of the rotation").in("m");
}

void initialDeformationKeys(BlockKeys& keys, InitialDeformationConfig& initial) {
  selectionKeys(keys, initial);
  keys.add("gradient", initial.gradient,
           "du/dX row by row: du_x/dX, du_x/dY, du_x/dZ, du_y/dX, ...")
      .mustBeGiven();
  keys.add("center", initial.center, "point that does not move").in("m");
}

std::string instance(const std::string& block, int index) {
  return block + "[" + std::to_string(index) + "]";
}

void checkPulse(Deck& deck, const std::string& block, const PulseConfig& pulse) {
  if (!deck.isGood(block, "shape"))
    return;
  if (pulse.shape != PulseKind::step && !deck.has(block, "duration"))
    deck.complain(block, "shape", "no duration for shape \"" + deck.text(block, "shape") + "\"",
                  "a key duration = a number above 0, in s");
  if (pulse.shape != PulseKind::friedlander && deck.has(block, "decay"))
    deck.complain(block, "decay", "decay beside shape \"" + deck.text(block, "shape") + "\"",
                  "decay only with shape = \"friedlander\"");
}

PressureConfig readPressure(Deck& deck, const std::string& block) {
  PressureConfig load;
  readBlock(deck, block, pressureKeys, load);
  load.place = deck.placeOf(block, "side_set");
  checkPulse(deck, block, load.pulse);
  const bool is_gaussian = load.distribution == Distribution::gaussian;
  for (const std::string key : {"center", "radius"})
    if (is_gaussian && !deck.has(block, key))
      deck.complain(block, "distribution", "a gaussian without \"" + key + "\"",
                    "keys center = [x, y, z] and radius, in m");
  for (const std::string key : {"center", "radius", "wave_speed"})
    if (!is_gaussian && deck.has(block, key) && deck.isGood(block, "distribution"))
      deck.complain(block, key, key + " beside a uniform distribution",
                    "distribution = \"gaussian\"");
  return load;
}

void readBoundaries(Deck& deck, Config& config) {
  for (int i = 0; i < deck.count("boundary.fixed"); ++i) {
    const std::string block = instance("boundary.fixed", i);
    auto& fixed = config.fixed.emplace_back();
    readBlock(deck, block, fixedKeys, fixed);
    fixed.place = deck.placeOf(block, "node_set");
  }
  for (int i = 0; i < deck.count("boundary.velocity"); ++i) {
    const std::string block = instance("boundary.velocity", i);
    auto& prescribed = config.prescribed.emplace_back();
    readBlock(deck, block, prescribedKeys, prescribed);
    prescribed.place = deck.placeOf(block, "node_set");
    checkPulse(deck, block, prescribed.pulse);
  }
  complainOfConflicts(config, deck);
}

void checkSelection(Deck& deck, const std::string& block, const InitialSelection& selection,
                    const std::optional<WallConfig>& wall) {
  const int selectors =
      deck.has(block, "block") + deck.has(block, "brick") + deck.has(block, "body");
  if (selectors > 1)
    deck.complain(block, "", "several of block, brick and body", "at most one of them");
  if (deck.has(block, "brick") && !wall)
    deck.complain(block, "brick", "a brick without a [wall]", "block or body for a [mesh]");
  if (!selection.brick || !wall || !deck.isGood("wall", "bricks"))
    return;
  // Odd courses of a flush wall have one piece more: two halves and one whole brick less.
  std::array<std::int64_t, 3> pieces = wall->bricks;
  if (wall->ends == Ends::flush && (*selection.brick)[2] % 2 == 1)
    ++pieces[0];
  for (std::size_t d = 0; d < 3; ++d)
    if ((*selection.brick)[d] >= pieces[d])
      deck.complain(block, "brick", "a brick outside of the wall",
                    "indices from 0, below the numbers of bricks");
}

void readInitialVelocities(Deck& deck, Config& config) {
  for (int i = 0; i < deck.count("initial.velocity"); ++i) {
    const std::string block = instance("initial.velocity", i);
    auto& initial = config.initial_velocities.emplace_back();
    readBlock(deck, block, initialVelocityKeys, initial);
    initial.place = deck.placeOf(block, deck.has(block, "body") ? "body" : "block");
    if (!deck.has(block, "velocity") && !deck.has(block, "angular_velocity"))
      deck.complain(block, "", "neither velocity nor angular_velocity",
                    "at least one of them, a list of 3 numbers");
    if (deck.has(block, "center") && !deck.has(block, "angular_velocity"))
      deck.complain(block, "center", "center without angular_velocity",
                    "angular_velocity = [wx, wy, wz], in rad/s");
    checkSelection(deck, block, initial, config.wall);
  }
}

void readInitialDeformations(Deck& deck, Config& config) {
  for (int i = 0; i < deck.count("initial.deformation"); ++i) {
    const std::string block = instance("initial.deformation", i);
    auto& initial = config.initial_deformations.emplace_back();
    readBlock(deck, block, initialDeformationKeys, initial);
    initial.place = deck.placeOf(block, deck.has(block, "body") ? "body" : "block");
    checkSelection(deck, block, initial, config.wall);
    double H[3][3];
    for (int k = 0; k < 9; ++k)
      H[k / 3][k % 3] = initial.gradient[static_cast<std::size_t>(k)];
    if (!(1 + mechanics::volumeChange(H) > 0))
      deck.complain(block, "gradient", "a gradient that turns bodies inside out",
                    "det(I + gradient) above 0");
  }
}

} // namespace

io::Schema loadBlocks() {
  const std::string selected = " of one block, brick or body, or of all; later blocks win";
  return {
      withKeys({"load.pressure", BlockKind::repeated, "pressure on a side set"}, pressureKeys),
      withKeys({"gravity", BlockKind::single, "acceleration of all bodies"}, gravityKeys),
      withKeys({"viscosity", BlockKind::single,
                "bulk viscosity of the elements, against oscillations behind shocks; it shortens "
                "the step"},
               viscosityKeys),
      withKeys({"damping", BlockKind::single, "damping of all bodies"}, dampingKeys),
      withKeys({"boundary.fixed", BlockKind::repeated, "nodes that do not move"}, fixedKeys),
      withKeys({"boundary.velocity", BlockKind::repeated, "nodes whose velocity is prescribed"},
               prescribedKeys),
      withKeys({"initial.velocity", BlockKind::repeated, "velocity at the start" + selected},
               initialVelocityKeys),
      withKeys({"initial.deformation", BlockKind::repeated,
                "displacement at the start, gradient (X - center)," + selected},
               initialDeformationKeys),
  };
}

void readLoads(Deck& deck, Config& config) {
  for (int i = 0; i < deck.count("load.pressure"); ++i)
    config.pressures.push_back(readPressure(deck, instance("load.pressure", i)));
  readBlock(deck, "gravity", gravityKeys, config);
  readBlock(deck, "viscosity", viscosityKeys, config.viscosity);
  readBlock(deck, "damping", dampingKeys, config);
  readBoundaries(deck, config);
  readInitialVelocities(deck, config);
  readInitialDeformations(deck, config);
}

} // namespace brickwall::miniapp
