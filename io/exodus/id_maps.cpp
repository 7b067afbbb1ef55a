#include "io/exodus/id_maps.hpp"

#include "contact/base/mpi.hpp"
#include "io/mesh/id_slices.hpp"

#include <exodusII.h>

#include <cstdint>

namespace brickwall::io {

namespace {

std::vector<std::int64_t> readMap(const ExodusFile& file, ex_entity_type type, std::int64_t begin,
                                  std::int64_t end) {
  std::vector<std::int64_t> ids(static_cast<std::size_t>(end - begin));
  if (!ids.empty())
    file.check(ex_get_partial_id_map(file.id(), type, begin + 1, end - begin, ids.data()),
               type == EX_NODE_MAP ? "node_num_map" : "elem_num_map");
  return ids;
}

void refuseRepeated(MPI_Comm comm, const std::string& file_name, const IdSlices& slices,
                    const std::vector<std::int64_t>& ids, const char* map, const char* entity) {
  const std::int64_t begin = slices.begin(rankOf(comm)), none = slices.total;
  bool counts_from_one = true;
  for (std::size_t i = 0; i < ids.size(); ++i)
    counts_from_one &= ids[i] == begin + static_cast<std::int64_t>(i) + 1;
  if (allReduce(comm, static_cast<int>(counts_from_one), MPI_MIN) != 0)
    return;
  const auto uses = countOnAllRanks(comm, ids, [](std::int64_t id) { return id & INT64_MAX; });
  const auto firstOf = [&](auto&& isOne) {
    std::int64_t first = none;
    for (std::size_t i = ids.size(); i-- > 0;)
      if (isOne(i, begin + static_cast<std::int64_t>(i)))
        first = begin + static_cast<std::int64_t>(i);
    return allReduce(comm, first, MPI_MIN);
  };
  const std::int64_t first = firstOf([&](std::size_t i, std::int64_t) { return uses[i] > 1; });
  if (first == none)
    return;
  const bool is_here = slices.rankOf(first) == rankOf(comm);
  const std::int64_t id =
      allReduce(comm, is_here ? ids[static_cast<std::size_t>(first - begin)] : INT64_MIN, MPI_MAX);
  const std::int64_t second =
      firstOf([&](std::size_t i, std::int64_t at) { return at > first && ids[i] == id; });
  throw InputError(file_name + ": " + map + ": found the id " + std::to_string(id) + " at " +
                   entity + "s " + std::to_string(first + 1) + " and " +
                   std::to_string(second + 1) + ", expected every id once");
}

} // namespace

IdMaps readIdMaps(const ExodusFile& file, const MeshContents& contents, int rank, int size) {
  const IdSlices nodes{contents.num_nodes, size}, elems{contents.num_elems, size};
  return {readMap(file, EX_NODE_MAP, nodes.begin(rank), nodes.end(rank)),
          readMap(file, EX_ELEM_MAP, elems.begin(rank), elems.end(rank))};
}

void refuseRepeatedIds(MPI_Comm comm, const std::string& file_name, const MeshContents& contents,
                       const IdMaps& maps) {
  const int size = sizeOf(comm);
  refuseRepeated(comm, file_name, {contents.num_nodes, size}, maps.nodes, "node_num_map", "node");
  refuseRepeated(comm, file_name, {contents.num_elems, size}, maps.elems, "elem_num_map",
                 "element");
}

std::string idInWords(global_id position, global_id id, const char* map) {
  return id == position + 1 ? "1-based id " + std::to_string(id)
                            : "id " + std::to_string(id) + " in " + map;
}

std::string nameOfElem(const std::string& file_name, global_id elem) {
  const auto id = readMap(ExodusFile::open(file_name), EX_ELEM_MAP, elem, elem + 1).front();
  return "the element of " + idInWords(elem, id, "elem_num_map");
}

} // namespace brickwall::io
