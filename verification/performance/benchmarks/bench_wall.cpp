#include "verification/performance/benchmarks/bench_wall.hpp"

#include "contact/base/mpi.hpp"
#include "contact/base/to_device.hpp"
#include "contact/surface/construct_boxes.hpp"
#include "io/wall/wall_generator.hpp"

namespace brickwall::peers {
namespace {

constexpr double jitter = 0.01, drift = 0.01, tolerance = 0.05; // of an element's edge
constexpr std::uint64_t seed = 1;

} // namespace

io::SurfacePart wallSurface(MPI_Comm comm, int n) {
  io::WallConfig wall;
  wall.bricks = {15, 1, 29};
  wall.brick = {2.0, 1.0, 1.0};
  wall.elements = {2 * n, n, n};
  wall.ends = io::WallEnds::ragged;
  return io::generateWallSurface(comm, wall, io::WallJitter{jitter, seed});
}

miniapp::SearchSurface movingWall(const exec_space& space, MPI_Comm comm, int n,
                                  const io::SurfacePart& part) {
  return miniapp::SearchSurface(space, part, rankOf(comm), drift / n, seed);
}

const std::map<std::string, contact::SearchMethod>& searchMethods() {
  static const std::map<std::string, contact::SearchMethod> methods = {
      {"cluster", contact::SearchMethod::cluster},
      {"paper", contact::SearchMethod::paper},
      {"reference", contact::SearchMethod::reference}};
  return methods;
}

contact::SearchConfig wallSearch(int n, contact::SearchMethod method) {
  contact::SearchConfig config;
  config.method = method;
  config.node_tolerance = config.face_tolerance = tolerance / n;
  return config;
}

SearchBoxes searchBoxes(const exec_space& space, const contact::Surface& surface,
                        const contact::SearchConfig& config) {
  contact::SurfaceBoxes device;
  contact::constructBoxes(space, surface, config, device);
  space.fence();
  const auto node_boxes = toHost(device.node_boxes), face_boxes = toHost(device.face_boxes);
  const auto node_ids = toHost(surface.node_ids), face_ids = toHost(surface.face_ids);
  const auto owned = toHost(surface.node_is_owned);
  SearchBoxes boxes;
  for (int node = 0; node < surface.num_nodes; ++node)
    if (owned(node)) {
      boxes.node_boxes.push_back(node_boxes(node));
      boxes.node_ids.push_back(node_ids(node));
    }
  for (int face = 0; face < surface.num_faces; ++face) {
    boxes.face_boxes.push_back(face_boxes(face));
    boxes.face_ids.push_back(face_ids(face));
  }
  return boxes;
}

} // namespace brickwall::peers
