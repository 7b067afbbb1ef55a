// The contents of a deck as plain structs. Their initial values are the defaults of the deck
// (*_blocks.cpp). Units are SI, or any consistent set that the deck states.
#pragma once

#include "contact/enforcement/law/enforcement_config.hpp"
#include "contact/surface/search_config.hpp"
#include "io/deck/deck.hpp"
#include "io/exodus/results_writer.hpp"
#include "io/wall/wall_layout.hpp"
#include "mechanics/element/bulk_viscosity.hpp"
#include "mechanics/element/material.hpp"
#include "mechanics/loads/pulse_shape.hpp"
#include "miniapp/deck/limits.hpp"

#include <mpi.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace brickwall::miniapp {

using Triple = std::array<double, 3>;

// [wall]
using io::WallConfig;
using Ends = io::WallEnds;

// [mesh], in place of [wall]
struct MeshConfig {
  // Path as the program opens it; the path in the deck is relative to the folder of the deck.
  std::string file;
};

// [material.<block>]
struct MaterialConfig {
  std::string block; // element block
  mechanics::Material material;
  std::string place; // for messages
};

// [element]
enum class Formulation {
  one_point, // with physical stabilisation, mechanics/element/hex8_one_point.hpp
  full // 2x2x2 points
};
enum class NodalMass {
  inertia, // that of each body is exact, mechanics/mesh/body_inertia.hpp
  row_sum // an eighth of each element at each of its corners
};

// Variation in time of a load or of a prescribed velocity. Time t counts from `start`; 0 before it.
using mechanics::PulseKind;
struct PulseConfig {
  PulseKind shape = PulseKind::step; // any but `constant`
  double start = 0; // time
  std::optional<double> duration = {}; // time; given for all shapes but `step`
  double decay = 1; // friedlander
};

// [[load.pressure]]
enum class Distribution { uniform, gaussian };
struct PressureConfig {
  std::string side_set;
  PulseConfig pulse = {PulseKind::half_sine};
  double peak = 0; // pressure
  Distribution distribution = Distribution::uniform;
  // gaussian: peak exp(-(r/radius)^2), arriving r/wave_speed later, with r the distance of the
  // reference position from center
  Triple center = {0, 0, 0}; // length
  double radius = 0; // length
  double wave_speed = 0; // length/time; 0: no delay
  bool follower = true; // acts on the current face along its current normal
  std::string place; // in the deck, such as "wall.toml:9"
};

// [[boundary.fixed]] and [[boundary.velocity]]
struct FixedConfig {
  std::string node_set;
  std::array<bool, 3> components = {true, true, true};
  std::string place; // in the deck, such as "wall.toml:9"
};
struct PrescribedVelocityConfig {
  std::string node_set;
  Triple velocity = {0, 0, 0}; // length/time
  std::array<bool, 3> components = {true, true, true};
  PulseConfig pulse; // multiplies the velocity
  std::string place; // in the deck, such as "wall.toml:9"
};

// The part of the scene to which an initial condition applies: one block, one brick of a wall, one
// body, or (none of them) all.
struct InitialSelection {
  std::optional<std::string> block;
  std::optional<std::array<std::int64_t, 3>> brick; // 0-based: along, across, course
  std::optional<std::int64_t> body; // 0-based
  std::string place; // in the deck, such as "wall.toml:9"

  bool isOfOneBody() const { return brick.has_value() || body.has_value(); }
  bool isOfAll() const { return !block.has_value() && !isOfOneBody(); }
};
// [[initial.velocity]]: velocity + angular_velocity x (X - center)
struct InitialVelocityConfig : InitialSelection {
  Triple velocity = {0, 0, 0}; // length/time
  Triple angular_velocity = {0, 0, 0}; // rad/time
  Triple center = {0, 0, 0}; // length
};
// [[initial.deformation]]: displacement gradient (X - center)
struct InitialDeformationConfig : InitialSelection {
  std::array<double, 9> gradient = {}; // H_ij = du_i/dX_j, row by row
  Triple center = {0, 0, 0}; // length
};

// [contact]
enum class SelfContact { automatic, never, always };
// Reaction to nodes and faces that move relative to each other by more than the tolerance of
// contact in one step.
enum class GuardAction { cut, stop, off };
// The keys that the deck has in common with the library are those of EnforcementConfig; the
// simulation sets the others.
struct ContactConfig : contact::EnforcementConfig {
  bool enabled = true;
  double tolerance = 0.05; // box inflation over the shortest skin edge
  bool edges = true; // edge-to-edge contact
  SelfContact self = SelfContact::automatic; // automatic: never for walls, always for Exodus meshes
  GuardAction guard = GuardAction::cut; // miniapp/simulation/tunnelling_guard.hpp
};

// [search]
using contact::SearchMethod;
enum class Decomposition { primary, surface, automatic };
struct SearchConfig {
  SearchMethod method = contact::SearchConfig().method;
  // reuse.margin over the shortest edge: the lists are kept until nodes have moved half of it; 0: a
  // search in every step
  double margin = 0.1;
  bool has_margin = false; // given by the deck
  Decomposition decomposition = Decomposition::primary; // miniapp/simulation/contact_balance.hpp
  // steps between audits, which count the pairs that the lists miss; 0: none
  std::int64_t audit = 0;
  // `brickwall search` only
  double jitter = 0.01; // over an edge
  double drift = 0.01; // over an edge, per step
  std::int64_t repetitions = 10; // counted searches
  std::int64_t warmup = 2; // searches before them that are not counted
  std::int64_t seed = 1;
  bool local = true; // the local search too
  bool shuffle = false; // local nodes and faces in random order
};

