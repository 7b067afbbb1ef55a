#include "miniapp/restart/entity_tables.hpp"

#include "contact/base/mpi.hpp"
#include "contact/base/to_device.hpp"
#include "io/mesh/rows_by_id.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace brickwall::miniapp {

namespace {

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
  if (ids.width != 1 || ids.is_real)
    throw InputError("the checkpoint is of another build: the ids of " + layout.name +
                     " have another type");
  std::vector<const io::Column*> columns;
  for (const ColumnLayout& of : layout.columns) {
    columns.push_back(&table.column(of.name));
    if (columns.back()->width != of.width || columns.back()->is_real != of.is_real)
      throw InputError("the checkpoint is of another build: " + layout.name + "_" + of.name +
                       " has another type");
    for (const std::int64_t word : columns.back()->words)
      if (of.is_real && !std::isfinite(io::realOf(word)))
        throw InputError("the checkpoint has a value of " + layout.name + "_" + of.name +
                         " that is not finite");
  }
  rows.ids.insert(rows.ids.end(), ids.words.begin(), ids.words.end());
  for (std::size_t i = 0; i < ids.words.size(); ++i)
    for (const io::Column* column : columns) {
      const auto begin = column->words.begin() + static_cast<std::ptrdiff_t>(i) * column->width;
      rows.words.insert(rows.words.end(), begin, begin + column->width);
    }
}

// The rows of all files, each of which has the table, for the ids `wanted` of this rank.
// Collective.
io::RowsById takeRows(MPI_Comm comm, const TableLayout& layout, const TableFiles& files,
                      const std::vector<global_id>& wanted) {
  io::RowsById held;
  held.width = layout.width();
  rethrowOnAllRanks(comm, [&] {
    for (const auto& tables : files) {
      const auto table = std::find_if(tables.begin(), tables.end(),
                                      [&](const auto& one) { return one.name == layout.name; });
      if (table == tables.end())
        throw InputError("the checkpoint lacks the table " + layout.name);
      appendRows(layout, *table, held);
    }
  });
  io::RowsById found = io::fetchRows(comm, held, wanted);
  // A row of an entity that several ranks have is found several times.
  const auto count = [](const io::RowsById& rows) {
    return static_cast<std::int64_t>(rows.ids.size());
  };
  if (allReduce(comm, count(held) - count(found), MPI_SUM) > 0)
    throw InputError("the checkpoint has rows of " + layout.name + " that the mesh lacks");
  return found;
}

bool hasSlip(const Simulation& simulation) {
  return simulation.contact() && simulation.config().output.has(OutputField::slip_distance);
}

TableLayout nodeLayout(const Simulation& simulation, bool has_forces) {
  TableLayout layout{"nodes", {{"displacement", true, 3}, {"velocity", true, 3}}};
  if (hasSlip(simulation))
    layout.columns.push_back({"slip", true, 1});
  if (has_forces)
    layout.columns.push_back(
        {"forces", false, mechanics::numForceColumns(simulation.config().viscosity.any())});
  return layout;
}

const TableLayout joint_layout{"joint_contacts", {{"side", false, 1}, {"area", true, 1}}};
const TableLayout box_layout{"swept_boxes", {{"box", true, 6}}};

io::RowsById nodeRows(const SimulationRestart& data, const Simulation& simulation) {
  const auto& ids = simulation.scene().part.node_ids;
  const auto& is_owned = simulation.scene().node_is_owned;
  io::RowsById rows;
  rows.width = nodeLayout(simulation, data.keeps_forces).width();
  const std::size_t num_forces = ids.empty() ? 0 : data.forces.size() / ids.size();
  for (std::size_t node = 0; node < ids.size(); ++node) {
    if (!is_owned[node])
      continue;
    rows.ids.push_back(ids[node]);
    for (const auto* field : {&data.displacement, &data.velocity})
      for (std::size_t d = 0; d < 3; ++d)
        rows.words.push_back(io::wordOf((*field)[3 * node + d]));
    if (hasSlip(simulation))
      rows.words.push_back(data.slip[node]);
    for (std::size_t i = 0; i < num_forces; ++i)
      rows.words.push_back(data.forces[num_forces * node + i]);
  }
  return rows;
}

