// The reader of checkpoints, on that of a small wall with contact and with one damage, which the
// bytes of the input choose. Damaged bytes are refused by the checksums. With right checksums, a
// manifest or tables that lack something or have something twice, of another kind or out of range
// are refused with a reason; what no reader can know to be wrong, such as another velocity,
// restarts the run, which makes a step or fails with a reason.
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/fuzz/session.hpp"
#include "tests/miniapp/simulation/case.hpp"

#include "contact/base/error.hpp"
#include "miniapp/output/report.hpp"
#include "miniapp/restart/checkpoints.hpp"
#include "miniapp/restart/checksums.hpp"

#include <netcdf.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>

namespace {

using namespace brickwall;
using fuzz::Choices;
using fuzz::demand;
using Json = nlohmann::ordered_json;
using Tables = std::vector<io::Table>;

const char* const deck = R"(
[wall]
bricks = [2, 1, 2]
brick = [2.0, 1.0, 1.0]
elements = [2, 1, 1]
[material.brick]
density = 1.0
youngs_modulus = 1.0
poissons_ratio = 0.2
[[load.pressure]]
side_set = "front"
shape = "step"
peak = 1.0e-3
[gravity]
acceleration = [0.0, 0.0, -1.0e-4]
[[boundary.fixed]]
node_set = "base"
[contact]
friction = 0.4
[search]
reuse = { margin = 0.1 }
[time]
end = 100.0
)";

std::string contentOf(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}
void writeFile(const std::string& path, const std::string& content) {
  std::ofstream(path, std::ios::binary) << content;
}

// A run, its checkpoint, and what follows from it.
struct Original {
  Original() : checkpoints(MPI_COMM_SELF, run.config, run.scene, fuzz::folder() / "out") {
    run.simulation.start();
    for (int i = 0; i < 40; ++i)
      run.simulation.step();
    miniapp::RunRestart data;
    data.simulation = run.simulation.restartData();
    data.warnings = {"a warning"};
    const std::string path = checkpoints.write(data, run.simulation);
    part = path + "/part.1.0.nc";
    manifest = path + "/manifest.json";
    bytes = contentOf(part);
    json = Json::parse(contentOf(manifest));
    tables = io::readTables(part);
    for (const io::Table& table : tables)
      if (table.name != "edge_contacts" && table.name != "joint_contacts")
        demand(!table.columns.front().words.empty(), "there are rows of " + table.name);
    run.simulation.step();
    after_step = miniapp::checksums(run.simulation).nodes;
  }

  Kokkos::ScopeGuard kokkos;
  verification::Case run{deck, MPI_COMM_SELF};
  miniapp::Checkpoints checkpoints;
  std::string part, manifest; // paths
  std::string bytes; // of the part
  Json json; // the manifest
  Tables tables;
  std::uint64_t after_step = 0;
};

// Whether a value may be absent: lists that are empty in most runs.
bool isOptional(const io::Table& table, const io::Column& column) {
  return table.name == "run" && column.name == "step_cuts";
}

std::int64_t oddWord(Choices& choices) {
  const std::int64_t odd[] = {-1,
                              0,
                              1,
                              2,
                              -2,
                              1 << 20,
                              std::numeric_limits<std::int64_t>::max(),
                              std::numeric_limits<std::int64_t>::min(),
                              1ll << 32,
                              3};
  return odd[choices.below(std::size(odd))];
}
double oddReal(Choices& choices) {
  const double odd[] = {NAN, HUGE_VAL, -HUGE_VAL, 1e308, -1e308, 5e-324, -0.0, 0, 1, -1};
  return odd[choices.below(std::size(odd))];
}

enum class Verdict { same, refused, any };

Verdict damageBytes(std::string& bytes, Choices& choices) {
  const std::size_t at =
      (choices.below(256) << 16 | choices.below(256) << 8 | choices.below(256)) % bytes.size();
  if (choices.below(2) == 0)
    bytes.resize(at);
  else
    bytes[at] = static_cast<char>(bytes[at] ^ 1 << choices.below(8));
  return Verdict::refused;
}

