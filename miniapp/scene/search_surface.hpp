// The moving wall surface of `brickwall search`: in each step every brick is displaced rigidly.
#pragma once

#include "contact/surface/surface.hpp"
#include "io/mesh/mesh_part.hpp"

#include <cstdint>
#include <vector>

namespace brickwall::miniapp {

class SearchSurface {
public:
  // `drift` is the largest motion of a brick per axis and step, length. Copies the part to the
  // device.
  SearchSurface(const exec_space& space, const io::SurfacePart& part, int rank, double drift,
                std::uint64_t seed);

  // x^n := x^{n+1}; every brick then moves by a vector hashed from (seed, brick, step), independent
  // of the number of ranks.
  void move(const exec_space& space, std::int64_t step);

  // Only its coordinates change, with move().
  contact::Surface surface() const;

private:
  contact::Surface _surface; // all but the coordinates
  double _drift = 0;
  std::uint64_t _seed = 1;
  std::vector<global_id> _bricks; // bricks of this rank's nodes, ascending
  View<int*> _node_brick; // [node] index into _bricks
  View<double* [3]> _motion; // [brick of this rank][xyz], length
  View<double* [3]>::HostMirror _motion_host;
  View<double*[3]> _old, _new; // coordinates [node][xyz]
};

} // namespace brickwall::miniapp
