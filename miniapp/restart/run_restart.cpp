#include "miniapp/restart/run_restart.hpp"

#include "contact/base/mpi.hpp"

#include <cmath>
#include <cstring>
#include <sstream>
#include <type_traits>

namespace brickwall::miniapp {

namespace {

// Calls visit(name, value) for each of them; the only list.
template <class Data, class Visit>
void visitShared(Data& data, const Visit& visit) {
  auto& simulation = data.simulation;
  visit("step", simulation.steps.clock.step);
  visit("time", simulation.steps.clock.time);
  visit("dt", simulation.steps.clock.dt);
  visit("dt_before", simulation.steps.clock.dt_before);
  visit("end", simulation.steps.end);
  visit("steps_to_end", simulation.steps.steps_to_end);
  visit("compression_rates", simulation.steps.rates);
  visit("step_cuts", simulation.steps.cuts);
  visit("ledger", simulation.ledger);
  visit("load_span", simulation.load_span);
  visit("previous_load_span", simulation.previous_load_span);
  visit("forces_act", simulation.forces_act);
  visit("keeps_forces", simulation.keeps_forces);
  visit("guarded_steps", simulation.guarded_steps);
  visit("skipped_element_steps", simulation.skipped_element_steps);
  auto& contact = simulation.contact;
  visit("search_tolerance", contact.search_tolerance);
  visit("reference_step", contact.reference_step);
  visit("deepest", contact.deepest);
  visit("penetration", contact.penetration);
  visit("known_penetration", contact.known_penetration);
  visit("contact_previous_dt", contact.previous_dt);
  visit("has_contact_forces", contact.has_forces);
  visit("edges_have_forces", contact.edges_have_forces);
  visit("lost_contacts", contact.lost);
  visit("missed_pairs", contact.missed_pairs);
  visit("searches", contact.searches);
  visit("search_updates", contact.updates);
  visit("contact_ledger", contact.ledger);
  visit("output_ranks", data.output.ranks);
  visit("history_rows", data.output.history_rows);
  visit("exodus_steps", data.output.exodus_steps);
  visit("exodus_time", data.output.exodus_time);
  visit("last_history_step", data.output.last_row);
  visit("last_exodus_step", data.output.last_written);
  visit("history_tick", data.output.history_tick);
  visit("output_tick", data.output.output_tick);
  visit("reported_limits", data.reported_limits);
  visit("has_large_strain", data.has_large_strain);
}

template <class T>
constexpr std::size_t words_per = (sizeof(T) + 7) / 8;

constexpr const char* shared_table = "run";

// A value of any type as words: the bits of its bytes. Lists are as many values.
struct ToColumns {
  std::vector<io::Column>& columns;

  template <class T>
  void operator()(const char* name, const T& value) const {
    add(name, &value, 1);
  }
  template <class T>
  void operator()(const char* name, const std::vector<T>& values) const {
    if (!values.empty())
      add(name, values.data(), values.size());
  }
  template <class T>
  void add(const char* name, const T* values, std::size_t count) const {
    static_assert(std::is_trivially_copyable_v<T>);
    io::Column column{name, std::is_same_v<T, double>, static_cast<int>(count * words_per<T>), {}};
    column.words.resize(count * words_per<T>);
    for (std::size_t i = 0; i < count; ++i)
      std::memcpy(column.words.data() + i * words_per<T>, values + i, sizeof(T));
    columns.push_back(std::move(column));
  }
};

// Integers are counts, or -1 for none. The members of structs are not tested.
template <class T>
bool isInRange(std::int64_t word) {
  if constexpr (std::is_same_v<T, double>)
    return std::isfinite(io::realOf(word));
  else if constexpr (std::is_same_v<T, bool>)
    return word == 0 || word == 1;
  else
    return !std::is_integral_v<T> || word >= -1;
}

struct FromColumns {
  const io::Table& table;

