// What simulations make of meshes with sets and elements that no wall has.
#include "mesh_scene.hpp"

namespace brickwall::miniapp::testing {
namespace {

// Two sides of the inmost element of 3 x 3 x 3: no node of theirs is on the surface.
io::SideSet sidesOfTheInmost() {
  io::SideSet inner;
  inner.id = 77;
  inner.name = "inner";
  inner.elems = {13, 13};
  inner.sides = {0, 1};
  return inner;
}

struct Outcome {
  Checksums checksums;
  double external_work = 0;
};
Outcome outcomeOf(MPI_Comm comm, const Config& config) {
  const Scene scene = makeScene(exec_space(), comm, config);
  Simulation simulation(comm, config, scene);
  simulation.start();
  while (!simulation.done())
    simulation.step();
  return {simulation.checksums(), simulation.balance().external_work};
}

TEST(MeshScene, APressureInsideABodyMovesItTheSameOnAnyRanks) {
  const MeshFile mesh(oneBrick({3, 3, 3}),
                      [](io::MeshPart& part) { part.side_sets.push_back(sidesOfTheInmost()); });
  const std::string load =
      "[[load.pressure]]\nside_set = \"inner\"\npeak = 1e-3\nshape = \"step\"\n";
  const Outcome alone = outcomeOf(MPI_COMM_SELF, mesh.config(load));
  EXPECT_GT(alone.external_work, 0);
  for (const std::string spare : {"", "[spare]\nresting_bodies = false\n"}) {
    const Outcome found = outcomeOf(MPI_COMM_WORLD, mesh.config(load + spare));
    EXPECT_EQ(found.external_work, alone.external_work) << spare;
    EXPECT_EQ(found.checksums.nodes, alone.checksums.nodes) << spare;
  }
}

} // namespace
} // namespace brickwall::miniapp::testing