void takeNodes(const io::RowsById& rows, const std::vector<global_id>& wanted, bool has_slip,
               SimulationRestart& data) {
  if (rows.ids != wanted)
    throw InputError("the checkpoint lacks a node of the mesh");
  for (auto* values : {&data.displacement, &data.velocity})
    values->clear();
  for (auto* words : {&data.forces, &data.slip})
    words->clear();
  for (std::size_t node = 0; node < wanted.size(); ++node) {
    const std::int64_t* words = rows.row(node);
    for (std::size_t d = 0; d < 3; ++d) {
      data.displacement.push_back(io::realOf(words[d]));
      data.velocity.push_back(io::realOf(words[3 + d]));
    }
    if (has_slip)
      data.slip.push_back(words[6]);
    data.forces.insert(data.forces.end(), words + (has_slip ? 7 : 6), words + rows.width);
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
  void operator()(const char* name, const bool&) const { columns.push_back({name, false, 1}); }
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
  void operator()(const char*, const bool& value) const { words.push_back(value); }
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
  void operator()(const char*, bool& value) const { value = *next++ != 0; }
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
// The contacts of this rank's `ids`, one with each side. Collective.
std::vector<contact::ContactRecord> takeRecords(MPI_Comm comm, const std::string& name,
                                                const TableFiles& files,
                                                const std::vector<global_id>& ids) {
  const io::RowsById rows = takeRows(comm, contactLayout(name), files, ids);
  std::vector<contact::ContactRecord> records(rows.ids.size());
  rethrowOnAllRanks(comm, [&] {
    std::set<std::pair<global_id, global_id>> pairs;
    for (std::size_t i = 0; i < records.size(); ++i) {
      const std::int64_t* next = rows.row(i);
      contact::visitFields(records[i], FieldFromWords{next});
      if (records[i].node != rows.ids[i] ||
          !pairs.emplace(records[i].node, records[i].pair.side).second)
        throw InputError("the checkpoint has a contact of " + name + " twice, or of another id");
    }
  });
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
  auto all = listOf(surface.node_ids, static_cast<std::size_t>(surface.num_nodes));
  if (!only_owned)
    return all;
  const auto is_owned = toHost(surface.node_is_owned);
  std::vector<global_id> owned;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (is_owned(i))
      owned.push_back(all[i]);
  return owned;
}

void takeContact(MPI_Comm comm, const TableFiles& files, const ContactStep& contact,
                 ContactRestart& data) {
  data.nodes = takeRecords(comm, node_contacts, files, surfaceNodes(contact, true));
  const io::RowsById joints = takeRows(comm, joint_layout, files, surfaceNodes(contact, true));
  data.joints.clear();
  for (std::size_t i = 0; i < joints.ids.size(); ++i)
    data.joints.push_back({joints.ids[i], joints.row(i)[0], io::realOf(joints.row(i)[1])});
  const contact::EdgeContact* edges = contact.edges();
  // Ids of corners in the list are those of nodes, which no edge has.
  const auto edge_ids =
      edges ? listOf(edges->nodeIds(), edges->nodeIds().extent(0)) : std::vector<global_id>();
  data.edges = takeRecords(comm, edge_contacts, files, edge_ids);
  const auto nodes = surfaceNodes(contact, false);
  const io::RowsById boxes = takeRows(comm, box_layout, files, nodes);
  data.swept_boxes.clear();
  std::size_t row = 0; // ranks that share a node have written equal boxes: the first counts
  for (const global_id node : nodes) {
    if (row == boxes.ids.size() || boxes.ids[row] != node)
      break;
    for (int i = 0; i < 6; ++i)
      data.swept_boxes.push_back(io::realOf(boxes.row(row)[i]));
    while (row < boxes.ids.size() && boxes.ids[row] == node)
      ++row;
  }
  const bool lacks_boxes = data.swept_boxes.size() != 6 * nodes.size();
  if (allReduce(comm, std::int64_t(boxes.ids.size()), MPI_SUM) > 0 &&
      allReduce(comm, std::int64_t(lacks_boxes), MPI_SUM) > 0)
    throw InputError("the checkpoint lacks the box of a node");
}

} // namespace

std::vector<io::Table> entityTables(const SimulationRestart& data, const Simulation& simulation) {
  std::vector<io::Table> tables = {
      toTable(nodeLayout(simulation, data.keeps_forces), nodeRows(data, simulation))};
  const ContactStep* contact = simulation.contact();
  if (!contact)
    return tables;
  tables.push_back(toTable(contactLayout(node_contacts), contactRows(data.contact.nodes)));
  tables.push_back(toTable(contactLayout(edge_contacts), contactRows(data.contact.edges)));
  io::RowsById joints{{}, joint_layout.width(), {}};
  for (const contact::JointRecord& record : data.contact.joints) {
    joints.ids.push_back(record.node);
    joints.words.insert(joints.words.end(), {record.side, io::wordOf(record.area)});
  }
  tables.push_back(toTable(joint_layout, joints));
  io::RowsById boxes{surfaceNodes(*contact, false), box_layout.width(), {}};
  for (const double value : data.contact.swept_boxes)
    boxes.words.push_back(io::wordOf(value));
  if (boxes.words.empty())
    boxes.ids.clear();
  tables.push_back(toTable(box_layout, boxes));
  return tables;
}

void takeEntities(const TableFiles& files, const Simulation& simulation, SimulationRestart& data) {
  const MPI_Comm comm = simulation.comm();
  const auto& ids = simulation.scene().part.node_ids;
  const io::RowsById nodes = takeRows(comm, nodeLayout(simulation, data.keeps_forces), files, ids);
  rethrowOnAllRanks(comm, [&] { takeNodes(nodes, ids, hasSlip(simulation), data); });
  if (const ContactStep* contact = simulation.contact())
    takeContact(comm, files, *contact, data.contact);
}

} // namespace brickwall::miniapp
