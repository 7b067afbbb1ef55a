#include "miniapp/restart/run_restart.hpp"

#include "contact/base/mpi.hpp"
#include "contact/base/to_device.hpp"
#include "io/mesh/rows_by_id.hpp"

#include <array>
#include <cstring>
#include <sstream>
#include <type_traits>

namespace brickwall::miniapp {

namespace {

// ---- Values that all ranks share ----

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
    if (column.words.size() != count * words_per<T>)
      throw InputError(std::string("the checkpoint is of another build: ") + name + " has " +
                       std::to_string(column.words.size()) + " words, expected " +
                       std::to_string(count * words_per<T>));
    for (std::size_t i = 0; i < count; ++i)
      std::memcpy(static_cast<void*>(values + i), column.words.data() + i * words_per<T>,
                  sizeof(T));
  }
};

io::Table sharedTableOf(const std::vector<std::vector<io::Table>>& files) {
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

// ---- Values of entities: tables with the global id in the first column ----

struct ColumnLayout {
  std::string name;
  bool is_real;
  int width;
};
struct TableLayout {
  std::string name;
  std::vector<ColumnLayout> columns; // without the id

  int width() const {
    int sum = 0;
    for (const ColumnLayout& column : columns)
      sum += column.width;
    return sum;
  }
};

io::Table toTable(const TableLayout& layout, const io::RowsById& rows) {
  io::Table table{layout.name, {{"id", false, 1, rows.ids}}};
  int first = 0;
  for (const ColumnLayout& of : layout.columns) {
    io::Column column{of.name, of.is_real, of.width, {}};
    for (std::size_t i = 0; i < rows.ids.size(); ++i)
      column.words.insert(column.words.end(), rows.row(i) + first, rows.row(i) + first + of.width);
    first += of.width;
    table.columns.push_back(std::move(column));
  }
  return table;
}

void appendRows(const TableLayout& layout, const io::Table& table, io::RowsById& rows) {
  const io::Column& ids = table.column("id");
  std::vector<const io::Column*> columns;
  for (const ColumnLayout& of : layout.columns) {
    columns.push_back(&table.column(of.name));
    if (columns.back()->width != of.width || columns.back()->is_real != of.is_real)
      throw InputError("the checkpoint is of another build: " + layout.name + "_" + of.name +
                       " has another type");
  }
  rows.ids.insert(rows.ids.end(), ids.words.begin(), ids.words.end());
  for (std::size_t i = 0; i < ids.words.size(); ++i)
    for (const io::Column* column : columns) {
      const auto begin = column->words.begin() + static_cast<std::ptrdiff_t>(i) * column->width;
      rows.words.insert(rows.words.end(), begin, begin + column->width);
    }
}

// The rows of all files for the ids `wanted` of this rank. Collective.
io::RowsById takeRows(MPI_Comm comm, const TableLayout& layout,
                      const std::vector<std::vector<io::Table>>& files,
                      const std::vector<global_id>& wanted) {
  io::RowsById held;
  held.width = layout.width();
  rethrowOnAllRanks(comm, [&] {
    for (const auto& tables : files)
      for (const io::Table& table : tables)
        if (table.name == layout.name)
          appendRows(layout, table, held);
  });
  return io::fetchRows(comm, held, wanted);
}

TableLayout nodeLayout(const Simulation& simulation, bool has_forces) {
  TableLayout layout{"nodes", {{"displacement", true, 3}, {"velocity", true, 3}}};
  if (has_forces)
    layout.columns.push_back(
        {"forces", false, mechanics::numForceColumns(simulation.config().viscosity.any())});
  return layout;
}

const TableLayout box_layout{"swept_boxes", {{"box", true, 6}}};

io::RowsById nodeRows(const SimulationRestart& data, const Simulation& simulation) {
  const auto& ids = simulation.scene().part.node_ids;
  const auto& is_owned = simulation.scene().node_is_owned;
  io::RowsById rows;
  rows.width = nodeLayout(simulation, !data.forces.empty()).width();
  const std::size_t num_forces = ids.empty() ? 0 : data.forces.size() / ids.size();
  for (std::size_t node = 0; node < ids.size(); ++node) {
    if (!is_owned[node])
      continue;
    rows.ids.push_back(ids[node]);
    for (const auto* field : {&data.displacement, &data.velocity})
      for (std::size_t d = 0; d < 3; ++d)
        rows.words.push_back(io::wordOf((*field)[3 * node + d]));
    for (std::size_t i = 0; i < num_forces; ++i)
      rows.words.push_back(data.forces[num_forces * node + i]);
  }
  return rows;
}

void takeNodes(const io::RowsById& rows, const std::vector<global_id>& wanted,
               SimulationRestart& data) {
  if (rows.ids != wanted)
    throw InputError("the checkpoint lacks a node of the mesh");
  for (std::size_t node = 0; node < wanted.size(); ++node) {
    const std::int64_t* words = rows.row(node);
    for (std::size_t d = 0; d < 3; ++d) {
      data.displacement.push_back(io::realOf(words[d]));
      data.velocity.push_back(io::realOf(words[3 + d]));
    }
    data.forces.insert(data.forces.end(), words + 6, words + rows.width);
  }
}

// ---- Contacts ----

// What a value of visitFields() becomes: width and type, words, and back.
struct FieldLayout {
  std::vector<ColumnLayout>& columns;
  void operator()(const char* name, const double&) const { columns.push_back({name, true, 1}); }
  void operator()(const char* name, const Vec3&) const { columns.push_back({name, true, 3}); }
  void operator()(const char* name, const double (&)[4]) const {
    columns.push_back({name, true, 4});
  }
  void operator()(const char* name, const int&) const { columns.push_back({name, false, 1}); }
  void operator()(const char* name, const global_id&) const { columns.push_back({name, false, 1}); }
};
struct FieldToWords {
  std::vector<std::int64_t>& words;
  void operator()(const char*, const double& value) const { words.push_back(io::wordOf(value)); }
  void operator()(const char*, const Vec3& value) const {
    for (int d = 0; d < 3; ++d)
      words.push_back(io::wordOf(value[d]));
  }
  void operator()(const char*, const double (&values)[4]) const {
    for (const double value : values)
      words.push_back(io::wordOf(value));
  }
  void operator()(const char*, const int& value) const { words.push_back(value); }
  void operator()(const char*, const global_id& value) const { words.push_back(value); }
};
struct FieldFromWords {
  const std::int64_t*& next;
  void operator()(const char*, double& value) const { value = io::realOf(*next++); }
  void operator()(const char*, Vec3& value) const {
    for (int d = 0; d < 3; ++d)
      value[d] = io::realOf(*next++);
  }
  void operator()(const char*, double (&values)[4]) const {
    for (double& value : values)
      value = io::realOf(*next++);
  }
  void operator()(const char*, int& value) const { value = static_cast<int>(*next++); }
  void operator()(const char*, global_id& value) const { value = *next++; }
};

TableLayout contactLayout(const std::string& name) {
  TableLayout layout{name, {}};
  contact::ContactRecord record;
  contact::visitFields(record, FieldLayout{layout.columns});
  return layout;
}
const char* const node_contacts = "node_contacts";
const char* const edge_contacts = "edge_contacts";

io::RowsById contactRows(const std::vector<contact::ContactRecord>& records) {
  io::RowsById rows;
  rows.width = contactLayout("").width();
  for (const contact::ContactRecord& record : records) {
    rows.ids.push_back(record.node);
    contact::visitFields(record, FieldToWords{rows.words});
  }
  return rows;
}
std::vector<contact::ContactRecord> recordsOf(const io::RowsById& rows) {
  std::vector<contact::ContactRecord> records(rows.ids.size());
  for (std::size_t i = 0; i < records.size(); ++i) {
    const std::int64_t* next = rows.row(i);
    contact::visitFields(records[i], FieldFromWords{next});
  }
  return records;
}

template <class ViewType>
std::vector<global_id> listOf(const ViewType& ids, std::size_t count) {
  const auto host = toHost(ids);
  return std::vector<global_id>(host.data(), host.data() + count);
}

// Ids of the surface nodes of this rank, all or only those that it owns.
std::vector<global_id> surfaceNodes(const ContactStep& contact, bool only_owned) {
  const contact::Surface surface = contact.surface();
  const auto all = listOf(surface.node_ids, static_cast<std::size_t>(surface.num_nodes));
  if (!only_owned)
    return all;
  const auto is_owned = toHost(surface.node_is_owned);
  std::vector<global_id> owned;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (is_owned(i))
      owned.push_back(all[i]);
  return owned;
}

void takeContact(MPI_Comm comm, const std::vector<std::vector<io::Table>>& files,
                 const ContactStep& contact, ContactRestart& data) {
  data.nodes =
      recordsOf(takeRows(comm, contactLayout(node_contacts), files, surfaceNodes(contact, true)));
  const contact::EdgeContact* edges = contact.edges();
  // Ids of corners in the list are those of nodes, which no edge has.
  const auto edge_ids =
      edges ? listOf(edges->nodeIds(), edges->nodeIds().extent(0)) : std::vector<global_id>();
  data.edges = recordsOf(takeRows(comm, contactLayout(edge_contacts), files, edge_ids));
  const auto nodes = surfaceNodes(contact, false);
  const io::RowsById boxes = takeRows(comm, box_layout, files, nodes);
  std::size_t row = 0; // ranks that share a node have written equal boxes: the first counts
  for (const global_id node : nodes) {
    if (row == boxes.ids.size() || boxes.ids[row] != node)
      break;
    for (int i = 0; i < 6; ++i)
      data.swept_boxes.push_back(io::realOf(boxes.row(row)[i]));
    while (row < boxes.ids.size() && boxes.ids[row] == node)
      ++row;
  }
  if (data.swept_boxes.size() != 6 * nodes.size())
    data.swept_boxes.clear();
}

bool hasForces(const std::vector<std::vector<io::Table>>& files) {
  for (const auto& tables : files)
    for (const io::Table& table : tables)
      for (const io::Column& column : table.columns)
        if (table.name == "nodes" && column.name == "forces")
          return true;
  return false;
}

} // namespace

