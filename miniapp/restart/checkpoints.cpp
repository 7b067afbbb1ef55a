#include "miniapp/restart/checkpoints.hpp"

#include "contact/base/mpi.hpp"
#include "miniapp/output/report.hpp"
#include "miniapp/restart/checksums.hpp"
#include "miniapp/restart/deck_differences.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace brickwall::miniapp {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* schema = "brickwall-checkpoint-1";
constexpr const char* manifest_name = "manifest.json";

std::string hex(std::uint64_t value) {
  return format("%016llx", static_cast<unsigned long long>(value));
}

std::string partName(std::int64_t ranks, std::int64_t rank) {
  return format("part.%lld.%0*lld.nc", ranks, static_cast<int>(std::to_string(ranks).size()), rank);
}

std::string stepName(std::int64_t step) {
  return format("step-%012lld", step);
}

// Whether the name is that of a checkpoint, of any number of digits.
bool isStepName(const std::string& name) {
  return name.size() > 5 && name.compare(0, 5, "step-") == 0 &&
         name.find_first_not_of("0123456789", 5) == std::string::npos;
}

// On one line; bytes that are not UTF-8, as a path may have, are replaced as in the file.
std::string checksumOf(const Json& manifest) {
  return hex(textChecksum(manifest.dump(-1, ' ', false, Json::error_handler_t::replace)));
}

std::string withChecksum(Json manifest) {
  manifest["checksum"] = checksumOf(manifest);
  return jsonText(manifest);
}

void writeManifest(const std::string& path, const Json& manifest) {
  std::ofstream file(path);
  file << withChecksum(manifest) << std::flush;
  if (!file)
    throw OutputError(path + ": could not be written: " + std::strerror(errno));
  file.close();
  io::syncToDisk(path);
}

std::string readManifest(const std::string& path) {
  std::ifstream file(path + "/" + manifest_name);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file || text.str().empty())
    throw InputError(std::string("there is no ") + manifest_name + " that can be read");
  return text.str();
}

// Throws InputError for a text that is damaged.
Json parseManifest(const std::string& text) {
  Json manifest = Json::parse(text, nullptr, false);
  if (!manifest.is_object() || !manifest["checksum"].is_string())
    throw InputError(std::string(manifest_name) + " is damaged");
  const std::string checksum = manifest["checksum"];
  manifest.erase("checksum");
  if (checksumOf(manifest) != checksum)
    throw InputError(std::string(manifest_name) +
                     " has another checksum than it states: it is damaged");
  return manifest;
}

// The file of a rank, of which the manifest states length and checksum.
void checkPart(const std::string& path, const Json& part) {
  std::error_code error;
  const auto bytes = fs::file_size(path, error);
  if (error)
    throw InputError(path + ": " + error.message());
  if (bytes != part.at("bytes").get<std::uintmax_t>())
    throw InputError(path + ": found " + std::to_string(bytes) + " bytes, expected " +
                     part.at("bytes").dump() + ": it is truncated or damaged");
  if (hex(io::fileChecksum(path)) != part.at("checksum").get<std::string>())
    throw InputError(path + ": has another checksum than in the manifest: it is damaged");
}

void removeTree(const std::string& path) {
  std::error_code ignored;
  fs::remove_all(path, ignored);
}

void makeEmptyFolder(const std::string& path) {
  removeTree(path);
  std::error_code error;
  fs::create_directories(path, error);
  if (error)
    throw OutputError(path + ": cannot be made: " + error.message());
}

// Gives the folder `finished` the name `path`, which a folder of an earlier run to the same step
// may have.
void replaceBy(const std::string& finished, const std::string& path) {
  const std::string old = path + ".old";
  removeTree(old);
  std::error_code none, error;
  fs::rename(path, old, none);
  fs::rename(finished, path, error);
  if (error) {
    fs::rename(old, path, none);
    throw OutputError(path + ": cannot be named: " + error.message());
  }
}

} // namespace

struct Checkpoints::Opened {
  std::string commit;
  std::vector<std::string> warnings;
  TableFiles tables; // of the files that this rank reads
};

void Checkpoints::prepare() {
  if (!_mesh.empty())
    return;
  const Provenance build = describeRun(_comm);
  _version = build.version;
  _commit = build.commit;
  _mesh = hex(meshChecksum(_comm, _scene.part));
}

