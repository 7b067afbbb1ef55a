// One rank's part of a hexahedral mesh, on the host. The wall generator and the mesh reader make
// it, and the results writer writes it. Global ids are 0-based (in files, 1-based).
#pragma once

#include "contact/base/backend.hpp"

#include <climits>
#include <cstdint>
#include <string>
#include <vector>

namespace brickwall::io {

// Element block. The list of blocks is the same, in the same order, on every rank.
struct Block {
  std::int64_t id = 1; // Exodus block id
  std::string name; // as in [material.<name>] of the deck
  global_id num_global_elems = 0; // elements of the block on all ranks
};

// Sets are the same, in the same order, on every rank; the lists of a rank may be empty.
struct SideSet {
  std::int64_t id = 1;
  std::string name;
  std::vector<int> elems; // local element of each side; in the order of global id, then side
  std::vector<int> sides; // 0-based Exodus side of that element (hex8: 0..5)
};
struct NodeSet {
  std::int64_t id = 1;
  std::string name;
  // local, in the order of global id; a shared node is in the list of every sharer
  std::vector<int> nodes;
};

// Nodes that this rank shares with one other rank, in the order of global node id: both ranks list
// the same nodes.
struct SharedNodes {
  int rank = 0;
  std::vector<int> nodes; // local nodes
};

// Numbers that count from 0, as files have them.
template <class Integer>
std::vector<Integer> fromOne(std::vector<Integer> numbers) {
  for (Integer& number : numbers)
    ++number;
  return numbers;
}

constexpr global_id most_elems_of_rank = INT_MAX / 8; // corners have 32-bit numbers

struct MeshPart {
  // nodes, in the order of global node id
  std::vector<global_id> node_ids;
  std::vector<double> coordinates; // [node][xyz], length
  std::vector<int> node_owner; // lowest rank that shares the node

  // elements, in the order of global element id; blocks are contiguous in that order
  std::vector<global_id> elem_ids;
  std::vector<int> elem_nodes; // [elem][8] local nodes, Exodus corner order
  std::vector<int> elem_block; // index into blocks
  std::vector<global_id> elem_body; // brick number, or connected component: bodies share no node

  std::vector<Block> blocks;
  std::vector<std::string> empty_blocks; // names of blocks of the file that are not in `blocks`
  std::vector<SideSet> side_sets;
  std::vector<NodeSet> node_sets;
  std::vector<SharedNodes> shared_nodes; // in the order of rank

  // [node], [elem] the ids by which other programs know them: node_num_map and elem_num_map of an
  // Exodus mesh. Empty where they are the global ids + 1.
  std::vector<global_id> node_numbers, elem_numbers;

  global_id num_global_nodes = 0;
  global_id num_global_elems = 0;
  global_id num_global_bodies = 0;

  std::vector<global_id> nodeNumbers() const {
    return node_numbers.empty() ? fromOne(node_ids) : node_numbers;
  }
  std::vector<global_id> elemNumbers() const {
    return elem_numbers.empty() ? fromOne(elem_ids) : elem_numbers;
  }
  // Keeps no numbers that are the global ids + 1.
  void dropPlainNumbers() {
    if (node_numbers == fromOne(node_ids))
      node_numbers.clear();
    if (elem_numbers == fromOne(elem_ids))
      elem_numbers.clear();
  }

  int numNodes() const { return static_cast<int>(node_ids.size()); }
  int numElems() const { return static_cast<int>(elem_ids.size()); }
};

// The exterior surface of a wall alone, for `brickwall search`: with the ids of the full mesh.
struct SurfacePart {
  std::vector<global_id> node_ids;
  std::vector<double> coordinates; // [node][xyz]
  std::vector<int> node_owner; // lowest rank that shares the node
  std::vector<global_id> node_body;
  std::vector<global_id> face_ids; // global element id * 6 + side
  std::vector<int> face_nodes; // [face][4] local nodes, outward normal by the right-hand rule
  std::vector<global_id> face_body;
  global_id num_global_nodes = 0;
  global_id num_global_faces = 0;
};

} // namespace brickwall::io
