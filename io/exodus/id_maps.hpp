// The maps of an Exodus mesh file, node_num_map and elem_num_map: the ids by which other programs
// know its nodes and elements. A file without one numbers them from 1.
#pragma once

#include "io/exodus/exodus_slice.hpp"

#include <mpi.h>

#include <string>
#include <vector>

namespace brickwall::io {

struct IdMaps {
  std::vector<std::int64_t> nodes, elems; // ids of the slice of this rank
};

// The maps of this rank's slice. Throws InputError naming the file: a map that cannot be read.
IdMaps readIdMaps(const ExodusFile& file, const MeshContents& contents, int rank, int size);

// Throws InputError on all ranks, naming file, id and the first two places, if an id is there
// twice. Collective.
void refuseRepeatedIds(MPI_Comm comm, const std::string& file_name, const MeshContents& contents,
                       const IdMaps& maps);

// The id of the entity at `position`, from 0, in words: "id 71 in node_num_map", or "1-based id 6"
// where it is that of the position.
std::string idInWords(global_id position, global_id id, const char* map);

// The element at position `elem`, from 0, as other programs know it: "the element of id 7 in
// elem_num_map". Throws InputError.
std::string nameOfElem(const std::string& file_name, global_id elem);

} // namespace brickwall::io
