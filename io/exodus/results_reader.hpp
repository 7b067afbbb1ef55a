// Reads the results that ResultsWriter wrote, for a restart that continues them.
#pragma once

#include "contact/base/backend.hpp"
#include "io/exodus/exodus_file.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace brickwall::io {

// One file: that of one rank, or of all ranks, as epu joins them.
class ResultsReader {
public:
  // Throws InputError naming the file: missing, truncated or not Exodus.
  explicit ResultsReader(const std::string& path);

  int numSteps() const { return _num_steps; }
  double time(int step) const; // `step` from 1
  // As MeshPart::nodeNumbers() and elemNumbers(), in the order of the file.
  const std::vector<global_id>& nodeNumbers() const { return _node_numbers; }
  const std::vector<global_id>& elemNumbers() const { return _elem_numbers; }
  // The names of variables; those of elements include the fixed ones that the writer adds.
  std::vector<std::string> nodalNames() const { return _nodal_names; }
  std::vector<std::string> elementNames() const { return _element_names; }
  std::vector<std::string> globalNames() const { return _global_names; }
  // Values of a step; `variable` is a place in the list of names.
  std::vector<double> nodal(int step, int variable) const; // [node]
  std::vector<double> element(int step, int variable) const; // [element]
  std::vector<double> global(int step) const; // [variable]

private:
  ExodusFile _file;
  int _num_steps = 0;
  std::vector<std::int64_t> _block_ids, _block_sizes;
  std::vector<global_id> _node_numbers, _elem_numbers;
  std::vector<std::string> _nodal_names, _element_names, _global_names;
};

} // namespace brickwall::io