// [partition]: the ranks of the elements, miniapp/simulation/element_balance.hpp
enum class Rebalance { never, automatic, always };
struct PartitionConfig {
  Rebalance rebalance = Rebalance::never;
  std::int64_t interval = 20; // steps between checks
};

// [skip]: work that the scene does not need is skipped; the results are the same bit for bit.
struct SkipConfig {
  bool resting_bodies = true; // mechanics/step/resting_bodies.hpp
  bool free_bricks = true; // mechanics/step/free_bricks/free_bricks.hpp
  bool lattices = true; // mechanics/mesh/brick_lattice.hpp
  // contact/enforcement/dormancy/stationary_nodes.hpp, sleeping_blocks.hpp
  bool stationary_contact = true;
};

// [time]
// The stable step is that of whole bodies (mechanics/stability/largest_frequency.hpp), or of the
// worst element by itself.
enum class StepBound { lanczos, element };
struct TimeConfig {
  double end = 0; // time
  double safety = 0.9; // chi: step over the stable step
  StepBound bound = StepBound::lanczos;
  std::optional<std::int64_t> steps; // stop after so many, even if `end` is not reached
  std::int64_t check_interval = 500; // steps between checks of the stable step
};

// [output]
enum class Precision { float32, float64 };
// Fields of the Exodus files, nodal ones first; miniapp/output.md defines them.
enum class OutputField {
  displacement,
  velocity,
  force_contact,
  contact_status,
  contact_gap,
  contact_pressure,
  slip_velocity,
  slip_distance,
  stress,
  pressure,
  energy_density,
  von_mises,
  principal_stress,
  strain_energy,
  candidate_pairs,
  search_time,
  brick_id,
  processor_id
};
struct OutputConfig {
  double interval = 0; // time; 0: the first and last state only
  double history_interval = 0; // time; 0: every step
  bool balance = false; // writes balance.csv
  io::FileFormat file_format = io::ResultsConfig().format;
  Precision precision = Precision::float64;
  std::vector<OutputField> fields = {
      OutputField::displacement,   OutputField::velocity,       OutputField::force_contact,
      OutputField::contact_status, OutputField::contact_gap,    OutputField::stress,
      OutputField::pressure,       OutputField::energy_density, OutputField::brick_id};
  bool has(OutputField field) const {
    return std::find(fields.begin(), fields.end(), field) != fields.end();
  }
};

// [output.checkpoint]: restart files, miniapp/restart/README.md
struct CheckpointConfig {
  std::optional<std::int64_t> steps; // between checkpoints
  std::optional<double> minutes; // of wall clock between checkpoints
  bool any() const { return steps || minutes; }
};

// A row of the table of consistent units in reference.md; none: unknown, or dimensionless.
enum class UnitSystem { m_kg_s, mm_t_s, mm_kg_ms, cm_g_us, none };

struct Config {
  std::string title;
  UnitSystem units = UnitSystem::m_kg_s;
  std::optional<WallConfig> wall; // exactly one of wall and mesh is given
  std::optional<MeshConfig> mesh;
  std::vector<MaterialConfig> materials;
  Formulation formulation = Formulation::one_point;
  NodalMass mass = NodalMass::inertia;
  std::vector<PressureConfig> pressures;
  Triple gravity = {0, 0, 0}; // length/time^2
  mechanics::BulkViscosity viscosity; // [viscosity]
  double mass_damping = 0; // [damping] mass, 1/time: force -mass_damping m v
  std::vector<FixedConfig> fixed;
  std::vector<PrescribedVelocityConfig> prescribed;
  std::vector<InitialVelocityConfig> initial_velocities;
  std::vector<InitialDeformationConfig> initial_deformations;
  ContactConfig contact;
  SearchConfig search;
  PartitionConfig partition;
  SkipConfig skip;
  TimeConfig time;
  OutputConfig output;
  CheckpointConfig checkpoint;
  LimitsConfig limits;

  std::string deck_path;
  std::string resolved_deck; // TOML, all defaults filled in, resolves to itself
  std::vector<std::string> warnings; // former names and unused keys in the deck, one line each

  // The material of an element block; "half_brick" falls back to "brick". Null when there is none.
  const mechanics::Material* materialOf(const std::string& block) const;
};

// The table of all blocks and keys.
const io::Schema& deckSchema();

// Collective; rank 0 reads the deck and judges it. `overrides` as in --set. Throws InputError with
// all faults of the deck.
Config readConfig(MPI_Comm comm, const std::string& deck_path,
                  const std::vector<std::string>& overrides);

// The same from a text in memory; not collective. For tests and fuzzing.
Config parseConfig(const std::string& deck_text, const std::string& deck_path,
                   const std::vector<std::string>& overrides = {});

// Inflation of the boxes of nodes and faces, length: contact.tolerance of the shortest edge, or
// more on long faces, so that the two together reach half as far again as a node may stand beyond
// the edge of a face and still be in contact with it.
double boxTolerance(const ContactConfig& contact, double shortest_edge, double longest_edge);

// Greatest penetration at which a contact may become active, length: the tolerances of node and
// face over the shortest edge.
double deepestActivation(const ContactConfig& contact, double shortest_edge);

// Whether contacts may be damped: by contact.damping, or because they settle.
bool dampsContacts(const ContactConfig& contact);

// Whether pairs within one body are excluded from the search.
bool dropsSameBody(const Config& config);

// The search of the deck as the contact library takes it.
contact::SearchConfig searchConfig(const Config& config, double tolerance, bool drop_same_body);

} // namespace brickwall::miniapp