  template <class T>
  void operator()(const char* name, T& value) const {
    read(name, table.column(name), &value, 1);
  }
  template <class T>
  void operator()(const char* name, std::vector<T>& values) const {
    for (const io::Column& column : table.columns)
      if (column.name == name) {
        values.resize(column.words.size() / words_per<T>);
        read(name, column, values.data(), values.size());
      }
  }
  template <class T>
  static void read(const char* name, const io::Column& column, T* values, std::size_t count) {
    if (column.is_real != std::is_same_v<T, double>)
      throw InputError(std::string("the checkpoint is of another build: ") + name +
                       " has another type");
    if (column.words.size() != count * words_per<T>)
      throw InputError(std::string("the checkpoint is of another build: ") + name + " has " +
                       std::to_string(column.words.size()) + " words, expected " +
                       std::to_string(count * words_per<T>));
    for (std::size_t i = 0; i < count; ++i)
      if (!isInRange<T>(column.words[i * words_per<T>]))
        throw InputError(std::string("the checkpoint has a value of ") + name + " out of range");
      else
        std::memcpy(static_cast<void*>(values + i), column.words.data() + i * words_per<T>,
                    sizeof(T));
  }
};

io::Table sharedTableOf(const TableFiles& files) {
  for (const auto& tables : files)
    for (const io::Table& table : tables)
      if (table.name == shared_table)
        return table;
  throw InputError(std::string("the checkpoint has no table ") + shared_table);
}

// The table of rank 0 on all ranks. Collective.
io::Table broadcast(MPI_Comm comm, const io::Table& of_root) {
  std::ostringstream columns;
  std::vector<std::int64_t> words;
  for (const io::Column& column : of_root.columns) {
    columns << column.name << ' ' << column.is_real << ' ' << column.words.size() << '\n';
    words.insert(words.end(), column.words.begin(), column.words.end());
  }
  std::istringstream lines(brickwall::broadcast(comm, columns.str()));
  auto count = static_cast<std::int64_t>(words.size());
  brickwall::broadcast(comm, &count, 1, 0);
  words.resize(static_cast<std::size_t>(count));
  brickwall::broadcast(comm, words.data(), count, 0);
  io::Table table{shared_table, {}};
  io::Column column;
  std::ptrdiff_t first = 0;
  for (std::ptrdiff_t size = 0; lines >> column.name >> column.is_real >> size; first += size) {
    column.width = static_cast<int>(size);
    column.words.assign(words.begin() + first, words.begin() + first + size);
    table.columns.push_back(column);
  }
  return table;
}

} // namespace

std::vector<io::Table> tablesOf(const RunRestart& data, const Simulation& simulation) {
  std::vector<io::Table> tables;
  if (rankOf(simulation.comm()) == 0) {
    tables.push_back({shared_table, {}});
    visitShared(data, ToColumns{tables.back().columns});
  }
  for (io::Table& table : entityTables(data.simulation, simulation))
    tables.push_back(std::move(table));
  return tables;
}

RunRestart fromTables(const TableFiles& files, const Simulation& simulation) {
  const MPI_Comm comm = simulation.comm();
  io::Table shared;
  rethrowOnAllRanks(comm, [&] {
    if (rankOf(comm) == 0)
      shared = sharedTableOf(files);
  });
  shared = broadcast(comm, shared);
  RunRestart data;
  visitShared(data, FromColumns{shared});
  const StepRestart& steps = data.simulation.steps;
  if (!(steps.clock.step >= 0 && steps.clock.time >= 0 && steps.clock.dt > 0 &&
        steps.clock.dt_before >= 0))
    throw InputError(
        "the checkpoint has a number of steps, a time or a length of steps out of range");
  if (steps.rates.size() != simulation.steps().restartData().rates.size())
    throw InputError("the checkpoint is of another build: compression_rates has " +
                     std::to_string(steps.rates.size()) + " values");
  takeEntities(files, simulation, data.simulation);
  return data;
}

} // namespace brickwall::miniapp
