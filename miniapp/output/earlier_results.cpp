#include "miniapp/output/earlier_results.hpp"

#include "contact/base/mpi.hpp"
#include "io/checkpoint/table_file.hpp"
#include "io/mesh/rows_by_id.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>

namespace brickwall::miniapp {

namespace {

namespace fs = std::filesystem;

std::string folderOf(const std::string& base) {
  return fs::path(base).has_parent_path() ? fs::path(base).parent_path().string() : ".";
}

// Files get their names one by one. While this note is there, which holds the numbers of new and of
// replaced files, all of the new ones are on the disk, with or without their suffix.
std::string noteOf(const std::string& base) {
  return base + EarlierResults::new_suffix + ".ranks";
}

// The numbers of ranks for which there is a file of rank 0: N of base.N.0, and 1 for base itself.
std::vector<int> layoutsOf(const std::string& base, const std::string& suffix = "") {
  std::vector<int> found;
  std::error_code none;
  if (fs::exists(base + suffix, none))
    found.push_back(1);
  const std::string prefix = fs::path(base).filename().string() + ".";
  for (const auto& entry : fs::directory_iterator(folderOf(base), none)) {
    const std::string name = entry.path().filename().string();
    if (name.compare(0, prefix.size(), prefix) != 0)
      continue;
    const int ranks = std::atoi(name.c_str() + prefix.size());
    if (ranks > 1 &&
        fs::path(io::rankFileName(base, ranks, 0)).filename().string() + suffix == name)
      found.push_back(ranks);
  }
  std::sort(found.begin(), found.end());
  return found;
}

bool startsWith(const std::vector<std::string>& all, const std::vector<std::string>& first) {
  return all.size() >= first.size() && std::equal(first.begin(), first.end(), all.begin());
}

// Values of one kind in a step, from the files of all ranks to the entities `wanted`.
std::vector<std::vector<double>>
gather(MPI_Comm comm, const std::vector<io::ResultsReader>& files, std::size_t num_variables,
       const std::vector<global_id>& wanted,
       const std::function<const std::vector<global_id>&(const io::ResultsReader&)>& idsOf,
       const std::function<std::vector<double>(const io::ResultsReader&, int)>& valuesOf) {
  io::RowsById held;
  held.width = static_cast<int>(num_variables);
  rethrowOnAllRanks(comm, [&] {
    for (const io::ResultsReader& file : files) {
      const std::vector<global_id>& ids = idsOf(file);
      const std::size_t first = held.words.size();
      held.ids.insert(held.ids.end(), ids.begin(), ids.end());
      held.words.resize(first + ids.size() * num_variables);
      for (std::size_t v = 0; v < num_variables; ++v) {
        const std::vector<double> values = valuesOf(file, static_cast<int>(v));
        for (std::size_t i = 0; i < ids.size(); ++i)
          held.words[first + i * num_variables + v] = io::wordOf(values[i]);
      }
    }
  });
  const io::RowsById found = io::fetchRows(comm, held, wanted);
  std::vector<std::vector<double>> values(num_variables, std::vector<double>(wanted.size()));
  rethrowOnAllRanks(comm, [&] {
    std::size_t row = 0;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      if (row == found.ids.size() || found.ids[row] != wanted[i])
        throw InputError("the earlier results lack a node or an element of the mesh");
      for (std::size_t v = 0; v < num_variables; ++v)
        values[v][i] = io::realOf(found.row(row)[v]);
      while (row < found.ids.size() && found.ids[row] == wanted[i])
        ++row; // a shared node is in several files
    }
  });
  return values;
}

} // namespace

EarlierResults::EarlierResults(MPI_Comm comm, const std::string& base, int ranks, int steps,
                               double time, const io::ResultsConfig& config)
    : _comm(comm), _base(base), _steps(steps), _time(time), _nodal_names(config.nodal_names),
      _element_names(config.element_names), _global_names(config.global_names) {
  std::vector<int> layouts;
  if (rankOf(comm) == 0)
    layouts = layoutsOf(base);
  std::stable_partition(layouts.begin(), layouts.end(), [&](int n) { return n == ranks; });
  int count = static_cast<int>(layouts.size());
  broadcast(comm, &count, 1, 0);
  layouts.resize(static_cast<std::size_t>(count));
  broadcast(comm, layouts.data(), count, 0);
  for (const int layout : layouts) {
    const std::string problem = open(layout);
    if (problem.empty()) {
      _ranks = layout;
      _reason.clear();
      return;
    }
    if (_reason.empty())
      _reason = problem;
    _files.clear();
  }
}

