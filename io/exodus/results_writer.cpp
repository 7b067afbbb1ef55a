// Exodus results, one file per rank. All variables are defined before any data are written. The
// header gets room to grow meanwhile, as netCDF would move the space of all data behind it each time.
#include "io/exodus/results_writer.hpp"

#include "contact/base/mpi.hpp"
#include "contact/base/to_device.hpp"
#include "io/exodus/exodus_file.hpp"

#include <exodusII.h>
#include <netcdf.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <limits>

namespace brickwall::io {

namespace {

constexpr const char* last_time_attribute = "last_written_time";

// Exodus takes arrays of writable C strings.
std::vector<char*> pointersTo(std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  for (std::string& text : texts)
    pointers.push_back(text.data());
  return pointers;
}

template <class Lists>
std::vector<std::string> namesOf(const Lists& lists) {
  std::vector<std::string> names;
  for (const auto& list : lists)
    names.push_back(list.name);
  return names;
}

std::vector<std::string> cutIntoRecords(const std::string& text) {
  std::vector<std::string> records;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    std::string line = text.substr(begin, end - begin);
    do {
      records.push_back(line.substr(0, MAX_LINE_LENGTH));
      line.erase(0, MAX_LINE_LENGTH);
    } while (!line.empty());
    begin = end + 1;
  }
  return records;
}

std::string now(const char* format) {
  const std::time_t time = std::time(nullptr);
  std::tm broken_down{};
  localtime_r(&time, &broken_down);
  char text[32];
  return std::string(text, std::strftime(text, sizeof text, format, &broken_down));
}

// The largest number of a node, element, block or set of this rank's part.
std::int64_t largestId(const MeshPart& part) {
  std::int64_t largest = std::max(part.num_global_nodes, part.num_global_elems);
  for (const auto* numbers : {&part.node_numbers, &part.elem_numbers})
    for (const global_id number : *numbers)
      largest = std::max(largest, number);
  const auto take = [&](const auto& blocks_or_sets) {
    for (const auto& entry : blocks_or_sets)
      largest = std::max(largest, entry.id);
  };
  take(part.blocks);
  take(part.side_sets);
  take(part.node_sets);
  return largest;
}

// Bound of the bytes of a variable in the file of this rank's part: a field of the nodes, or the
// eight nodes of each element.
std::int64_t largestVariable(const MeshPart& part) {
  return std::max(8 * std::int64_t(part.numNodes()), 32 * std::int64_t(part.numElems()));
}

int createFlags(std::int64_t largest_id, std::int64_t largest_variable, FileFormat format) {
  constexpr std::int64_t classic_limit = (std::int64_t(1) << 32) - 4; // bytes of a variable
  const int flags = EX_CLOBBER | EX_MAPS_INT64_API | EX_IDS_INT64_API; // local numbers are ints
  if (largest_id > std::numeric_limits<int>::max())
    return flags | EX_NETCDF4 | EX_ALL_INT64_DB;
  const bool is_classic = format != FileFormat::netcdf4 && largest_variable <= classic_limit;
  return flags | (is_classic ? EX_64BIT_OFFSET : EX_NETCDF4);
}

} // namespace

std::string rankFileName(const std::string& base, int num_ranks, int rank) {
  if (num_ranks == 1)
    return base;
  const std::string total = std::to_string(num_ranks), number = std::to_string(rank);
  return base + "." + total + "." + std::string(total.size() - number.size(), '0') + number;
}

struct ResultsWriter::State {
  MPI_Comm comm = MPI_COMM_NULL;
  std::string path; // without a temporary suffix
  ExodusFile file;
  std::vector<std::int64_t> block_ids;
  std::vector<int> block_begin; // [block + 1] first local element of each block
  int num_nodes = 0;
  std::size_t num_nodal = 0, num_element = 0, num_global = 0;
  std::vector<std::vector<double>> fixed_element; // brick_id, processor_id: written with each step
  int num_steps = 0;

  void reserveHeader(std::size_t num_variables);
  void describeMesh(const MeshPart& part, const ResultsConfig& config);
  void declareBlocks(const MeshPart& part);
  void declareSets(const MeshPart& part);
  void describeRun(const ResultsConfig& config);
  void declareVariables(const ResultsConfig& config);
  void putNames(ex_entity_type type, std::vector<std::string> names, const std::string& what);
  void writeCoordinates(const MeshPart& part);
  void writeConnectivity(const MeshPart& part);
  void writeIdMaps(const MeshPart& part);
  void writeSets(const MeshPart& part);
  void writeElementVariable(std::size_t variable, const std::vector<double>& values);
  void flush();
};

