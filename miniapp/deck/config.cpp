// From a checked deck to the structs of config.hpp, with the checks that concern several keys.
#include "miniapp/deck/config.hpp"

#include "mechanics/element/material.hpp"
#include "mechanics/stability/stable_time_step.hpp"
#include "miniapp/deck/boundary_conflicts.hpp"

#include <algorithm>
#include <filesystem>

namespace brickwall::miniapp {
namespace {

using io::Deck;

std::string instance(const std::string& block, int index) {
  return block + "[" + std::to_string(index) + "]";
}

Triple triple(const Deck& deck, const std::string& block, const std::string& key) {
  const std::vector<double> values = deck.reals(block, key);
  return values.size() == 3 ? Triple{values[0], values[1], values[2]} : Triple{0, 0, 0};
}

std::array<std::int64_t, 3> counts(const Deck& deck, const std::string& block,
                                   const std::string& key) {
  const std::vector<std::int64_t> values = deck.integers(block, key);
  return values.size() == 3 ? std::array<std::int64_t, 3>{values[0], values[1], values[2]}
                            : std::array<std::int64_t, 3>{1, 1, 1};
}

std::optional<double> optionalReal(const Deck& deck, const std::string& block,
                                   const std::string& key) {
  if (!deck.isGood(block, key))
    return std::nullopt;
  return deck.real(block, key);
}

// The enumerator whose place in `words` the value has; the schema has checked that it is one of them.
template <class Enum>
Enum choice(const Deck& deck, const std::string& block, const std::string& key,
            std::initializer_list<const char*> words) {
  const std::string value = deck.text(block, key);
  int index = 0;
  for (const char* word : words) {
    if (value == word)
      return static_cast<Enum>(index);
    ++index;
  }
  return static_cast<Enum>(0);
}

WallConfig readWall(Deck& deck) {
  WallConfig wall;
  wall.bricks = counts(deck, "wall", "bricks");
  wall.brick = triple(deck, "wall", "brick");
  wall.elements = counts(deck, "wall", "elements");
  wall.gap = deck.real("wall", "gap");
  wall.ends = choice<Ends>(deck, "wall", "ends", {"flush", "ragged"});
  if (!deck.isGood("wall", "bricks") || !deck.isGood("wall", "elements"))
    return wall;
  const bool has_half_bricks = wall.ends == Ends::flush && wall.bricks[2] > 1;
  if (has_half_bricks && wall.elements[0] % 2 != 0)
    deck.complain("wall", "elements", "an odd number of elements along a brick",
                  "an even one, which flush ends need for half bricks (or ends = \"ragged\")");
  if (deck.isGood("wall", "brick") && has_half_bricks && wall.gap >= wall.brick[0])
    deck.complain("wall", "gap", "a gap as long as a brick", "a shorter one, for half bricks");
  constexpr double most_elements = 1e15;
  double elements = 1;
  for (int d = 0; d < 3; ++d)
    elements *= static_cast<double>(wall.bricks[d]) * static_cast<double>(wall.elements[d]);
  if (elements > most_elements)
    deck.complain("wall", "bricks", "a wall of more than 1e15 elements", "a smaller wall");
  return wall;
}

MeshConfig readMesh(Deck& deck) {
  namespace fs = std::filesystem;
  if (!deck.isGood("mesh", "file"))
    return {};
  if (deck.text("mesh", "file").empty())
    deck.complain("mesh", "file", "an empty path", "the path of an Exodus file");
  const fs::path given = deck.text("mesh", "file");
  const fs::path folder = fs::path(deck.path()).parent_path();
  const fs::path absolute =
      fs::absolute(given.is_absolute() ? given : folder / given).lexically_normal();
  deck.assignText("mesh", "file", absolute.string());
  return {absolute.string()};
}

void readScene(Deck& deck, Config& config) {
  const bool has_wall = deck.hasBlock("wall"), has_mesh = deck.hasBlock("mesh");
  if (has_wall)
    config.wall = readWall(deck);
  if (has_mesh)
    config.mesh = readMesh(deck);
  if (has_wall && has_mesh)
    deck.complain("mesh", "", "[mesh] beside [wall]", "exactly one of them");
  if (!has_wall && !has_mesh)
    deck.complain("", "", "neither [wall] nor [mesh]", "exactly one of them");
}

std::vector<MaterialConfig> readMaterials(Deck& deck) {
  std::vector<MaterialConfig> materials;
  for (const std::string& name : deck.names("material")) {
    const std::string block = "material." + name;
    mechanics::Material material;
    material.model =
        choice<mechanics::MaterialModel>(deck, block, "model", {"neo_hookean", "svk", "linear"});
    material.density = deck.real(block, "density");
    material.youngs = deck.real(block, "youngs_modulus");
    material.poisson = deck.real(block, "poissons_ratio");
    materials.push_back({name, material});
  }
  if (materials.empty())
    deck.complain("", "", "no material", "a table such as [material.brick]");
  const auto has = [&](const std::string& name) {
    return std::any_of(materials.begin(), materials.end(),
                       [&](const MaterialConfig& m) { return m.block == name; });
  };
  if (deck.hasBlock("wall"))
    for (const MaterialConfig& material : materials)
      if (material.block != "brick" && material.block != "half_brick")
        deck.complain("material." + material.block, "", "the name \"" + material.block + "\"",
                      "one of the wall's blocks, \"brick\" or \"half_brick\"");
  if (deck.hasBlock("wall") && !materials.empty() && !has("brick"))
    deck.complain("", "", "no [material.brick]", "the material of the wall's bricks");
  return materials;
}

PulseConfig readPulse(Deck& deck, const std::string& block) {
  PulseConfig pulse;
  pulse.shape = choice<PulseShape>(deck, block, "shape",
                                   {"step", "half_sine", "sin_squared", "triangle", "friedlander"});
  pulse.start = deck.real(block, "start");
  pulse.duration = optionalReal(deck, block, "duration");
  pulse.decay = optionalReal(deck, block, "decay").value_or(pulse.decay);
  if (deck.isGood(block, "shape") && pulse.shape != PulseShape::step &&
      !deck.has(block, "duration"))
    deck.complain(block, "shape", "no duration for shape \"" + deck.text(block, "shape") + "\"",
                  "a key duration = a number above 0, in s");
  if (deck.has(block, "decay") && deck.isGood(block, "shape") &&
      pulse.shape != PulseShape::friedlander)
    deck.complain(block, "decay", "decay beside shape \"" + deck.text(block, "shape") + "\"",
                  "decay only with shape = \"friedlander\"");
  return pulse;
}

std::vector<PressureConfig> readPressures(Deck& deck) {
  std::vector<PressureConfig> pressures;
  for (int i = 0; i < deck.count("load.pressure"); ++i) {
    const std::string block = instance("load.pressure", i);
    PressureConfig load;
    load.side_set = deck.text(block, "side_set");
    load.pulse = readPulse(deck, block);
    load.peak = deck.real(block, "peak");
    load.distribution = choice<Distribution>(deck, block, "distribution", {"uniform", "gaussian"});
    load.center = triple(deck, block, "center");
    load.radius = deck.real(block, "radius");
    load.wave_speed = deck.real(block, "wave_speed");
    load.follower = deck.boolean(block, "follower");
    const bool is_gaussian = load.distribution == Distribution::gaussian;
    for (const std::string key : {"center", "radius"})
      if (is_gaussian && !deck.has(block, key))
        deck.complain(block, "distribution", "a gaussian without \"" + key + "\"",
                      "keys center = [x, y, z] and radius, in m");
    for (const std::string key : {"center", "radius", "wave_speed"})
      if (!is_gaussian && deck.has(block, key) && deck.isGood(block, "distribution"))
        deck.complain(block, key, key + " beside a uniform distribution",
                      "distribution = \"gaussian\"");
    pressures.push_back(load);
  }
  return pressures;
}

std::array<bool, 3> readComponents(const Deck& deck, const std::string& block) {
  std::array<bool, 3> components = {false, false, false};
  for (const std::string& word : deck.texts(block, "components"))
    components[static_cast<std::size_t>(word[0] - 'x')] = true;
  return components;
}

void readBoundaries(Deck& deck, Config& config) {
  for (int i = 0; i < deck.count("boundary.fixed"); ++i) {
    const std::string block = instance("boundary.fixed", i);
    config.fixed.push_back({deck.text(block, "node_set"), readComponents(deck, block)});
  }
  for (int i = 0; i < deck.count("boundary.velocity"); ++i) {
    const std::string block = instance("boundary.velocity", i);
    config.prescribed.push_back({deck.text(block, "node_set"), triple(deck, block, "velocity"),
                                 readComponents(deck, block), readPulse(deck, block)});
  }
  complainOfConflicts(config, deck);
}

InitialSelection readSelection(Deck& deck, const std::string& block) {
  InitialSelection chosen;
  if (deck.isGood(block, "block"))
    chosen.block = deck.text(block, "block");
  if (deck.isGood(block, "brick"))
    chosen.brick = counts(deck, block, "brick");
  if (deck.isGood(block, "body"))
    chosen.body = deck.integer(block, "body");
  const int selectors =
      deck.has(block, "block") + deck.has(block, "brick") + deck.has(block, "body");
  if (selectors > 1)
    deck.complain(block, "", "several of block, brick and body", "at most one of them");
  if (deck.has(block, "brick") && !deck.hasBlock("wall"))
    deck.complain(block, "brick", "a brick without a [wall]", "block or body for a [mesh]");
  if (chosen.brick && deck.hasBlock("wall") && deck.isGood("wall", "bricks")) {
    // Odd courses of a flush wall hold one piece more: two halves and one whole brick less.
    std::array<std::int64_t, 3> pieces = counts(deck, "wall", "bricks");
    if (deck.text("wall", "ends") == "flush" && (*chosen.brick)[2] % 2 == 1)
      ++pieces[0];
    for (std::size_t d = 0; d < 3; ++d)
      if ((*chosen.brick)[d] >= pieces[d])
        deck.complain(block, "brick", "a brick outside of the wall",
                      "indices from 0, below the numbers of bricks");
  }
  return chosen;
}

std::vector<InitialVelocityConfig> readInitialVelocities(Deck& deck) {
  std::vector<InitialVelocityConfig> velocities;
  for (int i = 0; i < deck.count("initial.velocity"); ++i) {
    const std::string block = instance("initial.velocity", i);
    if (!deck.has(block, "velocity") && !deck.has(block, "angular_velocity"))
      deck.complain(block, "", "neither velocity nor angular_velocity",
                    "at least one of them, a list of 3 numbers");
    if (deck.has(block, "center") && !deck.has(block, "angular_velocity"))
      deck.complain(block, "center", "center without angular_velocity",
                    "angular_velocity = [wx, wy, wz], in rad/s");
    velocities.push_back({readSelection(deck, block), triple(deck, block, "velocity"),
                          triple(deck, block, "angular_velocity"), triple(deck, block, "center")});
  }
  return velocities;
}

std::vector<InitialDeformationConfig> readInitialDeformations(Deck& deck) {
  std::vector<InitialDeformationConfig> deformations;
  for (int i = 0; i < deck.count("initial.deformation"); ++i) {
    const std::string block = instance("initial.deformation", i);
    InitialDeformationConfig initial{readSelection(deck, block), {}, triple(deck, block, "center")};
    if (deck.isGood(block, "gradient")) {
      const std::vector<double> entries = deck.reals(block, "gradient");
      std::copy(entries.begin(), entries.end(), initial.gradient.begin());
      double H[3][3];
      for (int k = 0; k < 9; ++k)
        H[k / 3][k % 3] = entries[static_cast<std::size_t>(k)];
      if (!(1 + mechanics::volumeChange(H) > 0))
        deck.complain(block, "gradient", "a gradient that turns bodies inside out",
                      "det(I + gradient) above 0");
    }
    deformations.push_back(initial);
  }
  return deformations;
}

void readMethods(Deck& deck, Config& config) {
  config.formulation = choice<Formulation>(deck, "element", "formulation", {"tlps", "full"});
  config.gravity = triple(deck, "gravity", "acceleration");
  config.viscosity.linear = deck.real("viscosity", "linear");
  config.viscosity.quadratic = deck.real("viscosity", "quadratic");
  config.mass_damping = deck.real("damping", "mass");

  config.contact.enabled = deck.boolean("contact", "enabled");
  config.contact.tolerance = deck.real("contact", "tolerance");
  config.contact.scheme =
      choice<ContactScheme>(deck, "contact", "scheme", {"energy_neutral", "penalty"});
  config.contact.lateral_tolerance = deck.real("contact", "lateral_tolerance");
  config.contact.edge_tolerance = deck.real("contact", "edge_tolerance");
  config.contact.friction = deck.real("contact", "friction");
  config.contact.friction_stiffness = deck.real("contact", "friction_stiffness");
  config.contact.damping = deck.real("contact", "damping");
  if (!deck.has("contact", "penalty"))
    deck.assignReal(
        "contact", "penalty",
        mechanics::penaltyForMassFraction(config.contact.penalty, config.contact.damping));
  config.contact.penalty = deck.real("contact", "penalty");
  config.contact.edges = deck.boolean("contact", "edges");
  config.contact.self = choice<SelfContact>(deck, "contact", "self", {"auto", "never", "always"});
  config.contact.guard = choice<GuardAction>(deck, "contact", "guard", {"cut", "stop", "off"});

  config.search.method =
      choice<SearchMethod>(deck, "search", "method", {"cluster", "paper", "reference"});
  config.search.margin = deck.real("search.reuse", "margin");
  config.search.has_margin = deck.has("search.reuse", "margin");
  config.search.jitter = deck.real("search", "jitter");
  config.search.drift = deck.real("search", "drift");
  config.search.repetitions = deck.integer("search", "repetitions");
  config.search.warmup = deck.integer("search", "warmup");
  config.search.audit = deck.integer("search", "audit");
  config.search.seed = deck.integer("search", "seed");
  config.search.local = deck.boolean("search", "local");
  config.search.shuffle = deck.boolean("search", "shuffle");

  config.spare.resting_bodies = deck.boolean("spare", "resting_bodies");
  config.spare.free_bricks = deck.boolean("spare", "free_bricks");
  config.spare.lattices = deck.boolean("spare", "lattices");
  config.spare.still_contact = deck.boolean("spare", "still_contact");

  config.time.end = deck.real("time", "end");
  config.time.safety = deck.real("time", "safety");
  config.time.bound = choice<StepBound>(deck, "time", "bound", {"lanczos", "element"});
  if (deck.isGood("time", "steps"))
    config.time.steps = deck.integer("time", "steps");
  config.time.check_interval = deck.integer("time", "check_interval");
}

void readOutput(const Deck& deck, Config& config) {
  config.output.interval = deck.real("output", "interval");
  config.output.history_interval = deck.real("output", "history_interval");
  config.output.file_format =
      choice<FileFormat>(deck, "output", "file_format", {"classic", "64bit_offset", "netcdf4"});
  config.output.precision = choice<Precision>(deck, "output", "precision", {"single", "double"});
  config.output.processor_id = deck.boolean("output", "processor_id");
  for (int g = 0; g < num_gauges; ++g) {
    const std::string key = gauge_rules[g].key;
    config.limits.stop[g] = optionalReal(deck, "limits", key).value_or(HUGE_VAL);
    config.limits.warn[g] = optionalReal(deck, "limits.warn", key).value_or(HUGE_VAL);
  }
  config.limits.wall_time = optionalReal(deck, "limits", "wall_time");
}

// Everything but the verdict: the caller asks the deck for its faults.
Config readDeck(Deck& deck) {
  Config config;
  config.deck_path = deck.path();
  config.title = deck.text("", "title");
  readScene(deck, config);
  config.materials = readMaterials(deck);
  config.pressures = readPressures(deck);
  readBoundaries(deck, config);
  config.initial_velocities = readInitialVelocities(deck);
  config.initial_deformations = readInitialDeformations(deck);
  readMethods(deck, config);
  readOutput(deck, config);
  return config;
}

} // namespace

const mechanics::Material* Config::materialOf(const std::string& block) const {
  for (const std::string& name : {block, std::string(block == "half_brick" ? "brick" : "")})
    for (const MaterialConfig& material : materials)
      if (material.block == name)
        return &material.material;
  return nullptr;
}

Config readConfig(MPI_Comm comm, const std::string& deck_path,
                  const std::vector<std::string>& overrides) {
  Deck deck = Deck::read(comm, deck_path, overrides, deckSchema());
  Config config = readDeck(deck);
  deck.finish(comm);
  config.resolved_deck = deck.resolved();
  return config;
}

Config parseConfig(const std::string& deck_text, const std::string& deck_path,
                   const std::vector<std::string>& overrides) {
  Deck deck = Deck::parse(deck_text, deck_path, overrides, deckSchema());
  Config config = readDeck(deck);
  deck.finish();
  config.resolved_deck = deck.resolved();
  return config;
}

} // namespace brickwall::miniapp