std::string EarlierResults::open(int ranks) {
  std::string problem;
  for (int r = rankOf(_comm); r < ranks && problem.empty(); r += sizeOf(_comm)) {
    try {
      _files.emplace_back(io::rankFileName(_base, ranks, r));
      problem = problemOf(_files.back());
      if (!problem.empty())
        problem = io::rankFileName(_base, ranks, r) + ": " + problem;
    } catch (const Error& error) {
      problem = error.what();
    }
  }
  const int none = sizeOf(_comm);
  const int first = allReduce(_comm, problem.empty() ? none : rankOf(_comm), MPI_MIN);
  return first == none ? "" : broadcast(_comm, problem, first);
}

std::string EarlierResults::problemOf(const io::ResultsReader& file) const {
  if (!startsWith(file.nodalNames(), _nodal_names) ||
      !startsWith(file.elementNames(), _element_names) || file.globalNames() != _global_names)
    return "other variables than those of this run";
  if (file.numSteps() < _steps)
    return "found " + std::to_string(file.numSteps()) + " steps, expected at least " +
           std::to_string(_steps) + ", which were written before the checkpoint";
  if (_steps == 0) // a restart in a new folder began the file, and has written no step since
    return "";
  const double time = file.time(_steps); // a float in a file of single precision
  if (time != _time && time != static_cast<double>(static_cast<float>(_time)))
    return "step " + std::to_string(_steps) + " is of another time than in the checkpoint";
  return "";
}

void EarlierResults::copyTo(io::ResultsWriter& writer, const io::MeshPart& part) const {
  for (int step = 1; step <= _steps; ++step) {
    double time = 0;
    std::vector<double> global(_global_names.size());
    rethrowOnAllRanks(_comm, [&] {
      if (rankOf(_comm) != 0) // the first file is read there
        return;
      time = _files.front().time(step);
      global = _files.front().global(step);
    });
    broadcast(_comm, &time, 1, 0);
    broadcast(_comm, global.data(), static_cast<std::int64_t>(global.size()), 0);
    const auto nodal = gather(
        _comm, _files, _nodal_names.size(), part.nodeNumbers(),
        [](const auto& file) -> const auto& { return file.nodeNumbers(); },
        [step](const auto& file, int variable) { return file.nodal(step, variable); });
    const auto element = gather(
        _comm, _files, _element_names.size(), part.elemNumbers(),
        [](const auto& file) -> const auto& { return file.elemNumbers(); },
        [step](const auto& file, int variable) { return file.element(step, variable); });
    writer.writeStep(time, nodal, element, global);
  }
}

void EarlierResults::replaceBy(const io::ResultsWriter& writer) const {
  rethrowOnAllRanks(_comm, [&] { io::syncToDisk(writer.fileName() + new_suffix); });
  rethrowOnAllRanks(_comm, [&] {
    if (rankOf(_comm) != 0)
      return;
    const std::string note = noteOf(_base);
    std::ofstream file(note);
    file << sizeOf(_comm) << ' ' << _ranks << std::endl;
    if (!file)
      throw OutputError(note + ": could not be written");
    io::syncToDisk(note);
    io::syncToDisk(folderOf(_base));
  });
  endReplacement(_comm, _base);
}

void EarlierResults::endReplacement(MPI_Comm comm, const std::string& base) {
  rethrowOnAllRanks(comm, [&] {
    if (rankOf(comm) != 0)
      return;
    int ranks = 0, replaced = 0;
    std::ifstream(noteOf(base)) >> ranks >> replaced;
    for (int r = 0; r < ranks; ++r) {
      const std::string path = io::rankFileName(base, ranks, r);
      std::error_code error;
      fs::rename(path + new_suffix, path, error);
      if (error && error != std::errc::no_such_file_or_directory)
        throw OutputError(path + new_suffix + ": cannot be renamed: " + error.message());
    }
    if (ranks > 0)
      io::syncToDisk(folderOf(base));
    std::error_code ignored;
    for (int r = 0; r < replaced && replaced != ranks; ++r)
      fs::remove(io::rankFileName(base, replaced, r), ignored);
    fs::remove(noteOf(base), ignored);
    for (const int layout : layoutsOf(base, new_suffix)) // of a run that was killed before the note
      for (int r = layout; r-- > 0;)
        fs::remove(io::rankFileName(base, layout, r) + new_suffix, ignored);
  });
}

} // namespace brickwall::miniapp