void ResultsWriter::State::describeMesh(const MeshPart& part, const ResultsConfig& config) {
  std::size_t longest = 32;
  for (const auto* names : {&config.nodal_names, &config.element_names, &config.global_names})
    for (const std::string& name : *names)
      longest = std::max(longest, name.size());
  for (const auto& names : {namesOf(part.blocks), namesOf(part.side_sets), namesOf(part.node_sets)})
    for (const std::string& name : names)
      longest = std::max(longest, name.size());
  file.check(ex_set_max_name_length(file.id(), static_cast<int>(longest)), "the length of names");

  ex_init_params sizes{};
  const std::string title = config.title.substr(0, MAX_LINE_LENGTH);
  std::copy(title.begin(), title.end(), sizes.title);
  sizes.num_dim = 3;
  sizes.num_nodes = part.numNodes();
  sizes.num_elem = part.numElems();
  sizes.num_elem_blk = static_cast<std::int64_t>(part.blocks.size());
  sizes.num_node_sets = static_cast<std::int64_t>(part.node_sets.size());
  sizes.num_side_sets = static_cast<std::int64_t>(part.side_sets.size());
  file.check(ex_put_init_ext(file.id(), &sizes), "the sizes of the mesh");
}

// Room for `num_variables` more, and for what each file has.
void ResultsWriter::State::reserveHeader(std::size_t num_variables) {
  const std::size_t room = (1 << 16) + 256 * num_variables;
  file.check(-std::abs(nc_redef(file.id())), "the header");
  file.check(-std::abs(nc__enddef(file.id(), room, 4, 0, 4)), "the header");
}

void ResultsWriter::State::putNames(ex_entity_type type, std::vector<std::string> names,
                                    const std::string& what) {
  if (!names.empty())
    file.check(ex_put_names(file.id(), type, pointersTo(names).data()), what);
}

// Blocks and sets without entries here are declared as well: epu requires the same list in every
// file.
void ResultsWriter::State::declareBlocks(const MeshPart& part) {
  block_begin.assign(part.blocks.size() + 1, 0);
  for (const int block : part.elem_block)
    ++block_begin[block + 1];
  for (std::size_t b = 0; b < part.blocks.size(); ++b) {
    block_ids.push_back(part.blocks[b].id);
    file.check(ex_put_block(file.id(), EX_ELEM_BLOCK, part.blocks[b].id, "HEX8", block_begin[b + 1],
                            8, 0, 0, 0),
               "block " + part.blocks[b].name);
    block_begin[b + 1] += block_begin[b];
  }
  putNames(EX_ELEM_BLOCK, namesOf(part.blocks), "the names of blocks");
}

void ResultsWriter::State::declareSets(const MeshPart& part) {
  for (const SideSet& set : part.side_sets)
    file.check(ex_put_set_param(file.id(), EX_SIDE_SET, set.id,
                                static_cast<std::int64_t>(set.elems.size()), 0),
               "side set " + set.name);
  for (const NodeSet& set : part.node_sets)
    file.check(ex_put_set_param(file.id(), EX_NODE_SET, set.id,
                                static_cast<std::int64_t>(set.nodes.size()), 0),
               "node set " + set.name);
  putNames(EX_SIDE_SET, namesOf(part.side_sets), "the names of side sets");
  putNames(EX_NODE_SET, namesOf(part.node_sets), "the names of node sets");
}

void ResultsWriter::State::describeRun(const ResultsConfig& config) {
  std::vector<std::string> qa = {config.program.substr(0, MAX_STR_LENGTH),
                                 config.version.substr(0, MAX_STR_LENGTH), now("%Y/%m/%d"),
                                 now("%H:%M:%S")};
  char* record[1][4] = {{qa[0].data(), qa[1].data(), qa[2].data(), qa[3].data()}};
  file.check(ex_put_qa(file.id(), 1, record), "the QA record");
  std::vector<std::string> lines = cutIntoRecords(config.information);
  if (!lines.empty())
    file.check(ex_put_info(file.id(), static_cast<int>(lines.size()), pointersTo(lines).data()),
               "the information records");
}

