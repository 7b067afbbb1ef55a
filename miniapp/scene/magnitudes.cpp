#include "miniapp/scene/magnitudes.hpp"

#include "contact/base/mpi.hpp"
#include "contact/base/to_device.hpp"
#include "contact/base/vec3.hpp"
#include "io/wall/wall_layout.hpp"
#include "mechanics/mesh/combine_by_body.hpp"
#include "miniapp/scene/loads.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <unordered_map>

namespace brickwall::miniapp {

namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double absurd_share = 0.1; // of the wave speed or the modulus
constexpr double max_crossings = 1e6; // case V13: 6e5

// Units of length and time by the earth's gravity in them; 20 to 20,000 m/s, between gels and the
// hardest solids, are the wave speeds to expect. Without this gravity, those of all these units
// are.
struct Units {
  const char* names;
  double gravity, speed; // 9.81 m/s^2 and 1 m/s
};
constexpr Units known_units[] = {{"m and s", 9.81, 1},
                                 {"mm and s", 9810, 1e3},
                                 {"mm and ms", 9.81e-3, 1},
                                 {"cm and s", 981, 1e2},
                                 {"cm and us", 9.81e-10, 1e-4}};
constexpr double slowest = 20, fastest = 20000; // m/s
// Solids from foams to osmium, kg/m3: there is hardly such a number in another set of units.
constexpr double least_density = 100, greatest_density = 25000;

const Units* unitsOf(double gravity) {
  for (const Units& units : known_units)
    if (std::fabs(gravity - units.gravity) < 0.01 * units.gravity)
      return &units;
  return nullptr;
}

// The box of a body, low corner and negative high one, and its lowest wave speed.
struct BodyExtent {
  global_id body;
  double least[7] = {HUGE_VAL, HUGE_VAL, HUGE_VAL, HUGE_VAL, HUGE_VAL, HUGE_VAL, HUGE_VAL};

