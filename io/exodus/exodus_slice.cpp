// Partial reads of an Exodus mesh file.
#include "io/exodus/exodus_slice.hpp"

#include "contact/base/error.hpp"
#include "io/exodus/id_maps.hpp"
#include "io/mesh/id_slices.hpp"

#include <exodusII.h>

#include <algorithm>
#include <cctype>
#include <cmath>

namespace brickwall::io {

namespace {

std::string nameOrNumber(const ExodusFile& file, ex_entity_type type, std::int64_t id,
                         const char* kind) {
  std::string name(257, '\0');
  file.check(ex_get_name(file.id(), type, id, name.data()), "the name of a block or set");
  name.resize(name.find('\0'));
  return name.empty() ? kind + ("_" + std::to_string(id)) : name;
}

std::vector<std::int64_t> idsOf(const ExodusFile& file, ex_entity_type type, std::int64_t count,
                                const char* what) {
  constexpr std::int64_t most = 1000000; // of a damaged file it may be any number
  if (count < 0 || count > most)
    throw InputError(file.path() + ": found " + std::to_string(count) + " for the number of " +
                     what + ", expected at most " + std::to_string(most));
  std::vector<std::int64_t> ids(static_cast<std::size_t>(count));
  if (count > 0)
    file.check(ex_get_ids(file.id(), type, ids.data()), what);
  std::vector<std::int64_t> sorted = ids;
  std::sort(sorted.begin(), sorted.end());
  const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
  if (twice != sorted.end()) // Exodus would read the first of them again
    throw InputError(file.path() + ": " + what + " contain " + std::to_string(*twice) + " twice");
  return ids;
}

bool isHex8(const ex_block& block) {
  std::string kind = block.topology;
  std::transform(kind.begin(), kind.end(), kind.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return kind.rfind("HEX", 0) == 0 && block.num_nodes_per_entry == 8;
}

void readBlocks(const ExodusFile& file, const ex_init_params& sizes, MeshContents& contents) {
  std::int64_t num_elems = 0; // of all kinds
  std::string others;
  for (const std::int64_t id :
       idsOf(file, EX_ELEM_BLOCK, sizes.num_elem_blk, "the ids of blocks")) {
    ex_block info{};
    info.id = id;
    info.type = EX_ELEM_BLOCK;
    file.check(ex_get_block_param(file.id(), &info), "block " + std::to_string(id));
    const std::string name = nameOrNumber(file, EX_ELEM_BLOCK, id, "block");
    num_elems += info.num_entry;
    if (info.num_entry == 0)
      contents.empty_blocks.push_back(name);
    else if (isHex8(info))
      contents.blocks.push_back({id, name, info.num_entry});
    else
      others += (others.empty() ? "" : ", ") + name + " is of type '" + info.topology + "' with " +
                std::to_string(info.num_nodes_per_entry) + " nodes";
  }
  contents.num_elems = num_elems;
  if (contents.blocks.empty())
    throw InputError(file.path() + ": has no hex8 block with elements" +
                     (others.empty() ? "" : ": block " + others));
  if (!others.empty())
    throw InputError(file.path() + ": every block must be hex8, but block " + others);
  if (sizes.num_elem != num_elems)
    throw InputError(file.path() + ": found " + std::to_string(sizes.num_elem) +
                     " for num_elem, expected the " + std::to_string(num_elems) +
                     " elements of the blocks");
}

std::vector<SetInfo> readSetInfos(const ExodusFile& file, ex_entity_type type, std::int64_t count,
                                  const char* kind) {
  std::vector<SetInfo> sets;
  for (const std::int64_t id : idsOf(file, type, count, "the ids of sets")) {
    SetInfo info{id, nameOrNumber(file, type, id, kind), 0};
    std::int64_t num_factors = 0;
    file.check(ex_get_set_param(file.id(), type, id, &info.num_entries, &num_factors), info.name);
    sets.push_back(info);
  }
  return sets;
}

// The number 1 .. limit of the file as an index from 0.
std::int64_t indexFrom(const ExodusFile& file, std::int64_t number, std::int64_t limit,
                       const std::string& what) {
  if (number < 1 || number > limit)
    throw InputError(file.path() + ": " + what + " is " + std::to_string(number) +
                     ", must be from 1 to " + std::to_string(limit));
  return number - 1;
}

void refuseRepeatedCorner(const ExodusFile& file, const ElemCorners& elem) {
  global_id nodes[8];
  std::copy(elem.nodes, elem.nodes + 8, nodes);
  std::sort(nodes, nodes + 8);
  const global_id* const twice = std::adjacent_find(nodes, nodes + 8);
  if (twice != nodes + 8)
    throw InputError(file.path() + ": " + nameOfElem(file.path(), elem.elem) + " has node " +
                     std::to_string(*twice + 1) +
                     " at several corners, expected hexahedra with eight distinct corners");
}

void readElems(const ExodusFile& file, const MeshContents& contents, global_id begin, global_id end,
               MeshSlice& slice) {
  global_id first = 0; // of the block
  for (const Block& block : contents.blocks) {
    const global_id from = std::max(begin, first);
    const global_id to = std::min(end, first + block.num_global_elems);
    if (from < to) {
      std::vector<std::int64_t> corners(8 * static_cast<std::size_t>(to - from));
      file.check(ex_get_partial_conn(file.id(), EX_ELEM_BLOCK, block.id, from - first + 1,
                                     to - from, corners.data(), nullptr, nullptr),
                 "the elements of block " + block.name);
      for (global_id elem = from; elem < to; ++elem) {
        ElemCorners corner_list{elem, {}};
        for (int c = 0; c < 8; ++c)
          corner_list.nodes[c] =
              indexFrom(file, corners[8 * static_cast<std::size_t>(elem - from) + c],
                        contents.num_nodes, "a node of element " + std::to_string(elem + 1));
        refuseRepeatedCorner(file, corner_list);
        slice.elems.push_back(corner_list);
      }
    }
    first += block.num_global_elems;
  }
}

void readCoordinates(const ExodusFile& file, global_id begin, global_id end, MeshSlice& slice) {
  for (auto& component : slice.coordinates)
    component.resize(static_cast<std::size_t>(end - begin));
  if (begin < end)
    file.check(ex_get_partial_coord(file.id(), begin + 1, end - begin, slice.coordinates[0].data(),
                                    slice.coordinates[1].data(), slice.coordinates[2].data()),
               "the coordinates");
  for (int d = 0; d < 3; ++d)
    for (std::size_t i = 0; i < slice.coordinates[d].size(); ++i)
      if (!std::isfinite(slice.coordinates[d][i]))
        throw InputError(file.path() + ": coordinate " + "xyz"[d] + " of node " +
                         std::to_string(begin + static_cast<global_id>(i) + 1) + " is not finite");
}

// Calls store(set, entry, side) for this rank's slice of each set; `side` is 0 for node sets.
template <class Store>
void readSets(const ExodusFile& file, ex_entity_type type, const std::vector<SetInfo>& sets,
              int rank, int size, const Store& store) {
  for (std::size_t s = 0; s < sets.size(); ++s) {
    const IdSlices slices{sets[s].num_entries, size};
    const std::int64_t begin = slices.begin(rank), count = slices.end(rank) - begin;
    if (count == 0)
      continue;
    std::vector<std::int64_t> entries(static_cast<std::size_t>(count)), sides(entries.size());
    file.check(ex_get_partial_set(file.id(), type, sets[s].id, begin + 1, count, entries.data(),
                                  type == EX_SIDE_SET ? sides.data() : nullptr),
               sets[s].name);
    for (std::size_t i = 0; i < entries.size(); ++i)
      store(static_cast<std::int64_t>(s), entries[i], sides[i]);
  }
}

} // namespace

MeshContents readContents(const ExodusFile& file) {
  ex_init_params sizes{};
  file.check(ex_set_max_name_length(file.id(), 256), "names");
  file.check(ex_get_init_ext(file.id(), &sizes), "the sizes of the mesh");
  MeshContents contents;
  contents.num_nodes = sizes.num_nodes;
  readBlocks(file, sizes, contents);
  if (sizes.num_dim != 3)
    throw InputError(file.path() + ": has " + std::to_string(sizes.num_dim) +
                     " dimensions, must have 3");
  contents.side_sets = readSetInfos(file, EX_SIDE_SET, sizes.num_side_sets, "side_set");
  contents.node_sets = readSetInfos(file, EX_NODE_SET, sizes.num_node_sets, "node_set");
  return contents;
}

MeshSlice readSlice(const ExodusFile& file, const MeshContents& contents, int rank, int size) {
  MeshSlice slice;
  const IdSlices elems{contents.num_elems, size}, nodes{contents.num_nodes, size};
  readElems(file, contents, elems.begin(rank), elems.end(rank), slice);
  readCoordinates(file, nodes.begin(rank), nodes.end(rank), slice);
  readSets(file, EX_SIDE_SET, contents.side_sets, rank, size,
           [&](std::int64_t set, std::int64_t elem, std::int64_t side) {
             const std::string of_set = " of side set " + contents.side_sets[set].name;
             slice.sides.push_back(
                 {set, indexFrom(file, elem, contents.num_elems, "an element" + of_set),
                  indexFrom(file, side, 6, "a side" + of_set)});
           });
  readSets(file, EX_NODE_SET, contents.node_sets, rank, size,
           [&](std::int64_t set, std::int64_t node, std::int64_t) {
             slice.nodes.push_back(
                 {set, indexFrom(file, node, contents.num_nodes,
                                 "a node of node set " + contents.node_sets[set].name)});
           });
  return slice;
}

} // namespace brickwall::io