Verdict damageTables(Tables& tables, Choices& choices) {
  io::Table& table = tables[choices.below(tables.size())];
  const std::size_t place = choices.below(table.columns.size());
  io::Column& column = table.columns[place];
  const bool has_rows = !column.words.empty(), is_run = table.name == "run";
  const bool is_certain = !isOptional(table, column);
  const auto width = static_cast<std::size_t>(column.width);
  const std::size_t row = has_rows ? choices.below(column.words.size() / width) * width : 0;
  switch (choices.below(9)) {
  case 0:
    tables.erase(tables.begin() + (&table - tables.data()));
    return Verdict::refused;
  case 1:
    if (table.columns.size() == 1)
      return Verdict::same;
    table.columns.erase(table.columns.begin() + static_cast<std::ptrdiff_t>(place));
    break;
  case 2:
    column.name += 'x';
    break;
  case 3:
    column.is_real = !column.is_real;
    break;
  case 4: // another width
    column.width = 1 + static_cast<int>(choices.below(3));
    if (column.width == static_cast<int>(width))
      return Verdict::same;
    column.words.resize(column.words.size() / width * static_cast<std::size_t>(column.width));
    break;
  case 5: // without the last row
    for (io::Column& each : table.columns)
      each.words.resize(each.words.size() - std::min(each.words.size(), std::size_t(each.width)));
    return !has_rows
               ? Verdict::same
               : (is_run || table.name == "nodes" || table.name == "swept_boxes" ? Verdict::refused
                                                                                 : Verdict::any);
  case 6: // a row twice
    for (io::Column& each : table.columns)
      for (std::size_t i = 0; i < (has_rows ? std::size_t(each.width) : 0); ++i)
        each.words.push_back(each.words[i]);
    return !has_rows
               ? Verdict::same
               : (table.name == "swept_boxes" || table.name == "joint_contacts" ? Verdict::any
                                                                                : Verdict::refused);
  case 7:
    if (!has_rows || column.is_real)
      return Verdict::same;
    column.words[row + choices.below(width)] = oddWord(choices);
    return Verdict::any;
  default: {
    if (!has_rows || !column.is_real)
      return Verdict::same;
    const double value = oddReal(choices);
    column.words[row + choices.below(width)] = io::wordOf(value);
    return std::isfinite(value) ? Verdict::any : Verdict::refused;
  }
  }
  return is_certain ? Verdict::refused : Verdict::any;
}

// Variables that no table has, and dimensions beyond the file.
Verdict damageFile(const std::string& path, Choices& choices) {
  int id = -1, dimensions[3], variable = -1;
  demand(nc_open(path.c_str(), NC_WRITE, &id) == NC_NOERR && nc_redef(id) == NC_NOERR, "opened");
  const std::size_t lengths[] = {
      NC_UNLIMITED, 1, 1u << 20, std::size_t(1) << 31, std::size_t(1) << 40, std::size_t(1) << 62};
  nc_def_dim(id, "odd", lengths[choices.below(std::size(lengths))], &dimensions[0]);
  nc_def_dim(id, "odd_width", lengths[choices.below(std::size(lengths))], &dimensions[1]);
  dimensions[2] = dimensions[1];
  const nc_type types[] = {NC_INT64, NC_DOUBLE, NC_CHAR, NC_BYTE, NC_FLOAT, NC_STRING, NC_UINT64};
  const char* const names[] = {"odd_x", "x", "odd", "nodes_odd", "od"};
  const std::string name = names[choices.below(std::size(names))];
  const nc_type type = types[choices.below(std::size(types))];
  const int num_dimensions = static_cast<int>(choices.below(4));
  const bool is_added =
      nc_def_var(id, name.c_str(), type, num_dimensions, dimensions, &variable) == NC_NOERR;
  const bool is_closed = nc_close(id) == NC_NOERR;
  // A further table of the right form is of no harm.
  const bool is_right = name == "odd_x" && num_dimensions > 0 && num_dimensions < 3 &&
                        (type == NC_INT64 || type == NC_DOUBLE);
  return is_added && is_closed && !is_right ? Verdict::refused : Verdict::any;
}

