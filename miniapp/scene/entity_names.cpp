#include "miniapp/scene/entity_names.hpp"

#include "contact/base/mpi.hpp"
#include "io/exodus/id_maps.hpp"
#include "miniapp/scene/scene.hpp"

#include <algorithm>
#include <climits>
#include <sstream>

namespace brickwall::miniapp {

namespace {

// See io::idInWords(). `ids` ascend. Collective.
std::string idOf(MPI_Comm comm, global_id entity, const std::vector<global_id>& ids,
                 const std::vector<global_id>& numbers, const char* map) {
  const auto at = std::lower_bound(ids.begin(), ids.end(), entity);
  const bool is_here = at != ids.end() && *at == entity && !numbers.empty();
  const global_id number = allReduce(
      comm, is_here ? numbers[static_cast<std::size_t>(at - ids.begin())] : INT64_MIN, MPI_MAX);
  return io::idInWords(entity, number == INT64_MIN ? entity + 1 : number, map);
}

} // namespace

std::string EntityNames::node(global_id node) const {
  return "node " + std::to_string(node) + " (" +
         idOf(_comm, node, _part.node_ids, _part.node_numbers, "node_num_map") + ")";
}

std::string EntityNames::element(global_id element) const {
  return "element " + std::to_string(element) + " (" + elementId(element) + ")";
}

std::string EntityNames::face(global_id face) const {
  return "face " + std::to_string(face) + " (side " + std::to_string(face % 6 + 1) +
         " of the element with " + elementId(face / 6) + ")";
}

std::string EntityNames::edge(global_id edge) const {
  return "an edge of " + face(edge / 4);
}

std::string EntityNames::elementId(global_id element) const {
  return idOf(_comm, element, _part.elem_ids, _part.elem_numbers, "elem_num_map");
}

std::string bodyName(const Config& config, global_id body) {
  std::ostringstream name;
  name << "body " << body;
  if (config.wall) {
    const io::BrickPlace at = io::WallLayout(*config.wall).brickPlace(body);
    name << " (brick [" << at.along << ", " << at.wythe << ", " << at.course << "]: course "
         << at.course << ", wythe " << at.wythe << ", place " << at.along << ")";
  }
  return name.str();
}

std::string bodyName(MPI_Comm comm, const Config& config, const io::MeshPart& part,
                     global_id body) {
  if (config.wall)
    return bodyName(config, body);
  int block = INT_MAX; // all ranks list all blocks in the same order
  for (int elem = part.numElems() - 1; elem >= 0; --elem)
    if (part.elem_body[elem] == body)
      block = part.elem_block[elem];
  block = allReduce(comm, block, MPI_MIN);
  const std::string name = bodyName(config, body);
  return block < static_cast<int>(part.blocks.size())
             ? name + " (element block '" + part.blocks[block].name + "')"
             : name;
}

} // namespace brickwall::miniapp
