// See deck.hpp. Text -> tree (toml_tree) -> overrides (deck_overrides) -> checked values
// (deck_checker).
#include "io/deck/deck.hpp"

#include "contact/base/mpi.hpp"
#include "io/deck/deck_checker.hpp"
#include "io/deck/deck_faults.hpp"
#include "io/deck/deck_overrides.hpp"
#include "io/deck/deck_renames.hpp"
#include "io/deck/deck_spelling.hpp"
#include "io/deck/toml_tree.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <unordered_map>

namespace brickwall::io {

struct Deck::Contents {
  std::string path;
  Schema schema; // the blocks point into it
  DeckFaults faults;
  std::vector<DeckBlock> blocks;
  std::vector<std::string> names; // before the first dot
  std::unordered_map<std::string, std::size_t> block_of_instance;
  std::unordered_map<std::string, int> number_of_blocks; // by their name

  const DeckBlock* findBlock(const std::string& instance) const {
    const auto found = block_of_instance.find(instance);
    return found == block_of_instance.end() ? nullptr : &blocks[found->second];
  }
  DeckValue& value(const std::string& block, const std::string& key) {
    if (const DeckBlock* found = findBlock(block))
      for (const DeckValue& value : found->values)
        if (value.rule->name == key)
          return const_cast<DeckValue&>(value);
    throw Error(ExitCode::internal, "Deck: no block \"" + block + "\" with a key \"" + key + "\"");
  }
  // Where a message on a block, or a key of it, belongs, and what it names: "[wall] gap".
  std::pair<Position, std::string> subjectOf(const std::string& block, const std::string& key) {
    const DeckBlock* instance = findBlock(block);
    if (!instance)
      throw Error(ExitCode::internal, "Deck: no block \"" + block + "\"");
    const std::string blank = instance->header.empty() || key.empty() ? "" : " ";
    return {key.empty() ? instance->at : value(block, key).at, instance->header + blank + key};
  }
};

namespace {

std::string readDeckFile(const std::string& path) {
  namespace fs = std::filesystem;
  constexpr std::uintmax_t largest = 4 << 20;
  std::error_code error;
  if (!fs::exists(path, error))
    throw InputError(path + ": no such deck; the deck is the path of a TOML file");
  if (fs::is_directory(path, error))
    throw InputError(path + ": found a directory, expected a deck (a TOML file)");
  std::ifstream file(path, std::ios::binary);
  std::string text;
  if (file) {
    text.resize(largest + 1);
    file.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<std::size_t>(file.gcount()));
  }
  if (!file && !file.eof())
    throw InputError(path + ": cannot read the deck: " + std::strerror(errno));
  if (text.size() > largest)
    throw InputError(path + ": found more than 4 MiB, expected a deck (a TOML file)");
  if (text.find('\0') != std::string::npos)
    throw InputError(path +
                     ": found a binary file, expected a deck (a TOML file); a mesh is named " +
                     "by file in [mesh]");
  return text;
}

template <class T>
std::vector<T> listOf(const DeckValue& value, T DeckValue::Entry::*member) {
  std::vector<T> list;
  if (value.is_good)
    for (const DeckValue::Entry& entry : value.entries)
      list.push_back(entry.*member);
  return list;
}

DeckValue::Entry firstOf(const DeckValue& value) {
  return value.is_good ? value.entries.front() : DeckValue::Entry();
}

} // namespace

Deck::Deck(std::unique_ptr<Contents> contents) : _contents(std::move(contents)) {}
Deck::Deck(Deck&&) noexcept = default;
Deck& Deck::operator=(Deck&&) noexcept = default;
Deck::~Deck() = default;

Deck Deck::read(MPI_Comm comm, const std::string& path, const std::vector<std::string>& overrides,
                const Schema& schema) {
  std::string text;
  rethrowOnAllRanks(comm, [&] {
    if (rankOf(comm) == 0)
      text = readDeckFile(path);
  });
  return parse(broadcast(comm, text), path, overrides, schema);
}

Deck Deck::parse(const std::string& raw_text, const std::string& path,
                 const std::vector<std::string>& overrides, const Schema& schema) {
  const std::string text = normalizeText(raw_text);
  auto contents = std::unique_ptr<Contents>(
      new Contents{path, schema, DeckFaults(path, splitLines(text), overrides), {}, {}, {}, {}});
  DeckFaults& faults = contents->faults;
  TomlNode root;
  try {
    root = parseToml(text);
  } catch (const TomlSyntaxError& error) {
    faults.add(error.at, "", error.what(), error.expected);
    throw InputError(faults.message());
  }
  renameInTree(contents->schema, root, faults); // overrides find the present names
  for (std::size_t i = 0; i < overrides.size(); ++i)
    applyOverride(overrides[i], static_cast<int>(i), contents->schema, root, faults);
  renameInTree(contents->schema, root, faults); // in their values
  if (root.members.empty() && faults.count() == 0) {
    faults.add({1, 1, 1, -1}, "", "an empty deck", "TOML tables such as [wall]");
    throw InputError(faults.message());
  }
  for (const auto& [name, node] : root.members)
    contents->names.push_back(name);
  contents->blocks = checkDeck(root, contents->schema, faults);
  for (std::size_t b = 0; b < contents->blocks.size(); ++b) {
    contents->block_of_instance.emplace(contents->blocks[b].instance, b);
    ++contents->number_of_blocks[contents->blocks[b].rule->name];
  }
  return Deck(std::move(contents));
}