std::vector<io::Table> tablesOf(const RunRestart& data, const Simulation& simulation) {
  std::vector<io::Table> tables;
  if (rankOf(simulation.comm()) == 0) {
    tables.push_back({shared_table, {}});
    visitShared(data, ToColumns{tables.back().columns});
  }
  const SimulationRestart& of = data.simulation;
  tables.push_back(toTable(nodeLayout(simulation, !of.forces.empty()), nodeRows(of, simulation)));
  if (const ContactStep* contact = simulation.contact()) {
    tables.push_back(toTable(contactLayout(node_contacts), contactRows(of.contact.nodes)));
    tables.push_back(toTable(contactLayout(edge_contacts), contactRows(of.contact.edges)));
    io::RowsById boxes{surfaceNodes(*contact, false), box_layout.width(), {}};
    for (const double value : of.contact.swept_boxes)
      boxes.words.push_back(io::wordOf(value));
    if (boxes.words.empty())
      boxes.ids.clear();
    tables.push_back(toTable(box_layout, boxes));
  }
  return tables;
}

RunRestart fromTables(const std::vector<std::vector<io::Table>>& files,
                      const Simulation& simulation) {
  const MPI_Comm comm = simulation.comm();
  io::Table shared;
  rethrowOnAllRanks(comm, [&] {
    if (rankOf(comm) == 0)
      shared = sharedTableOf(files);
  });
  shared = broadcast(comm, shared);
  RunRestart data;
  visitShared(data, FromColumns{shared});
  const bool has_forces = allReduce(comm, hasForces(files) ? 1 : 0, MPI_MAX) != 0;
  const auto& ids = simulation.scene().part.node_ids;
  const io::RowsById nodes = takeRows(comm, nodeLayout(simulation, has_forces), files, ids);
  rethrowOnAllRanks(comm, [&] { takeNodes(nodes, ids, data.simulation); });
  if (const ContactStep* contact = simulation.contact())
    takeContact(comm, files, *contact, data.simulation.contact);
  return data;
}

} // namespace brickwall::miniapp