void ResultsWriter::State::declareVariables(const ResultsConfig& config) {
  std::vector<std::string> element_names = config.element_names;
  if (config.write_brick_id)
    element_names.push_back("brick_id");
  if (config.write_processor_id)
    element_names.push_back("processor_id");
  num_nodal = config.nodal_names.size();
  num_element = config.element_names.size();
  num_global = config.global_names.size();
  std::vector<int> everywhere(block_ids.size() * element_names.size(), 1);
  file.check(ex_put_all_var_param(
                 file.id(), static_cast<int>(num_global), static_cast<int>(num_nodal),
                 static_cast<int>(element_names.size()), everywhere.data(), 0, nullptr, 0, nullptr),
             "the list of variables");
  const auto putVariableNames = [&](ex_entity_type type, std::vector<std::string> names) {
    if (!names.empty())
      file.check(ex_put_variable_names(file.id(), type, static_cast<int>(names.size()),
                                       pointersTo(names).data()),
                 "the names of variables");
  };
  putVariableNames(EX_GLOBAL, config.global_names);
  putVariableNames(EX_NODAL, config.nodal_names);
  putVariableNames(EX_ELEM_BLOCK, element_names);
  // Readers that know this attribute (IOSS, ParaView) ignore an incomplete last step.
  if (num_nodal + element_names.size() + num_global > 0) {
    double none_yet = -1;
    file.check(ex_put_double_attribute(file.id(), EX_GLOBAL, 0, last_time_attribute, 1, &none_yet),
               "the time of the last step");
  }
}

void ResultsWriter::State::writeCoordinates(const MeshPart& part) {
  std::vector<std::string> axes = {"x", "y", "z"};
  file.check(ex_put_coord_names(file.id(), pointersTo(axes).data()), "the names of coordinates");
  if (num_nodes == 0)
    return;
  std::vector<double> xyz[3];
  for (int d = 0; d < 3; ++d) {
    xyz[d] = hostArray<double>(num_nodes);
    parallelOnHost("io::writeCoordinates", num_nodes,
                   [&](std::int64_t node) { xyz[d][node] = part.coordinates[3 * node + d]; });
  }
  file.check(ex_put_coord(file.id(), xyz[0].data(), xyz[1].data(), xyz[2].data()),
             "the coordinates");
}

void ResultsWriter::State::writeConnectivity(const MeshPart& part) {
  const auto num_corners = static_cast<std::int64_t>(part.elem_nodes.size());
  std::vector<int> corners = hostArray<int>(num_corners);
  parallelOnHost("io::writeConnectivity", num_corners,
                 [&](std::int64_t i) { corners[i] = part.elem_nodes[i] + 1; });
  for (std::size_t b = 0; b < block_ids.size(); ++b)
    if (block_begin[b + 1] > block_begin[b])
      file.check(ex_put_conn(file.id(), EX_ELEM_BLOCK, block_ids[b],
                             corners.data() + 8 * static_cast<std::size_t>(block_begin[b]), nullptr,
                             nullptr),
                 "the elements of block " + part.blocks[b].name);
}

// epu numbers nodes and elements of the joined file by these.
void ResultsWriter::State::writeIdMaps(const MeshPart& part) {
  const auto write = [&](ex_entity_type type, const std::vector<global_id>& ids, const char* what) {
    if (!ids.empty())
      file.check(ex_put_id_map(file.id(), type, ids.data()), what);
  };
  write(EX_NODE_MAP, part.nodeNumbers(), "the node ids");
  write(EX_ELEM_MAP, part.elemNumbers(), "the element ids");
}

void ResultsWriter::State::writeSets(const MeshPart& part) {
  for (const SideSet& set : part.side_sets)
    if (!set.elems.empty())
      file.check(ex_put_set(file.id(), EX_SIDE_SET, set.id, fromOne(set.elems).data(),
                            fromOne(set.sides).data()),
                 "side set " + set.name);
  for (const NodeSet& set : part.node_sets)
    if (!set.nodes.empty())
      file.check(ex_put_set(file.id(), EX_NODE_SET, set.id, fromOne(set.nodes).data(), nullptr),
                 "node set " + set.name);
}

void ResultsWriter::State::writeElementVariable(std::size_t variable,
                                                const std::vector<double>& values) {
  for (std::size_t b = 0; b < block_ids.size(); ++b)
    if (block_begin[b + 1] > block_begin[b])
      file.check(ex_put_var(file.id(), num_steps + 1, EX_ELEM_BLOCK, static_cast<int>(variable) + 1,
                            block_ids[b], block_begin[b + 1] - block_begin[b],
                            values.data() + block_begin[b]),
                 "element variable " + std::to_string(variable + 1) + " of step " +
                     std::to_string(num_steps + 1));
}

// A full disk shows here and in close(), not where the values are put.
void ResultsWriter::State::flush() {
  file.check(ex_update(file.id()),
             num_steps == 0 ? std::string("the mesh") : "step " + std::to_string(num_steps));
}