// `parts`: bytes and checksum of the file of each rank.
Json Checkpoints::manifestOf(const RunRestart& data,
                             const std::vector<std::uint64_t>& parts) const {
  Json manifest = {{"schema", schema},
                   {"version", _version},
                   {"commit", _commit},
                   {"step", data.simulation.steps.clock.step},
                   {"time", data.simulation.steps.clock.time},
                   {"end", data.simulation.steps.end},
                   {"mesh", _mesh},
                   {"deck", _config.resolved_deck},
                   {"warnings", data.warnings},
                   {"parts", Json::array()}};
  const std::size_t ranks = parts.size() / 2;
  for (std::size_t r = 0; r < ranks; ++r)
    manifest["parts"].push_back(
        {{"file", partName(static_cast<std::int64_t>(ranks), static_cast<std::int64_t>(r))},
         {"bytes", parts[2 * r]},
         {"checksum", hex(parts[2 * r + 1])}});
  return manifest;
}

std::string Checkpoints::write(const RunRestart& data, const Simulation& simulation) {
  prepare();
  const int ranks = sizeOf(_comm), rank = rankOf(_comm);
  std::string path = _folder + "/" + stepName(data.simulation.steps.clock.step);
  const std::string temporary = path + ".tmp";
  const std::string part = temporary + "/" + partName(ranks, rank);
  std::uint64_t own[2] = {0, 0}; // bytes, checksum
  try {
    rethrowOnAllRanks(_comm, [&] {
      if (rank == 0)
        makeEmptyFolder(temporary);
    });
    rethrowOnAllRanks(_comm, [&] {
      io::writeTables(part, tablesOf(data, simulation));
      own[0] = fs::file_size(part);
      own[1] = io::fileChecksum(part);
    });
    std::vector<std::uint64_t> parts(2 * static_cast<std::size_t>(ranks));
    checkMpi(MPI_Gather(own, 2, MPI_UINT64_T, parts.data(), 2, MPI_UINT64_T, 0, _comm),
             "MPI_Gather");
    rethrowOnAllRanks(_comm, [&] {
      if (rank != 0)
        return;
      writeManifest(temporary + "/" + manifest_name, manifestOf(data, parts));
      io::syncToDisk(temporary);
      replaceBy(temporary, path);
      io::syncToDisk(_folder);
      io::syncToDisk(fs::path(_folder).parent_path().string()); // the name of _folder
    });
  } catch (const Error& error) { // of the file system too
    if (rank == 0)
      removeTree(temporary);
    throw OutputError(error.what());
  }
  if (rank == 0)
    removeOutdated(path);
  return path;
}

// Others than `latest` and the one before it are older ones, later ones that a restart has passed
// over, and unfinished ones.
void Checkpoints::removeOutdated(const std::string& latest) const {
  std::string before;
  for (const std::string& other : all(_folder))
    if (other < latest)
      before = other;
  std::vector<fs::path> outdated; // only what write() makes
  std::error_code none;
  for (fs::directory_iterator at(_folder, none), end; !none && at != end; at.increment(none)) {
    const fs::path& entry = at->path();
    const std::string suffix = entry.extension().string();
    if (isStepName(entry.stem().string()) && entry != latest && entry != before &&
        (suffix.empty() || suffix == ".tmp" || suffix == ".old"))
      outdated.push_back(entry);
  }
  for (const fs::path& entry : outdated)
    removeTree(entry.string());
}

