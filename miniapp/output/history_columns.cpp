// A new column is one line of the table here and one line of the table in miniapp/output.md.
#include "miniapp/output/history_columns.hpp"

#include "miniapp/simulation/diagnostics.hpp"

namespace brickwall::miniapp {

namespace {

// The quantities from which columns are computed.
struct Snapshot {
  const Clock& clock;
  const mechanics::EnergyBalance& balance;
  ContactCounts counts; // over all ranks
};

// One column, or three for a vector: name_x, name_y, name_z.
struct Column {
  const char* name;
  bool (*is_used)(const Config&);
  double (*number)(const Snapshot&);
  Vec3 (*vector)(const Snapshot&) = nullptr; // instead of `number`
};

bool always(const Config&) {
  return true;
}

Column number(const char* name, double (*value)(const Snapshot&),
              bool (*is_used)(const Config&) = always) {
  return {name, is_used, value};
}
Column vector(const char* name, Vec3 (*value)(const Snapshot&),
              bool (*is_used)(const Config&) = always) {
  return {name, is_used, nullptr, value};
}

bool hasViscosity(const Config& config) {
  return config.viscosity.any();
}
bool hasContact(const Config& config) {
  return config.contact.enabled;
}
bool hasFriction(const Config& config) {
  return config.contact.enabled && config.contact.friction > 0;
}
bool hasContactDamping(const Config& config) {
  return dampsContacts(config.contact);
}
bool hasEdges(const Config& config) {
  return config.contact.enabled && config.contact.edges;
}
bool isAudited(const Config& config) {
  return config.contact.enabled && config.search.audit > 0;
}
bool hasDamping(const Config& config) {
  return config.mass_damping > 0;
}

const std::vector<Column>& columns() {
  using mechanics::contact_force;
  using mechanics::external_force;
  using mechanics::internal_force;
  using mechanics::viscous_force;
  static const std::vector<Column> all = {
      number("timestep", [](const Snapshot& s) { return s.clock.dt; }),
      number("kinetic_energy", [](const Snapshot& s) { return s.balance.kinetic; }),
      number(
          "internal_energy",
          [](const Snapshot& s) { return s.balance.stored_material + s.balance.stored_hourglass; }),
      number("hourglass_energy", [](const Snapshot& s) { return s.balance.stored_hourglass; }),
      number("contact_energy", [](const Snapshot& s) { return s.balance.stored_contact; }),
      number(
          "friction_energy", [](const Snapshot& s) { return s.balance.stored_friction; },
          hasFriction),
      number(
          "edge_energy", [](const Snapshot& s) { return s.balance.stored_edge; }, hasEdges),
      number("dissipated_energy", [](const Snapshot& s) { return s.balance.dissipated.total(); }),
      number("total_energy", [](const Snapshot& s) { return s.balance.total_half; }),
      number("external_work", [](const Snapshot& s) { return s.balance.external_work; }),
      number("internal_work",
             [](const Snapshot& s) {
               return s.balance.work[internal_force] - s.balance.work_hourglass;
             }),
      number("hourglass_work", [](const Snapshot& s) { return s.balance.work_hourglass; }),
      number("contact_work", [](const Snapshot& s) { return s.balance.work[contact_force]; }),
      number(
          "friction_work",
          [](const Snapshot& s) {
            return -s.balance.stored_friction - s.balance.dissipated.friction;
          },
          hasFriction),
      number(
          "contact_damping_work",
          [](const Snapshot& s) { return -s.balance.dissipated.contact_damping; },
          hasContactDamping),
      number(
          "edge_work", [](const Snapshot& s) { return s.balance.work_edge; }, hasEdges),
      number("load_work", [](const Snapshot& s) { return s.balance.work[external_force]; }),
      number("gravity_work", [](const Snapshot& s) { return s.balance.work_gravity; }),
      number("reaction_work", [](const Snapshot& s) { return s.balance.work_reaction; }),
      number(
          "viscosity_work", [](const Snapshot& s) { return s.balance.work[viscous_force]; },
          hasViscosity),
      number(
          "damping_work", [](const Snapshot& s) { return s.balance.work_damping; }, hasDamping),
      number("energy_error", [](const Snapshot& s) { return s.balance.energy_error; }),
      number("momentum_error", [](const Snapshot& s) { return s.balance.momentum_error; }),
      number("angular_momentum_error",
             [](const Snapshot& s) { return s.balance.angular_momentum_error; }),
      number("stored_error", [](const Snapshot& s) { return s.balance.stored_error; }),
      number(
          "contact_error", [](const Snapshot& s) { return s.balance.contact_error; }, hasContact),
      number("shadow_energy", [](const Snapshot& s) { return s.balance.shadow; }),
      number("ledger_residual", [](const Snapshot& s) { return s.balance.ledger_residual; }),
      vector("momentum", [](const Snapshot& s) { return s.balance.momentum; }),
      vector("angular_momentum", [](const Snapshot& s) { return s.balance.angular_momentum; }),
      vector("impulse_load", [](const Snapshot& s) { return s.balance.impulse_external; }),
      vector("impulse_gravity", [](const Snapshot& s) { return s.balance.impulse_gravity; }),
      vector("impulse_reaction", [](const Snapshot& s) { return s.balance.impulse_reaction; }),
      vector(
          "impulse_damping", [](const Snapshot& s) { return s.balance.impulse_damping; },
          hasDamping),
      number("contacts", [](const Snapshot& s) { return static_cast<double>(s.counts.active); }),
      number("lost_contacts", [](const Snapshot& s) { return static_cast<double>(s.counts.lost); }),
      number(
          "missed_pairs",
          [](const Snapshot& s) { return static_cast<double>(s.counts.missed_pairs); }, isAudited),
      number("max_penetration", [](const Snapshot& s) { return s.counts.max_penetration; }),
      number("searches", [](const Snapshot& s) { return static_cast<double>(s.counts.searches); }),
  };
  return all;
}

} // namespace

std::vector<std::string> globalNames(const Config& config) {
  std::vector<std::string> names;
  for (const Column& column : columns()) {
    if (!column.is_used(config))
      continue;
    const std::string name = column.name;
    if (column.vector)
      names.insert(names.end(), {name + "_x", name + "_y", name + "_z"});
    else
      names.push_back(name);
  }
  return names;
}

std::vector<double> globalValues(const Simulation& simulation) {
  const Snapshot snapshot{simulation.clock(), simulation.balance(), contactCounts(simulation)};
  std::vector<double> values;
  for (const Column& column : columns()) {
    if (!column.is_used(simulation.config()))
      continue;
    if (column.vector) {
      const Vec3 v = column.vector(snapshot);
      values.insert(values.end(), {v.x, v.y, v.z});
    } else {
      values.push_back(column.number(snapshot));
    }
  }
  return values;
}

} // namespace brickwall::miniapp
