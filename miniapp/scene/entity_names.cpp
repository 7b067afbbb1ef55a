#include "miniapp/scene/entity_names.hpp"

#include "contact/base/mpi.hpp"
#include "miniapp/scene/scene.hpp"

#include <climits>
#include <sstream>

namespace brickwall::miniapp {

std::string nodeName(global_id node) {
  return "node " + std::to_string(node) + " (1-based id " + std::to_string(node + 1) + ")";
}

std::string elementName(global_id element) {
  return "element " + std::to_string(element) + " (1-based id " + std::to_string(element + 1) + ")";
}

std::string faceName(global_id face) {
  return "face " + std::to_string(face) + " (side " + std::to_string(face % 6 + 1) +
         " of the element with 1-based id " + std::to_string(face / 6 + 1) + ")";
}

std::string edgeName(global_id edge) {
  return "an edge of " + faceName(edge / 4);
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