  void include(int i, double value) { least[i] = minOf(least[i], value); }
};

// Of each body with elements on this rank, which may have only some of them.
std::vector<BodyExtent> extentsHere(const Config& config, const io::MeshPart& part) {
  std::vector<BodyExtent> extents;
  std::unordered_map<global_id, std::size_t> place_of_body;
  std::size_t place = 0;
  for (int elem = 0; elem < part.numElems(); ++elem) {
    const global_id id = part.elem_body[elem];
    if (elem == 0 || id != part.elem_body[elem - 1])
      place = place_of_body.emplace(id, extents.size()).first->second;
    if (place == extents.size())
      extents.push_back({id});
    BodyExtent& body = extents[place];
    for (int corner = 0; corner < 8; ++corner)
      for (int d = 0; d < 3; ++d) {
        const auto node = static_cast<std::size_t>(part.elem_nodes[8 * elem + corner]);
        const double x = part.coordinates[3 * node + d];
        body.include(d, x);
        body.include(3 + d, -x);
      }
    const auto& block = part.blocks[part.elem_block[elem]];
    body.include(6, config.materialOf(block.name)->dilatationalSpeed());
  }
  return extents;
}

void addCrossings(MPI_Comm comm, const Config& config, const io::MeshPart& part,
                  Magnitudes& result) {
  const auto extents = mechanics::combineByBody(comm, extentsHere(config, part),
                                                [](BodyExtent& a, const BodyExtent& b) {
                                                  for (int i = 0; i < 7; ++i)
                                                    a.include(i, b.least[i]);
                                                });
  for (const BodyExtent& body : extents)
    for (int d = 0; d < 3; ++d) {
      const double time = (-body.least[3 + d] - body.least[d]) / body.least[6];
      result.shortest_crossing = minOf(result.shortest_crossing, time);
      result.longest_crossing = maxOf(result.longest_crossing, time);
    }
  result.shortest_crossing = allReduce(comm, result.shortest_crossing, MPI_MIN);
  result.longest_crossing = allReduce(comm, result.longest_crossing, MPI_MAX);
}

void raisePressure(Magnitudes& result, double pressure, const char* source) {
  if (pressure <= result.joint_pressure)
    return;
  result.joint_pressure = pressure;
  result.pressure_source = source;
}

double ownedMass(MPI_Comm comm, const Scene& scene) {
  const auto mass = toHost(scene.mass);
  double sum = 0;
  for (std::size_t node = 0; node < scene.node_is_owned.size(); ++node)
    if (scene.node_is_owned[node])
      sum += mass(node);
  return allReduce(comm, sum, MPI_SUM);
}

// Of a unit peak until the end of the run, time.
double impulseOf(const PulseConfig& pulse, double end) {
  const double duration = minOf(pulse.duration.value_or(HUGE_VAL), end - pulse.start);
  return duration > 0 ? duration * toPulseShape(pulse).mean({0, duration}) : 0;
}

// Of a wall, above z = 0; HUGE_VAL if its foot is not fixed.
double fixedHeight(const Config& config) {
  double height = HUGE_VAL;
  for (const FixedConfig& fixed : config.fixed) {
    if (!(fixed.components[1] && fixed.components[2]))
      continue;
    if (fixed.node_set == io::WallLayout::nodeSetName(io::wall_base_course))
      return config.wall->brick[2] + config.wall->gap;
    if (fixed.node_set == io::WallLayout::nodeSetName(io::wall_base))
      height = 0;
  }
  return height;
}

void addWall(const Config& config, Magnitudes& result) {
  const WallConfig& wall = *config.wall;
  const io::WallLayout layout(wall);
  const mechanics::Material& material = *config.materialOf("brick");
  const double area = wall.brick[1] * wall.brick[2];
  result.mass =
      static_cast<double>(layout.numWholeBricks()) * material.density * area * wall.brick[0];
  if (layout.numHalfBricks() > 0)
    result.mass += static_cast<double>(layout.numHalfBricks()) *
                   config.materialOf("half_brick")->density * area * 0.5 *
                   (wall.brick[0] - wall.gap);
  const auto extent = [&](int d) {
    return static_cast<double>(wall.bricks[d]) * (wall.brick[d] + wall.gap) - wall.gap;
  };
  const double height = extent(2), free_height = height - fixedHeight(config), root = 1.8751040687;
  if (free_height > 0)
    result.frequency = root * root / (2 * pi) * extent(1) / std::sqrt(12.0) *
                       std::sqrt(material.youngs / material.density) / (free_height * free_height);
  for (const PressureConfig& load : config.pressures) {
    const auto acts_on = [&](io::WallSide a, io::WallSide b) {
      return load.side_set == io::WallLayout::sideSetName(a) ||
             load.side_set == io::WallLayout::sideSetName(b);
    };
    const int normal = acts_on(io::wall_left, io::wall_right)   ? 0
                       : acts_on(io::wall_front, io::wall_back) ? 1
                                                                : 2;
    result.speeds.push_back(std::fabs(load.peak) * impulseOf(load.pulse, config.time.end) /
                            (material.density * wall.brick[normal]));
  }
  const auto thinnest = std::min_element(wall.brick.begin(), wall.brick.end()) - wall.brick.begin();
  result.elements_through = static_cast<int>(wall.elements[thinnest]);
  raisePressure(result, material.density * norm(toVec3(config.gravity)) * height, "weight");
}

// The penetration of a joint of matching meshes under its pressure.
void addJoints(const Config& config, const Scene& scene, double dt, Magnitudes& result) {
  double density = HUGE_VAL, speed = 0, impedance = 0;
  for (const auto& block : scene.part.blocks) {
    const mechanics::Material& material = *config.materialOf(block.name);
    density = minOf(density, material.density);
    speed = maxOf(speed, material.dilatationalSpeed());
    impedance = maxOf(impedance, material.density * material.dilatationalSpeed());
  }
  for (const PressureConfig& load : config.pressures)
    raisePressure(result, std::fabs(load.peak), "load");
  for (const InitialVelocityConfig& initial : config.initial_velocities)
    raisePressure(result, impedance * norm(toVec3(initial.velocity)), "impact");
  for (const PrescribedVelocityConfig& moving : config.prescribed)
    raisePressure(result, impedance * norm(prescribedVelocity(moving)), "prescribed velocity");
  const double edge = scene.shortest_edge;
  const double softness = jointSoftness(config.mass, result.elements_through);
  result.penetration =
      softness * 2 * dt * dt * result.joint_pressure / (config.contact.penalty * density * edge);
  result.joint_compliance = softness * 2 * std::pow(speed * dt / edge, 2) / config.contact.penalty;
}

} // namespace

