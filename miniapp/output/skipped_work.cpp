#include "miniapp/output/skipped_work.hpp"

#include <iterator>

namespace brickwall::miniapp {

namespace {

double shareOf(std::int64_t part, double whole) {
  return whole > 0 ? static_cast<double>(part) / whole : 0;
}

// Share of the terms of the ledger (and their columns of history.csv) that the scene does not have.
double shareOfAbsentTerms(const Config& config) {
  const ContactConfig& contact = config.contact;
  const bool present[] = {config.gravity != Triple{0, 0, 0},
                          config.viscosity.any(),
                          config.mass_damping > 0,
                          !config.pressures.empty(),
                          contact.enabled,
                          contact.enabled && contact.edges,
                          contact.enabled && contact.friction > 0,
                          dampsContacts(contact)};
  int absent = 0;
  for (const bool is_present : present)
    absent += !is_present;
  return absent / static_cast<double>(std::size(present));
}

} // namespace

std::vector<SkippedPart> skippedWork(const Config& config, const Simulation& simulation,
                                     const ContactCounts& counts, std::int64_t num_elems) {
  const double elems = static_cast<double>(num_elems);
  const std::int64_t steps = simulation.clock().step + 1; // forces are also evaluated at the start
  const SpecialElements special = specialElements(simulation);
  std::vector<SkippedPart> parts = {
      {"element geometry", shareOf(special.congruent, elems),
       "of the elements are copies within their brick, and store none (370 B per one-point "
       "element)",
       ""},
      {"connectivity", shareOf(special.in_lattices, elems),
       "of the elements are computed plane by plane without it", "skip.lattices"},
      {"ledger terms", shareOfAbsentTerms(config), "of the kinds of energy and work do not occur",
       ""},
      {"steps", 1 - 1 / simulation.steps().gain().step,
       "of those that the stability of the worst element would require (Lanczos)", "time.bound"},
  };
  if (!config.contact.enabled) {
    parts.push_back({"force storage", shareOf(special.free, elems),
                     "of the elements are in bricks that drift, deform and are kicked in one sweep",
                     "skip.free_bricks"});
    return parts;
  }
  parts.push_back({"elements at rest",
                   special.skipped_steps > 0
                       ? shareOf(special.skipped_steps, elems * static_cast<double>(steps))
                       : shareOf(special.resting, elems),
                   special.skipped_steps > 0
                       ? "of the element-steps belong to bodies that had not yet been moved"
                       : "of the elements are at rest at the start, until something moves them",
                   "skip.resting_bodies"});
  parts.push_back({"contact of a body with itself", dropsSameBody(config) ? 1.0 : 0.0,
                   "of the bodies cannot touch themselves", "contact.self"});
  parts.push_back({"friction history", config.contact.friction > 0 ? 0.0 : 1.0,
                   "of the contacts store none, as contact.friction is 0", "contact.friction"});
  parts.push_back({"searches",
                   counts.updates > 0 ? 1 - shareOf(counts.searches, counts.updates) : 0,
                   "of the steps keep the lists of an earlier one", "search.reuse.margin"});
  return parts;
}

} // namespace brickwall::miniapp