std::vector<std::string> Checkpoints::all(const std::string& folder) const {
  std::vector<std::string> paths;
  std::error_code none;
  for (auto at = fs::directory_iterator(folder, none); at != fs::directory_iterator();
       at.increment(none)) {
    const std::string name = at->path().filename().string();
    if (isStepName(name))
      paths.push_back(at->path().string());
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

std::string Checkpoints::nearest(const std::string& path) const {
  const fs::path given(path);
  const fs::path place = given.has_filename() ? given : given.parent_path();
  const fs::path parent = place.has_parent_path() ? place.parent_path() : ".";
  const auto stepOf = [](const fs::path& checkpoint) { // step-77 and step-000000000077 alike
    const std::string name = checkpoint.filename().string();
    return isStepName(name) ? std::atoll(name.c_str() + 5) : INT64_MAX;
  };
  for (const std::string& folder : {parent.string(), (parent / "checkpoints").string(), _folder}) {
    std::string best;
    std::error_code none;
    for (const std::string& other : all(folder))
      if (!fs::equivalent(other, place, none) && (best.empty() || stepOf(other) <= stepOf(place)))
        best = other;
    if (!best.empty())
      return best;
  }
  return "";
}

std::string Checkpoints::pathOf(const std::string& which) const {
  std::string path = which;
  rethrowOnAllRanks(_comm, [&] {
    if (rankOf(_comm) != 0)
      return;
    const bool is_latest = which == "latest";
    const std::vector<std::string> places =
        is_latest ? std::vector<std::string>{_folder}
                  : std::vector<std::string>{which, which + "/checkpoints"};
    for (const std::string& folder : places)
      if (const auto paths = all(folder); !paths.empty()) {
        path = paths.back();
        return;
      }
    if (is_latest)
      throw InputError("--restart latest: there is no checkpoint in " + _folder);
    if (fs::path(path).filename() == manifest_name)
      path = fs::path(path).has_parent_path() ? fs::path(path).parent_path().string() : ".";
  });
  return broadcast(_comm, path);
}

void Checkpoints::checkManifest(const std::string& path, const Json& manifest) const {
  const auto demand = [&](const char* key, const std::string& expected) {
    const std::string found = manifest.value(key, std::string());
    if (found != expected)
      throw InputError(std::string("its ") + key + " is " + found + ", expected " + expected);
  };
  demand("schema", schema);
  demand("version", _version);
  const std::string difference =
      deckDifference(manifest.at("deck").get<std::string>(), _config.resolved_deck);
  if (!difference.empty())
    throw InputError("it is of another deck: " + difference);
  demand("mesh", _mesh);
  if (!manifest.at("parts").is_array() || manifest["parts"].empty())
    throw InputError(path + ": the manifest names no files");
}

Checkpoints::Opened Checkpoints::open(const std::string& path, bool reads_tables) const {
  std::string text;
  rethrowOnAllRanks(_comm, [&] {
    if (rankOf(_comm) == 0)
      text = readManifest(path);
  });
  Opened opened;
  text = broadcast(_comm, text);
  rethrowOnAllRanks(_comm, [&] {
    const Json manifest = parseManifest(text);
    try {
      checkManifest(path, manifest);
      opened.commit = manifest.at("commit").get<std::string>();
      opened.warnings = manifest.at("warnings").get<std::vector<std::string>>();
      const Json& parts = manifest.at("parts");
      for (auto r = static_cast<std::size_t>(rankOf(_comm)); r < parts.size();
           r += static_cast<std::size_t>(sizeOf(_comm))) {
        const std::string file = path + "/" + parts[r].at("file").get<std::string>();
        checkPart(file, parts[r]);
        if (reads_tables)
          opened.tables.push_back(io::readTables(file));
      }
    } catch (const Json::exception& error) {
      throw InputError(std::string(manifest_name) +
                       " lacks a field, or has one of another type: " + error.what());
    }
  });
  return opened;
}

RunRestart Checkpoints::read(const std::string& which, const Simulation& simulation) {
  prepare();
  const std::string path = pathOf(which);
  try {
    const Opened opened = open(path, true);
    RunRestart data = fromTables(opened.tables, simulation);
    data.warnings = opened.warnings;
    if (rankOf(_comm) == 0 && opened.commit != _commit)
      data.note = path + " was written by the commit " + opened.commit +
                  " of this version: the last bits of results may differ";
    return data;
  } catch (const InputError& error) {
    std::string message = "the checkpoint " + path + " cannot be used: " + error.what();
    const std::string other = broadcast(_comm, rankOf(_comm) == 0 ? nearest(path) : "");
    if (!other.empty())
      try {
        open(other, false);
        message += "; the nearest one can: --restart " + other;
      } catch (const InputError&) {
        message += "; nor can the nearest one, " + other;
      }
    throw InputError(message);
  }
}

} // namespace brickwall::miniapp
