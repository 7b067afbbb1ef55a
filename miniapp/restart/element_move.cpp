#include "miniapp/restart/element_move.hpp"

#include "io/mesh/redistribute.hpp"
#include "miniapp/restart/entity_tables.hpp"

#include <utility>

namespace brickwall::miniapp {

std::unique_ptr<Simulation> moveElements(std::unique_ptr<Simulation> simulation, Scene& scene,
                                         const std::vector<int>& rank_of_elem) {
  const MPI_Comm comm = simulation->comm();
  const Config& config = simulation->config();
  SimulationRestart data = simulation->restartData();
  const TableFiles tables = {entityTables(data, *simulation)};
  simulation.reset(); // never both in memory
  io::MeshPart part = io::redistribute(comm, scene.part, rank_of_elem);
  std::vector<std::string> warnings = std::move(scene.warnings);
  scene = Scene();
  scene = makeScene(exec_space(), comm, config, std::move(part));
  scene.warnings = std::move(warnings);
  simulation = std::make_unique<Simulation>(comm, config, scene);
  takeEntities(tables, *simulation, data);
  simulation->restore(data);
  return simulation;
}

} // namespace brickwall::miniapp