bool Deck::hasName(const std::string& name) const {
  const auto& names = _contents->names;
  return std::find(names.begin(), names.end(), name) != names.end();
}
bool Deck::hasBlock(const std::string& block) const {
  const DeckBlock* found = _contents->findBlock(block);
  return found && found->is_given;
}
bool Deck::has(const std::string& block, const std::string& key) const {
  return _contents->value(block, key).is_given;
}
bool Deck::isGood(const std::string& block, const std::string& key) const {
  return _contents->value(block, key).is_good;
}

std::vector<std::string> Deck::names(const std::string& block) const {
  std::vector<std::string> found;
  for (const DeckBlock& candidate : _contents->blocks)
    if (candidate.rule->kind == BlockKind::named && candidate.rule->name == block)
      found.push_back(candidate.name);
  return found;
}
int Deck::count(const std::string& block) const {
  const auto found = _contents->number_of_blocks.find(block);
  return found == _contents->number_of_blocks.end() ? 0 : found->second;
}

bool Deck::boolean(const std::string& block, const std::string& key) const {
  return firstOf(_contents->value(block, key)).boolean;
}
std::int64_t Deck::integer(const std::string& block, const std::string& key) const {
  return firstOf(_contents->value(block, key)).integer;
}
double Deck::real(const std::string& block, const std::string& key) const {
  return firstOf(_contents->value(block, key)).real;
}
std::string Deck::text(const std::string& block, const std::string& key) const {
  return firstOf(_contents->value(block, key)).text;
}

std::vector<std::int64_t> Deck::integers(const std::string& block, const std::string& key) const {
  return listOf(_contents->value(block, key), &DeckValue::Entry::integer);
}
std::vector<double> Deck::reals(const std::string& block, const std::string& key) const {
  return listOf(_contents->value(block, key), &DeckValue::Entry::real);
}
std::vector<std::string> Deck::texts(const std::string& block, const std::string& key) const {
  return listOf(_contents->value(block, key), &DeckValue::Entry::text);
}

void Deck::complain(const std::string& block, const std::string& key, const std::string& found,
                    const std::string& expected) {
  const auto [at, subject] = _contents->subjectOf(block, key);
  _contents->faults.add(at, subject, found, expected);
}

void Deck::warn(const std::string& block, const std::string& key, const std::string& text) {
  const auto [at, subject] = _contents->subjectOf(block, key);
  _contents->faults.warn(at, subject + " " + text);
}

std::string Deck::placeOf(const std::string& block, const std::string& key) const {
  const DeckBlock* instance = _contents->findBlock(block);
  if (!instance)
    throw Error(ExitCode::internal, "Deck::placeOf: no block \"" + block + "\"");
  const Position of_key = key.empty() ? instance->at : _contents->value(block, key).at;
  return _contents->faults.placeOf(of_key.option >= 0 ? of_key : instance->at);
}

void Deck::assignText(const std::string& block, const std::string& key, const std::string& value) {
  _contents->value(block, key).entries.at(0).text = value;
}

void Deck::assignReal(const std::string& block, const std::string& key, double value) {
  DeckValue& given = _contents->value(block, key);
  given.is_good = true;
  given.entries.assign(1, {});
  given.entries[0].real = value;
}

int Deck::faults() const {
  return _contents->faults.count();
}
std::string Deck::message() const {
  return _contents->faults.message();
}
std::vector<std::string> Deck::warnings() const {
  return _contents->faults.warnings();
}
void Deck::finish() const {
  if (faults() > 0)
    throw InputError(message());
}

void Deck::finish(MPI_Comm comm) const {
  const std::string verdict = broadcast(comm, message());
  if (!verdict.empty())
    throw InputError(verdict);
}

std::string Deck::resolved() const {
  std::string out = "# resolved deck: all defaults filled in\n";
  for (const DeckBlock& block : _contents->blocks)
    out += spellBlock(block);
  return out;
}

const std::string& Deck::path() const {
  return _contents->path;
}

} // namespace brickwall::io
