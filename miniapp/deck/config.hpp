// What a deck says, as plain structs with defaults: the only place where deck keys become values of
// the program. Units are SI, or any consistent set that the deck says.
#pragma once

#include "contact/surface/search_config.hpp"
#include "io/deck/deck.hpp"
#include "mechanics/element/bulk_viscosity.hpp"
#include "mechanics/mesh/hex_mesh.hpp"
#include "miniapp/deck/limits.hpp"

#include <mpi.h>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace brickwall::miniapp {

using Triple = std::array<double, 3>;

// [wall]
enum class Ends { flush, ragged };
struct WallConfig {
  std::array<std::int64_t, 3> bricks = {8, 1, 10}; // along, across, courses
  Triple brick = {0.2, 0.1, 0.1}; // brick size, length
  std::array<std::int64_t, 3> elements = {8, 4, 4}; // per brick
  double gap = 0; // between neighbouring bricks, length
  Ends ends = Ends::flush;
};

// [mesh], in place of [wall]
struct MeshConfig {
  std::string file; // path as the program opens it; the deck's is relative to the deck's folder
};

// [material.<block>]
struct MaterialConfig {
  std::string block; // element block
  mechanics::Material material;
};

// [element]
enum class Formulation {
  tlps, // one point with assumed-strain hourglass stiffness
  full // 2x2x2 points
};

// Course in time of a load or of a prescribed velocity. Time t counts from `start`; 0 before it.
//   step        1, until duration if there is one
//   half_sine   sin(pi t / duration), t < duration
//   sin_squared sin(pi t / duration)^2, t < duration
//   triangle    1 - |2 t / duration - 1|, t < duration
//   friedlander (1 - t / duration) exp(-decay t / duration), t < duration
enum class PulseShape { step, half_sine, sin_squared, triangle, friedlander };
struct PulseConfig {
  PulseShape shape = PulseShape::step;
  double start = 0; // time
  std::optional<double> duration; // time; always there but for `step`
  double decay = 1; // of friedlander
};

// [[load.pressure]]
enum class Distribution { uniform, gaussian };
struct PressureConfig {
  std::string side_set;
  PulseConfig pulse;
  double peak = 0; // pressure
  Distribution distribution = Distribution::uniform;
  // gaussian: peak exp(-(r/radius)^2), r the distance of the reference position to center, arriving
  // r/wave_speed later
  Triple center = {0, 0, 0}; // length
  double radius = 0; // length
  double wave_speed = 0; // length/time; 0: no delay
  bool follower = true; // acts on the current face along its current normal
};

// [[boundary.fixed]] and [[boundary.velocity]]
struct FixedConfig {
  std::string node_set;
  std::array<bool, 3> components = {true, true, true};
};
struct PrescribedVelocityConfig {
  std::string node_set;
  Triple velocity = {0, 0, 0}; // length/time
  std::array<bool, 3> components = {true, true, true};
  PulseConfig pulse; // multiplies the velocity
};

// What an initial condition concerns: one block, one brick of a wall, one body, or (none of them) everything.
struct InitialSelection {
  std::optional<std::string> block;
  std::optional<std::array<std::int64_t, 3>> brick; // 0-based: along, across, course
  std::optional<std::int64_t> body; // 0-based
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
enum class ContactScheme { energy_neutral, penalty };
// What is done where nodes and faces move against each other by more than contact reaches in a step.
enum class GuardAction { cut, stop, off };
struct ContactConfig {
  bool enabled = true;
  double tolerance = 0.05; // box inflation, of the shortest skin edge
  ContactScheme scheme = ContactScheme::energy_neutral; // contact/enforcement/enforcement.hpp
  double penalty = 0.9; // s
  double lateral_tolerance = 0.05; // accepted |xi| - 1 beyond a face's edge
  double edge_tolerance = 0.1; // the same beyond true edges, where the force fades out
  double friction = 0; // mu, Coulomb
  double friction_stiffness = 1; // k_t/k
  double damping = 0; // zeta, of the critical damping of a contact
  bool edges = true; // edges that cross edges push each other
  SelfContact self = SelfContact::automatic; // automatic: never for walls, always for Exodus meshes
  GuardAction guard = GuardAction::cut; // miniapp/simulation/tunnelling_guard.hpp
};

// [search]
using contact::SearchMethod;
struct SearchConfig {
  SearchMethod method = SearchMethod::cluster;
  // reuse.margin, of the shortest edge: the lists are kept until nodes have moved half of it; 0: a search in every step
  double margin = 0.1;
  bool has_margin = false; // the deck tells it
  double jitter = 0.01; // of an edge, `brickwall search` only
  double drift = 0.01; // of an edge a step, `brickwall search` only
  std::int64_t repetitions = 10; // counted searches, `brickwall search` only
  std::int64_t warmup = 2; // searches before them that are not counted
  std::int64_t seed = 1;
  bool local = true; // the local search too, `brickwall search` only
  std::int64_t audit =
      0; // every so many steps all pairs are looked at, to count those that the lists miss; 0: never
  bool shuffle = false; // local nodes and faces in no useful order, `brickwall search` only
};

// [spare]: what a scene does not need is left out, bit for bit the same
struct SkipConfig {
  bool resting_bodies = true; // mechanics/step/resting_bodies.hpp
  bool free_bricks = true; // mechanics/step/free_bricks/free_bricks.hpp
  bool lattices = true; // mechanics/mesh/brick_lattice.hpp
  bool still_contact =
      true; // contact/enforcement/dormancy/stationary_nodes.hpp, sleeping_blocks.hpp
};

// [time]
// What the stable step is that of: whole bodies (mechanics/stability/largest_frequency.hpp), or the worst element by itself.
enum class StepBound { lanczos, element };
struct TimeConfig {
  double end = 0; // time
  double safety = 0.9; // chi: of the stable step
  StepBound bound = StepBound::lanczos;
  std::optional<std::int64_t> steps; // stop after so many, even before `end`
  std::int64_t check_interval = 500; // steps between checks of the stable step
};

// [output]
enum class FileFormat { classic, offset64, netcdf4 };
enum class Precision { single, float64 };
struct OutputConfig {
  double interval = 0; // time; 0: the first and last state only
  double history_interval = 0; // time; 0: every step
  FileFormat file_format = FileFormat::offset64;
  Precision precision = Precision::float64;
  bool processor_id = false; // write the element field processor_id
};

struct Config {
  std::string title;
  std::optional<WallConfig> wall; // exactly one of wall and mesh is there
  std::optional<MeshConfig> mesh;
  std::vector<MaterialConfig> materials;
  Formulation formulation = Formulation::tlps;
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
  SkipConfig spare;
  TimeConfig time;
  OutputConfig output;
  LimitsConfig limits;

  std::string deck_path;
  std::string resolved_deck; // TOML, all defaults filled in, resolves to itself

  // The material of an element block; "half_brick" falls back to "brick". Null when there is none.
  const mechanics::Material* materialOf(const std::string& block) const;
};

// The table of all blocks and keys.
const io::Schema& deckSchema();

// Collective; rank 0 reads and decides. `overrides` as in --set. Throws InputError with all faults
// of the deck.
Config readConfig(MPI_Comm comm, const std::string& deck_path,
                  const std::vector<std::string>& overrides);

// The same from a text in memory; not collective. For tests and fuzzing.
Config parseConfig(const std::string& deck_text, const std::string& deck_path,
                   const std::vector<std::string>& overrides = {});

} // namespace brickwall::miniapp
