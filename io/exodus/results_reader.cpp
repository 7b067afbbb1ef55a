#include "io/exodus/results_reader.hpp"

#include <exodusII.h>

namespace brickwall::io {
namespace {

std::vector<global_id> idsOf(const ExodusFile& file, ex_entity_type type, std::int64_t count) {
  std::vector<global_id> ids(static_cast<std::size_t>(count));
  if (!ids.empty())
    file.check(ex_get_id_map(file.id(), type, ids.data()), "the ids");
  return ids;
}

std::vector<std::string> variableNames(const ExodusFile& file, ex_entity_type type) {
  int count = 0;
  file.check(ex_get_variable_param(file.id(), type, &count), "the number of variables");
  const auto length = static_cast<std::size_t>(
      file.check(static_cast<int>(ex_inquire_int(file.id(), EX_INQ_DB_MAX_USED_NAME_LENGTH)),
                 "the length of names"));
  file.check(ex_set_max_name_length(file.id(), static_cast<int>(length)), "the length of names");
  std::vector<std::string> names;
  for (int i = 1; i <= count; ++i) {
    std::string name(length + 1, '\0');
    file.check(ex_get_variable_name(file.id(), type, i, name.data()), "the names of variables");
    names.emplace_back(name.c_str());
  }
  return names;
}

} // namespace

ResultsReader::ResultsReader(const std::string& path) : _file(ExodusFile::open(path)) {
  ex_init_params sizes{};
  _file.check(ex_get_init_ext(_file.id(), &sizes), "the sizes of the mesh");
  _num_steps = static_cast<int>(ex_inquire_int(_file.id(), EX_INQ_TIME));
  _node_numbers = idsOf(_file, EX_NODE_MAP, sizes.num_nodes);
  _elem_numbers = idsOf(_file, EX_ELEM_MAP, sizes.num_elem);
  _block_ids.resize(static_cast<std::size_t>(sizes.num_elem_blk));
  if (!_block_ids.empty())
    _file.check(ex_get_ids(_file.id(), EX_ELEM_BLOCK, _block_ids.data()), "the blocks");
  for (const std::int64_t id : _block_ids) {
    ex_block block{};
    block.id = id;
    block.type = EX_ELEM_BLOCK;
    _file.check(ex_get_block_param(_file.id(), &block), "a block");
    _block_sizes.push_back(block.num_entry);
  }
  _nodal_names = variableNames(_file, EX_NODAL);
  _element_names = variableNames(_file, EX_ELEM_BLOCK);
  _global_names = variableNames(_file, EX_GLOBAL);
}

double ResultsReader::time(int step) const {
  double time = 0;
  _file.check(ex_get_time(_file.id(), step, &time), "the time of step " + std::to_string(step));
  return time;
}

std::vector<double> ResultsReader::nodal(int step, int variable) const {
  std::vector<double> values(_node_numbers.size());
  if (!values.empty())
    _file.check(ex_get_var(_file.id(), step, EX_NODAL, variable + 1, 1,
                           static_cast<std::int64_t>(values.size()), values.data()),
                "nodal variables of step " + std::to_string(step));
  return values;
}

std::vector<double> ResultsReader::element(int step, int variable) const {
  std::vector<double> values(_elem_numbers.size());
  std::int64_t begin = 0;
  for (std::size_t b = 0; b < _block_ids.size(); ++b) {
    if (_block_sizes[b] > 0)
      _file.check(ex_get_var(_file.id(), step, EX_ELEM_BLOCK, variable + 1, _block_ids[b],
                             _block_sizes[b], values.data() + begin),
                  "element variables of step " + std::to_string(step));
    begin += _block_sizes[b];
  }
  return values;
}

std::vector<double> ResultsReader::global(int step) const {
  std::vector<double> values(_global_names.size());
  if (!values.empty())
    _file.check(ex_get_var(_file.id(), step, EX_GLOBAL, 1, 1,
                           static_cast<std::int64_t>(values.size()), values.data()),
                "global variables of step " + std::to_string(step));
  return values;
}

} // namespace brickwall::io