Verdict damageManifest(Json& manifest, Choices& choices) {
  const char* const keys[] = {"schema",   "version", "commit", "mesh", "deck",
                              "warnings", "parts",   "step",   "time", "end"};
  const std::string key = keys[choices.below(std::size(keys))];
  const Verdict verdict =
      key == "step" || key == "time" || key == "end" ? Verdict::any : Verdict::refused;
  const Json odd[] = {nullptr, 7, Json::object(), Json::array({Json::array()}), true, -1.5};
  const char* const of_part[] = {"file", "bytes", "checksum"};
  Json& part = manifest["parts"][0];
  switch (choices.below(5)) {
  case 0:
    manifest.erase(key);
    return verdict;
  case 1:
    manifest[key] = odd[choices.below(std::size(odd))];
    return verdict;
  case 2:
    manifest["parts"].push_back(part);
    return Verdict::refused;
  case 3:
    part.erase(of_part[choices.below(3)]);
    return Verdict::refused;
  default:
    part[of_part[choices.below(3)]] = odd[choices.below(std::size(odd))];
    return Verdict::refused;
  }
}

void writeManifest(const Original& original, Json manifest) {
  if (manifest.contains("parts") && manifest["parts"].is_array() && !manifest["parts"].empty()) {
    Json& part = manifest["parts"][0];
    const std::string bytes = contentOf(original.part);
    if (part.is_object() && part["bytes"] == original.json["parts"][0]["bytes"])
      part["bytes"] = bytes.size();
    if (part.is_object() && part["checksum"] == original.json["parts"][0]["checksum"])
      part["checksum"] = miniapp::format(
          "%016llx", static_cast<unsigned long long>(io::fileChecksum(original.part)));
  }
  manifest.erase("checksum");
  manifest["checksum"] = miniapp::format(
      "%016llx", static_cast<unsigned long long>(miniapp::textChecksum(manifest.dump())));
  writeFile(original.manifest, manifest.dump());
}

// Writes the checkpoint with the damage.
Verdict damage(const Original& original, Choices& choices) {
  Verdict verdict = Verdict::same;
  std::string bytes = original.bytes, text = original.json.dump();
  Json manifest = original.json;
  Tables tables = original.tables;
  std::remove(original.part.c_str()); // HDF5 may hold the one before open
  switch (choices.below(7)) {
  case 0:
    verdict = damageBytes(bytes, choices);
    break;
  case 1:
    damageBytes(text, choices);
    verdict = Json::parse(text, nullptr, false) == original.json ? Verdict::same : Verdict::refused;
    break;
  case 2:
    verdict = damageManifest(manifest, choices);
    writeFile(original.part, bytes);
    writeManifest(original, manifest);
    return verdict;
  case 3:
    writeFile(original.part, bytes);
    verdict = damageFile(original.part, choices);
    writeManifest(original, manifest);
    return verdict;
  default:
    verdict = damageTables(tables, choices);
    io::writeTables(original.part, tables);
    writeManifest(original, manifest);
    return verdict;
  }
  writeFile(original.part, bytes);
  writeFile(original.manifest, text);
  return verdict;
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::folder(); // MPI before Kokkos
  static Original original;
  Choices choices(data, size);
  const Verdict verdict = damage(original, choices);
  try {
    const miniapp::RunRestart restart =
        original.checkpoints.read("latest", original.run.simulation);
    demand(verdict != Verdict::refused, "the checkpoint is refused");
    original.run.simulation.restore(restart.simulation);
    original.run.simulation.step();
    demand(verdict == Verdict::any ||
               miniapp::checksums(original.run.simulation).nodes == original.after_step,
           "the run continues with the same bits");
  } catch (const Error& error) {
    demand(verdict != Verdict::same, std::string("the checkpoint is accepted: ") + error.what());
    demand(*error.what() != 0 && error.code() != ExitCode::internal,
           std::string("a fault of the checkpoint: ") + error.what());
  }
  return 0;
}