Magnitudes magnitudesOf(MPI_Comm comm, const Config& config, const Scene& scene, double dt) {
  Magnitudes result;
  addCrossings(comm, config, scene.part, result);
  if (config.wall)
    addWall(config, result);
  else
    result.mass = ownedMass(comm, scene);
  addJoints(config, scene, dt, result);
  return result;
}

std::string usualValues(const Config& config) {
  std::ostringstream text;
  text
      << "density and wave speed, kg/m3 and m/s: plastic 1000 2300, brick 1900 3000, concrete 2400 "
         "4000, steel 7850 5900";
  if (const Units* units = unitsOf(norm(toVec3(config.gravity))); units && units->speed != 1)
    text << "; 1 m/s is " << units->speed << " in " << units->names;
  return text.str();
}

std::vector<std::string> absurdMagnitudes(const Config& config, const Magnitudes& magnitudes,
                                          std::int64_t steps) {
  std::vector<std::string> warnings;
  const auto warn = [&](const auto&... words) {
    std::ostringstream text;
    (text << ... << words);
    warnings.push_back(text.str() + "; are the units of the deck consistent?");
  };
  const double gravity = norm(toVec3(config.gravity));
  const Units* units = unitsOf(gravity);
  double least_modulus = HUGE_VAL, least_speed = HUGE_VAL;
  for (const MaterialConfig& entry : config.materials) {
    const double speed = entry.material.dilatationalSpeed(), density = entry.material.density;
    const bool is_usual = speed >= slowest && speed <= fastest; // m/s
    least_speed = minOf(least_speed, speed);
    least_modulus = minOf(least_modulus, density * speed * speed);
    if (units && !(speed >= slowest * units->speed && speed <= fastest * units->speed))
      warn("material.", entry.block, " has the wave speed ", speed, ", and gravity ", gravity,
           " suggests ", units->names, ": expected ", slowest * units->speed, " to ",
           fastest * units->speed);
    else if (!units && density >= least_density && density <= greatest_density && !is_usual)
      warn("material.", entry.block, " has the wave speed ", speed, ", and the density ", density,
           " suggests kg/m3: expected ", slowest, " to ", fastest, " m/s");
    else if (density > greatest_density)
      warn("material.", entry.block, " has the density ", density, ": expected at most ",
           greatest_density, ", in kg/m3");
    else if (!units && speed > fastest * 1e3)
      warn("material.", entry.block, " has the wave speed ", speed,
           ": expected at most 20000 m/s, which are 2e7 mm/s");
  }
  for (std::size_t i = 0; i < magnitudes.speeds.size(); ++i)
    if (magnitudes.speeds[i] > absurd_share * least_speed)
      warn("load.pressure[", i, "] gives a brick the speed ", magnitudes.speeds[i],
           ", but waves have ", least_speed);
  if (magnitudes.joint_pressure > absurd_share * least_modulus)
    warn("the pressure ", magnitudes.joint_pressure, " (", magnitudes.pressure_source,
         ") exceeds a tenth of the modulus lambda + 2 mu = ", least_modulus);
  if (steps > 1000000000)
    warn("the run has ", steps, " steps");
  const double end = config.time.end;
  if (end < magnitudes.shortest_crossing)
    warn("the run ends at time ", end, ", and a wave needs ", magnitudes.shortest_crossing,
         " to cross a body");
  if (end > max_crossings * magnitudes.longest_crossing)
    warn("waves cross the largest body ", end / magnitudes.longest_crossing,
         " times before the run ends");
  return warnings;
}

} // namespace brickwall::miniapp
