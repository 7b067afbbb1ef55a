// The table of all blocks and keys of a deck: name, type, range, default, unit and one line of help each.
#include "miniapp/deck/config.hpp"

namespace brickwall::miniapp {
namespace {

using io::BlockKind;
using io::BlockRule;
using io::boolean;
using io::integer;
using io::KeyRule;
using io::real;
using io::text;
using io::word;

const std::vector<std::string> pulse_shapes = {"step", "half_sine", "sin_squared", "triangle",
                                               "friedlander"};

// Keys of a course in time, see PulseConfig.
std::vector<KeyRule> pulseKeys(const std::string& default_shape) {
  return {word("shape", pulse_shapes, "course in time; each step has its mean over the step")
              .byDefault(default_shape),
          real("start", "s", "time at which it begins").byDefault("0.0").atLeast(0),
          real("duration", "s", "how long it lasts; optional for shape = \"step\"").above(0),
          real("decay", "", "of shape = \"friedlander\" only, there 1.0 if not given").atLeast(0)};
}

BlockRule withPulse(BlockRule block, const std::string& default_shape) {
  for (KeyRule& key : pulseKeys(default_shape))
    block.keys.push_back(std::move(key));
  return block;
}

KeyRule components() {
  return word("components", {"x", "y", "z"}, "which components are prescribed")
      .list(KeyRule::any_length)
      .byDefault("[\"x\", \"y\", \"z\"]");
}

std::vector<BlockRule> sceneBlocks() {
  return {
      {"", BlockKind::top, "", {text("title", "one line about the problem")}},
      {"wall",
       BlockKind::single,
       "a wall of bricks in running bond, each brick its own mesh",
       {integer("bricks", "number along, across, and of courses")
            .list(3)
            .mustBeGiven()
            .atLeast(1)
            .atMost(1e6),
        real("brick", "m", "size of a brick").list(3).mustBeGiven().above(0),
        integer("elements", "of a brick").list(3).mustBeGiven().atLeast(1).atMost(1e5),
        real("gap", "m", "between neighbouring bricks").byDefault("0.0").atLeast(0),
        word("ends", {"flush", "ragged"}, "half bricks at the ends of odd courses, or none")
            .byDefault("flush")}},
      {"mesh",
       BlockKind::single,
       "a mesh from an Exodus file, in place of [wall]",
       {text("file", "path, relative to the deck's folder").mustBeGiven()}},
      {"material",
       BlockKind::named,
       "material of the element block <name>; walls have the blocks brick and half_brick, which is "
       "as "
       "brick where not given",
       {word("model", {"neo_hookean", "svk", "linear"},
             "ln J neo-Hookean, St.Venant-Kirchhoff, or "
             "linear at small strain")
            .byDefault("neo_hookean"),
        real("density", "kg/m3", "in the reference state").mustBeGiven().above(0),
        real("youngs_modulus", "Pa", "Young's modulus").mustBeGiven().above(0),
        real("poissons_ratio", "", "Poisson's ratio").mustBeGiven().above(-1).below(0.5)}},
      {"element",
       BlockKind::single,
       "the hexahedral element",
       {word("formulation", {"tlps", "full"},
             "one point with assumed-strain hourglass stiffness, or 2x2x2 points")
            .byDefault("tlps")}},
  };
}

// Keys of an initial condition: what it concerns, see InitialSelection, and `values`.
BlockRule initialBlock(const std::string& name, const std::string& help,
                       const std::vector<KeyRule>& values) {
  BlockRule block{name,
                  BlockKind::repeated,
                  help + " of one block, brick or body, or of everything; later ones win",
                  {text("block", "element block"),
                   integer("brick", "of a wall: along, across, course, from 0").list(3).atLeast(0),
                   integer("body", "from 0").atLeast(0)}};
  block.keys.insert(block.keys.end(), values.begin(), values.end());
  return block;
}

std::vector<BlockRule> loadBlocks() {
  return {
      withPulse(
          {"load.pressure",
           BlockKind::repeated,
           "pressure on a side set",
           {text("side_set", "name; walls have front, back, left, right, bottom, top")
                .mustBeGiven(),
            real("peak", "Pa", "largest pressure").mustBeGiven(),
            word("distribution", {"uniform", "gaussian"}, "course in space").byDefault("uniform"),
            real("center", "m", "of the gaussian").list(3),
            real("radius", "m", "of the gaussian: peak exp(-(r/radius)^2)").above(0),
            real("wave_speed", "m/s", "of the gaussian: arrival r/wave_speed later; 0: at once")
                .atLeast(0),
            boolean("follower", "act on the current face, else on the reference face")
                .byDefault("true")}},
          "half_sine"),
      {"gravity",
       BlockKind::single,
       "acceleration of everything",
       {real("acceleration", "m/s2", "vector").list(3).byDefault("[0.0, 0.0, 0.0]")}},
      {"viscosity",
       BlockKind::single,
       "bulk viscosity of the elements, against ringing behind shocks; it shortens the step",
       {real("linear", "", "b1; 0.06 for shocks").byDefault("0.0").atLeast(0).atMost(2),
        real("quadratic", "", "b2, in compression only; 1.2 for strong shocks")
            .byDefault("0.0")
            .atLeast(0)
            .atMost(10)}},
      {"damping",
       BlockKind::single,
       "damping of everything",
       {real("mass", "1/s", "alpha of the force -alpha m v").byDefault("0.0").atLeast(0)}},
      {"boundary.fixed",
       BlockKind::repeated,
       "nodes that do not move",
       {text("node_set", "name; walls have base, base_course, top_course, left_end, right_end")
            .mustBeGiven(),
        components()}},
      withPulse({"boundary.velocity",
                 BlockKind::repeated,
                 "nodes whose velocity is prescribed",
                 {text("node_set", "name").mustBeGiven(),
                  real("velocity", "m/s", "vector, times the course in time").list(3).mustBeGiven(),
                  components()}},
                "step"),
      initialBlock("initial.velocity", "velocity at the start,",
                   {real("velocity", "m/s", "vector").list(3).byDefault("[0.0, 0.0, 0.0]"),
                    real("angular_velocity", "rad/s", "adds its cross product with X - center")
                        .list(3)
                        .byDefault("[0.0, 0.0, 0.0]"),
                    real("center", "m", "of the rotation").list(3).byDefault("[0.0, 0.0, 0.0]")}),
      initialBlock(
          "initial.deformation", "displacement at the start, gradient (X - center),",
          {real("gradient", "", "du/dX row by row: du_x/dX, du_x/dY, du_x/dZ, du_y/dX, ...")
               .list(9)
               .mustBeGiven(),
           real("center", "m", "does not move").list(3).byDefault("[0.0, 0.0, 0.0]")}),
  };
}

std::vector<BlockRule> methodBlocks() {
  return {
      {"contact",
       BlockKind::single,
       "contact between bodies",
       {boolean("enabled", "search and enforce contact").byDefault("true"),
        real("tolerance", "", "inflation of the search boxes, of the shortest element edge")
            .byDefault("0.05")
            .above(0)
            .atMost(0.45), // reaches twice that: not through a brick of one element
        word("scheme", {"energy_neutral", "penalty"},
             "first and last steps of a contact weighted to make no energy, or plain penalty")
            .byDefault("energy_neutral"),
        real("penalty", "",
             "stiffness s = k dt^2/m, where not given less with damping; stiffer contact may "
             "shorten the step; with edges below 1.55")
            .byDefault("0.9")
            .above(0)
            .below(1.95),
        real("lateral_tolerance", "", "accepted distance beyond a face's edge, in |xi|")
            .byDefault("0.05")
            .above(0)
            .atMost(0.5),
        real("edge_tolerance", "", "the same beyond edges of the body, where the force fades out")
            .byDefault("0.1")
            .above(0)
            .atMost(0.5),
        real("friction", "", "Coulomb's coefficient").byDefault("0.0").atLeast(0).atMost(100),
        real("friction_stiffness", "", "of the sticking spring, over the normal one")
            .byDefault("1.0")
            .above(0)
            .atMost(1),
        real("damping", "", "of the critical damping of a contact").byDefault("0.0").atLeast(0),
        boolean("edges", "edges that cross edges push each other").byDefault("true"),
        word("self", {"auto", "never", "always"},
             "contact within one body; auto: never for walls, always for Exodus meshes")
            .byDefault("auto"),
        word("guard", {"cut", "stop", "off"},
             "where a node could pass a face within a step: shorten the step, stop, or go on")
            .byDefault("cut")}},
      {"search",
       BlockKind::single,
       "the global search",
       {word("method", {"cluster", "paper", "reference"},
             "orders kept and refitted; the paper's scheme; the plain serial loop")
            .byDefault("cluster"),
        real("jitter", "", "of the nodes, of an edge (brickwall search)")
            .byDefault("0.01")
            .atLeast(0)
            .below(0.5),
        real("drift", "", "largest of a brick a step, of an edge (brickwall search)")
            .byDefault("0.01")
            .atLeast(0)
            .atMost(10),
        integer("repetitions", "searches counted (brickwall search)")
            .byDefault("10")
            .atLeast(1)
            .atMost(1e9),
        integer("warmup", "searches before them (brickwall search)")
            .byDefault("2")
            .atLeast(0)
            .atMost(1e9),
        integer("audit",
                "every so many steps, look at all pairs by plain loops and count those that the "
                "lists miss; 0: never")
            .byDefault("0")
            .atLeast(0)
            .atMost(1e15),
        integer("seed", "of jitter, drift and shuffle").byDefault("1").atLeast(0),
        boolean("local", "the local search too, or the global one alone (brickwall search)")
            .byDefault("true"),
        boolean("shuffle", "local nodes and faces in random order (brickwall search)")
            .byDefault("false")}},
      {"search.reuse",
       BlockKind::single,
       "lists of candidates kept over several steps; the contact forces are the same bit for bit",
       {real("margin", "",
             "of the shortest edge: boxes larger by it, a search when nodes have moved half of it; "
             "0: in every step; brickwall search: 0 where not given")
            .byDefault("0.1")
            .atLeast(0)
            .atMost(10)}},
      {"spare",
       BlockKind::single,
       "what the scene does not need is left out; no bit depends on it",
       {boolean("resting_bodies", "elements and nodes of bodies that nothing has moved yet")
            .byDefault("true"),
        boolean("free_bricks",
                "forces and loads of bricks that step by themselves, without contact")
            .byDefault("true"),
        boolean("lattices", "connectivity of bricks whose elements are a lattice")
            .byDefault("true"),
        boolean("still_contact",
                "contact of what has not moved, or not by so much that it could touch")
            .byDefault("true")}},
      {"time",
       BlockKind::single,
       "steps in time",
       {real("end", "s", "time at which the run ends").mustBeGiven().above(0),
        real("safety", "", "step over the stable step").byDefault("0.9").above(0).atMost(1),
        word("bound", {"lanczos", "element"},
             "stable step of whole bodies by their largest frequency, or of the worst element by "
             "itself")
            .byDefault("lanczos"),
        integer("steps", "end after so many steps").atLeast(1).atMost(1e15),
        integer("check_interval", "steps between checks of the stable step")
            .byDefault("500")
            .atLeast(1)
            .atMost(1e15)},
       true},
  };
}

std::vector<KeyRule> limitKeys(const char* GaugeRule::*fallback) {
  std::vector<KeyRule> keys;
  for (const GaugeRule& gauge : gauge_rules) {
    keys.push_back(real(gauge.key, "", gauge.help).above(0));
    if (*(gauge.*fallback))
      keys.back().byDefault(gauge.*fallback);
  }
  return keys;
}

std::vector<BlockRule> outputBlocks() {
  std::vector<BlockRule> blocks = {
      {"output",
       BlockKind::single,
       "what is written",
       {real("interval", "s", "between output steps; 0: first and last only")
            .byDefault("0.0")
            .atLeast(0),
        real("history_interval", "s", "between rows of history.csv; 0: every step")
            .byDefault("0.0")
            .atLeast(0),
        word("file_format", {"classic", "64bit_offset", "netcdf4"}, "of the Exodus files")
            .byDefault("64bit_offset"),
        word("precision", {"single", "double"}, "of fields in the Exodus files")
            .byDefault("double"),
        boolean("processor_id", "write each element's rank").byDefault("false")}},
      {"limits", BlockKind::single, "what the run must keep, else it ends with FAIL",
       limitKeys(&GaugeRule::stop)},
      {"limits.warn", BlockKind::single, "where the run only warns, once each",
       limitKeys(&GaugeRule::warn)},
  };
  blocks[1].keys.push_back(
      real("wall_time", "s", "wall clock time after which the run ends").above(0));
  return blocks;
}

} // namespace

const io::Schema& deckSchema() {
  static const io::Schema schema = [] {
    io::Schema all;
    for (const auto& part : {sceneBlocks(), loadBlocks(), methodBlocks(), outputBlocks()})
      all.insert(all.end(), part.begin(), part.end());
    return all;
  }();
  return schema;
}

} // namespace brickwall::miniapp
