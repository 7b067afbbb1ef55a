// The slice of an Exodus mesh file that one rank reads: contiguous elements, nodes and set entries,
// as the file has them.
#pragma once

#include "io/exodus/exodus_file.hpp"
#include "io/mesh/mesh_part.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace brickwall::io {

struct SetInfo {
  std::int64_t id = 0;
  std::string name;
  std::int64_t num_entries = 0;
};

// Description of the file, which every rank reads.
struct MeshContents {
  global_id num_nodes = 0; // in the file; elements need not use them all
  global_id num_elems = 0;
  std::vector<Block> blocks; // without empty blocks
  std::vector<std::string> empty_blocks; // their names
  std::vector<SetInfo> side_sets, node_sets;
};

struct ElemCorners {
  global_id elem;
  global_id nodes[8]; // 0-based positions in the file
  global_id number = 0; // in elem_num_map; set with node_numbers, once the maps are checked
};
struct SideEntry {
  std::int64_t set, elem, side; // 0-based
};
struct NodeEntry {
  std::int64_t set, node; // 0-based
};
// This rank's slice of the file.
struct MeshSlice {
  std::vector<ElemCorners> elems;
  std::array<std::vector<double>, 3> coordinates; // of the nodes of the slice
  std::vector<global_id> node_numbers; // in node_num_map
  std::vector<SideEntry> sides;
  std::vector<NodeEntry> nodes;
};

// Throws InputError naming the file: no hex8 block with elements, a block that is not hex8, another
// number of elements than the blocks have, not three dimensions.
MeshContents readContents(const ExodusFile& file);

// Throws InputError naming the file: node, element or side numbers out of range, a node at several
// corners of an element, coordinates that are not finite.
MeshSlice readSlice(const ExodusFile& file, const MeshContents& contents, int rank, int size);

} // namespace brickwall::io