ResultsWriter::ResultsWriter(MPI_Comm comm, const std::string& base, const MeshPart& part,
                             const ResultsConfig& config)
    : _state(std::make_unique<State>()) {
  State& s = *_state;
  s.comm = comm;
  s.num_nodes = part.numNodes();
  const int rank = rankOf(comm);
  s.path = rankFileName(base, sizeOf(comm), rank);
  const int flags = createFlags(allReduce(comm, largestId(part), MPI_MAX),
                                allReduce(comm, largestVariable(part), MPI_MAX), config.format);
  rethrowOnAllRanks(comm, [&] {
    s.file = ExodusFile::create(s.path + config.temporary_suffix, flags,
                                config.single_precision ? 4 : 8);
    if (flags & EX_NETCDF4) {
      s.file.check(ex_set_option(s.file.id(), EX_OPT_COMPRESSION_LEVEL, 1), "the compression");
      s.file.check(ex_set_option(s.file.id(), EX_OPT_COMPRESSION_SHUFFLE, 1), "the compression");
    }
    s.describeMesh(part, config);
    s.reserveHeader(part.blocks.size() * (3 + config.element_names.size()));
    s.describeRun(config);
    s.declareBlocks(part);
    s.declareSets(part);
    s.declareVariables(config);
    s.writeCoordinates(part);
    s.writeConnectivity(part);
    s.writeIdMaps(part);
    s.writeSets(part);
    s.flush();
  });
  if (config.write_brick_id) {
    s.fixed_element.emplace_back();
    for (const global_id body : part.elem_body)
      s.fixed_element.back().push_back(static_cast<double>(body + 1));
  }
  if (config.write_processor_id)
    s.fixed_element.emplace_back(part.elem_ids.size(), static_cast<double>(rank));
}

ResultsWriter::~ResultsWriter() = default;
ResultsWriter::ResultsWriter(ResultsWriter&&) noexcept = default;
ResultsWriter& ResultsWriter::operator=(ResultsWriter&&) noexcept = default;

void ResultsWriter::writeStep(double time, const std::vector<std::vector<double>>& nodal,
                              const std::vector<std::vector<double>>& element,
                              const std::vector<double>& global) {
  State& s = *_state;
  rethrowOnAllRanks(s.comm, [&] {
    const auto demand = [](std::size_t found, std::size_t needed, const char* what) {
      if (found != needed)
        throw Error(ExitCode::internal, "ResultsWriter::writeStep: found " + std::to_string(found) +
                                            " " + what + ", expected " + std::to_string(needed));
    };
    demand(nodal.size(), s.num_nodal, "nodal variables");
    demand(element.size(), s.num_element, "element variables");
    demand(global.size(), s.num_global, "global variables");
    for (const auto& values : nodal)
      demand(values.size(), static_cast<std::size_t>(s.num_nodes), "nodal values");
    for (const auto& values : element)
      demand(values.size(), static_cast<std::size_t>(s.block_begin.back()), "element values");

    const int step = s.num_steps + 1, id = s.file.id();
    const std::string of_step = " of step " + std::to_string(step);
    s.file.check(ex_put_time(id, step, &time), "the time" + of_step);
    if (s.num_global > 0)
      s.file.check(ex_put_var(id, step, EX_GLOBAL, 1, 1, static_cast<std::int64_t>(s.num_global),
                              global.data()),
                   "the global variables" + of_step);
    for (std::size_t v = 0; v < nodal.size() && s.num_nodes > 0; ++v)
      s.file.check(
          ex_put_var(id, step, EX_NODAL, static_cast<int>(v) + 1, 1, s.num_nodes, nodal[v].data()),
          "nodal variable " + std::to_string(v + 1) + of_step);
    for (std::size_t v = 0; v < element.size(); ++v)
      s.writeElementVariable(v, element[v]);
    for (std::size_t v = 0; v < s.fixed_element.size(); ++v)
      s.writeElementVariable(s.num_element + v, s.fixed_element[v]);
    s.num_steps = step;
    s.flush();
    // After the data of the step are flushed, so that it never names an incomplete step.
    s.file.check(
        -std::abs(nc_put_att_double(id, NC_GLOBAL, last_time_attribute, NC_DOUBLE, 1, &time)),
        "the time of the last step");
    s.flush();
  });
}

int ResultsWriter::numSteps() const {
  return _state->num_steps;
}
const std::string& ResultsWriter::fileName() const {
  return _state->path;
}

void ResultsWriter::close() {
  rethrowOnAllRanks(_state->comm, [&] { _state->file.close(); });
}

} // namespace brickwall::io
