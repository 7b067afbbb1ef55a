// Scenes from mesh files: a generated wall whose sets, corners and blocks a test changes.
#pragma once

#include "contact/base/mpi.hpp"
#include "io/exodus/mesh_writer.hpp"
#include "io/wall/wall_generator.hpp"
#include "miniapp/simulation/diagnostics.hpp"
#include "tests/support/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <string>

namespace brickwall::miniapp::testing {

// A mesh file in a temporary folder, written by rank 0 and removed at the end. Collective.
class MeshFile {
public:
  template <class Change>
  MeshFile(const io::WallConfig& wall, const Change& change) {
    if (rankOf(MPI_COMM_WORLD) == 0) {
      io::MeshPart part = io::generateWall(MPI_COMM_SELF, wall);
      change(part);
      io::writeMesh(MPI_COMM_SELF, path(), part, {});
    }
    MPI_Barrier(MPI_COMM_WORLD);
  }
  std::string path() const { return _folder / "mesh.exo"; }
  // A deck with this mesh, one material and the text `blocks`.
  Config config(const std::string& blocks) const {
    return parseConfig("[mesh]\nfile = \"" + path() +
                           "\"\n[material.brick]\ndensity = 1.0\nyoungs_modulus = 1.0\n"
                           "poissons_ratio = 0.3\n[time]\nend = 8.0\n" +
                           blocks,
                       "deck.toml");
  }

private:
  brickwall::testing::TemporaryFolder _folder{MPI_COMM_WORLD};
};

// The error message of a scene and simulation with this deck; "" without an error.
inline std::string faultOf(const Config& config) {
  try {
    const Scene scene = makeScene(exec_space(), MPI_COMM_WORLD, config);
    const Simulation simulation(MPI_COMM_WORLD, config, scene);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

inline io::WallConfig oneBrick(std::array<std::int64_t, 3> elements) {
  io::WallConfig wall;
  wall.bricks = {1, 1, 1};
  wall.brick = {static_cast<double>(elements[0]), static_cast<double>(elements[1]),
                static_cast<double>(elements[2])};
  wall.elements = elements;
  return wall;
}

} // namespace brickwall::miniapp::testing
