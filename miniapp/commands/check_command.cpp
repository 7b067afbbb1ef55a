// `brickwall check`: the contents of a scene and its needs, from the deck alone for walls of any
// size.
#include "contact/base/mpi.hpp"
#include "io/wall/wall_layout.hpp"
#include "miniapp/commands/commands.hpp"
#include "miniapp/deck/words.hpp"
#include "miniapp/output/report.hpp"
#include "miniapp/output/skipped_work.hpp"
#include "miniapp/scene/load_warnings.hpp"
#include "miniapp/scene/loads.hpp"
#include "miniapp/scene/magnitudes.hpp"
#include "miniapp/scene/memory_estimate.hpp"
#include "miniapp/scene/scene.hpp"
#include "miniapp/simulation/diagnostics.hpp"

#include <algorithm>
#include <cstdio>
#include <unistd.h>

namespace brickwall::miniapp {

namespace {

// Whether some bodies of a wall are deformed at the start, and may then overlap others.
bool mayOverlap(const Config& config) {
  const auto& deformations = config.initial_deformations;
  return config.wall && config.contact.enabled &&
         std::any_of(deformations.begin(), deformations.end(),
                     [](const auto& entry) { return !entry.isOfAll(); });
}

// The whole wall is made only to look for such overlaps, and only if that takes no longer than a
// few seconds.
constexpr std::int64_t most_elements_made = 200000;
bool needsWholeWall(const Config& config) {
  return mayOverlap(config) && io::WallLayout(*config.wall).numElems() <= most_elements_made;
}

// A wall with one brick of each kind that the deck's wall has: its time step is the same.
Config smallestLikeScene(const Config& config) {
  Config small = config;
  if (small.wall && !needsWholeWall(config)) {
    auto& bricks = small.wall->bricks;
    bricks = {std::min<std::int64_t>(bricks[0], 2), 1, std::min<std::int64_t>(bricks[2], 2)};
    // Not those of single bricks and bodies of the large wall.
    const auto keepOfAll = [](auto& entries) {
      entries.erase(std::remove_if(entries.begin(), entries.end(),
                                   [](const auto& entry) { return entry.isOfOneBody(); }),
                    entries.end());
    };
    keepOfAll(small.initial_velocities);
    keepOfAll(small.initial_deformations);
  }
  return small;
}

// Whether some bodies of a wall have initial conditions of their own, which the smallest like scene
// omits.
bool startsUnlike(const Config& config) {
  const auto any_of_one = [](const auto& entries) {
    return std::any_of(entries.begin(), entries.end(),
                       [](const auto& entry) { return entry.isOfOneBody(); });
  };
  return config.wall && !needsWholeWall(config) &&
         (any_of_one(config.initial_velocities) || any_of_one(config.initial_deformations));
}

void printMagnitudes(const Config& config, const Magnitudes& found) {
  std::printf("  waves             cross a body in %.3g to %.3g (shortest, longest edge), "
              "%.3g times until the end\n",
              found.shortest_crossing, found.longest_crossing,
              config.time.end / found.longest_crossing);
  std::printf("  mass              %.4g, weight %.4g\n", found.mass,
              found.mass * norm(toVec3(config.gravity)));
  if (found.frequency > 0)
    std::printf("  frequency         %.3g, lowest of the wall in one piece above what is fixed "
                "(bending)\n",
                found.frequency);
  for (std::size_t i = 0; i < found.speeds.size(); ++i)
    std::printf("  pulse             load.pressure[%zu] gives a brick the speed %.3g\n", i,
                found.speeds[i]);
  if (config.contact.enabled && found.joint_pressure > 0)
    std::printf(
        "  joints            as soft as %.2g elements; penetration %.3g at the pressure %.3g "
        "(%s)%s\n",
        found.joint_compliance, found.penetration, found.joint_pressure, found.pressure_source,
        config.wall || config.mass == NodalMass::row_sum
            ? ""
            : "; 1.1 to 1.9 times that with 8 to 2 elements through a body");
  if (found.elements_through == 1)
    std::printf(
        "  error             of the frequencies of a brick, 1 element thick: above 20 %%\n");
  else if (found.elements_through > 1)
    std::printf(
        "  error             of the frequencies of a brick, %d elements thick: about %.2g %%\n",
        found.elements_through, 100 * frequencyError(config.mass, found.elements_through));
}

// Of the deck's scene, over all ranks.
struct SceneCounts {
  std::int64_t bodies, elements, nodes, faces;
};

SceneCounts countsOf(const Config& config, const Scene& scene) {
  if (config.wall) {
    const io::WallLayout layout(*config.wall);
    return {layout.numBricks(), layout.numElems(), layout.numNodes(), layout.numFaces()};
  }
  return {scene.part.num_global_bodies, scene.part.num_global_elems, scene.part.num_global_nodes,
          scene.num_faces};
}

// Over all ranks. The bodies of a wall have as many edges as those of the smallest like scene.
std::int64_t numEdges(MPI_Comm comm, const Simulation& simulation) {
  const bool has_edges =
      simulation.contact() != nullptr && simulation.contact()->edges() != nullptr;
  return allReduce(comm, has_edges ? simulation.contact()->edges()->numEdges() : 0, MPI_SUM);
}

void printCount(const char* name, std::int64_t count) {
  std::printf("  %-18s%lld\n", name, static_cast<long long>(count));
}

void printMesh(const Config& config, const SceneCounts& counts, bool all_congruent) {
  printCount("bodies", counts.bodies);
  std::printf("  elements          %lld (%s; %s)\n", static_cast<long long>(counts.elements),
              config.formulation == Formulation::one_point ? "one-point, physical stabilisation"
                                                           : "full 2x2x2",
              all_congruent ? "congruent bricks: no geometry per element"
                            : "general: geometry stored per element");
  printCount("nodes", counts.nodes);
  printCount("exterior faces", counts.faces);
}

void printMaterials(const Config& config, const io::MeshPart& part) {
  for (const auto& block : part.blocks) {
    const auto& material = *config.materialOf(block.name);
    std::printf("  material          %s: %s, density %g, Young's modulus %g, Poisson's ratio %g, "
                "wave speed %.4g\n",
                block.name.c_str(), nameOf(material.model), material.density, material.youngs,
                material.poisson, material.dilatationalSpeed());
  }
  if (!part.blocks.empty())
    std::printf("  usual values      %s\n", usualValues(config).c_str());
}

void printConditions(const Config& config) {
  std::printf("  loads             %zu pressure, gravity %s\n", config.pressures.size(),
              config.gravity == Triple{0, 0, 0} ? "off" : "on");
  if (config.viscosity.any())
    std::printf("  bulk viscosity    linear %g, quadratic %g\n", config.viscosity.linear,
                config.viscosity.quadratic);
  if (config.mass_damping > 0)
    std::printf("  damping           %g by mass\n", config.mass_damping);
  std::printf("  boundary          %zu fixed, %zu moving node sets\n", config.fixed.size(),
              config.prescribed.size());
}

void printContact(const Config& config, const Scene& scene, const Simulation& simulation,
                  bool drops_same_body) {
  if (!config.contact.enabled) {
    std::printf("  contact           off: no search\n");
    return;
  }
  std::printf("  contact           on, tolerance %g, penalty %g, %s\n",
              boxTolerance(config.contact, scene.shortest_edge, scene.longest_edge),
              config.contact.penalty,
              drops_same_body ? "no contact of a body with itself" : "bodies may touch themselves");
  if (sureSpeed(simulation) < HUGE_VAL)
    std::printf("  guard             a closing speed above %.4g %s\n", sureSpeed(simulation),
                config.contact.guard == GuardAction::cut ? "shortens the step" : "stops the run");
  if (config.search.margin > 0)
    std::printf("  search            %s, lists kept until a node has moved %g along an axis\n",
                nameOf(config.search.method), 0.5 * config.search.margin * scene.shortest_edge);
  else
    std::printf("  search            %s, in every step\n", nameOf(config.search.method));
}

void printTimeStep(const Config& config, const Simulation& simulation) {
  const double dt = simulation.clock().dt;
  if (config.time.bound == StepBound::lanczos)
    std::printf(
        "  time step         %g, %.1f %% longer than by elements (Lanczos, body types: %lld)\n", dt,
        100 * (simulation.steps().gain().step - 1),
        static_cast<long long>(simulation.steps().gain().body_types));
  else
    std::printf("  time step         %g, by elements\n", dt);
}

void printSkipped(const Config& config, const std::vector<SkippedPart>& skipped) {
  for (const SkippedPart& part : skipped)
    if (part.share > 0 && !(part.key == "skip.resting_bodies" && startsUnlike(config)))
      std::printf("  skipped           %s: %.3g %% %s\n", part.what.c_str(), 100 * part.share,
                  part.of.c_str());
}

std::vector<std::string> sizeWarnings(const Config& config, std::int64_t elements, int ranks,
                                      const MemoryEstimate& memory) {
  std::vector<std::string> warnings;
  if (elements / ranks > io::most_elems_of_rank)
    warnings.push_back(format("the elements of a rank are too many for 32-bit numbers; a run needs "
                              "at least %lld ranks",
                              elements / io::most_elems_of_rank + 1));
  if (mayOverlap(config) && !needsWholeWall(config))
    warnings.push_back(format(
        "a wall of more than %lld elements is not made, so overlaps due to initial.deformation are "
        "not looked for; a run refuses those that contact cannot resolve",
        most_elements_made));
  const double of_host = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * sysconf(_SC_PAGESIZE);
  if (memory.of_rank - (host_accessible ? 0 : memory.of_device) > of_host)
    warnings.push_back(format("a rank needs more memory than this machine has, %.0f MB: use more "
                              "ranks on more machines",
                              1e-6 * of_host));
  return warnings;
}

} // namespace

int checkScene(MPI_Comm comm, const Config& config, const Options& options) {
  if (config.wall)
    refuseUnknownBodies(config, io::WallLayout(*config.wall).numBricks());
  const Config small = smallestLikeScene(config);
  Scene scene = makeScene(exec_space(), comm, small);
  const Simulation simulation(comm, small, scene);
  const double dt = simulation.clock().dt;
  const std::int64_t num_steps = simulation.steps().plannedSteps(),
                     num_small_elems = scene.part.num_global_elems;
  Config planned = config; // ends with the last step that time.steps allows
  planned.time.end = std::min(config.time.end, static_cast<double>(num_steps) * dt);
  const bool all_congruent = specialElements(simulation).congruent == num_small_elems;
  const auto skipped = skippedWork(small, simulation, contactCounts(simulation), num_small_elems);
  const Magnitudes magnitudes = magnitudesOf(comm, config, scene, dt);
  const int ranks = sizeOf(comm);
  const SceneCounts counts = countsOf(config, scene);
  const SceneSize size{
      counts.elements, counts.nodes,
      counts.faces,    numEdges(comm, simulation) * counts.bodies / scene.part.num_global_bodies,
      !all_congruent,  config.contact.enabled};
  const MemoryEstimate memory = estimateMemory(size, ranks, !host_accessible);
  for (const auto& warnings : {loadWarnings(comm, config, scene.part, dt),
                               absurdMagnitudes(planned, magnitudes, num_steps),
                               sizeWarnings(config, counts.elements, ranks, memory)})
    scene.warnings.insert(scene.warnings.end(), warnings.begin(), warnings.end());
  if (rankOf(comm) != 0)
    return 0;

  std::printf("%s\n", config.title.empty() ? options.caseName().c_str() : config.title.c_str());
  std::printf("  deck              %s\n", config.deck_path.c_str());
  printMesh(config, counts, all_congruent);
  printMaterials(config, scene.part);
  printConditions(config);
  printContact(config, scene, simulation, dropsSameBody(small));
  printTimeStep(config, simulation);
  printSkipped(config, skipped);
  std::printf("  steps             %lld to time %g\n", static_cast<long long>(num_steps),
              planned.time.end);
  printMagnitudes(planned, magnitudes);
  // brickwall_study/problem_size.py reads this line.
  std::printf("  memory            %.0f MB per rank on %s, of which %.0f MB %s\n",
              1e-6 * memory.of_rank, counted(ranks, "rank").c_str(), 1e-6 * memory.of_device,
              host_accessible ? "in arrays of the time loop" : "on the device");
  for (const std::string& warning : scene.warnings)
    std::printf("warning: %s\n", warning.c_str());
  return 0;
}

} // namespace brickwall::miniapp
