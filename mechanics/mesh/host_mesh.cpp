#include "mechanics/mesh/host_mesh.hpp"

#include <map>

namespace brickwall::mechanics {

std::vector<int> firstRows(const HexMesh& mesh) {
  std::map<global_id, int> first;
  std::vector<int> rows;
  for (std::size_t b = 0; b < mesh.bodies.size(); ++b)
    rows.push_back(first.emplace(mesh.bodies[b].body, static_cast<int>(b)).first->second);
  return rows;
}

std::vector<int> bodyOfNodes(const exec_space& space, const HexMesh& mesh,
                             const std::vector<int>& first_rows) {
  const auto elem_to_nodes = copyToHost(space, mesh).elem_to_nodes;
  std::vector<int> body_of(mesh.num_nodes, static_cast<int>(mesh.bodies.size()));
  parallelOnHost("mechanics::bodyOfNodes", mesh.bodies.size(), [&](std::int64_t row) {
    const ElementRange& range = mesh.bodies[row];
    for (int elem = range.first; elem < range.first + range.count; ++elem)
      for (int c = 0; c < 8; ++c)
        storeShared(body_of[elem_to_nodes(elem, c)], first_rows[row]);
  });
  return body_of;
}

} // namespace brickwall::mechanics
