#include "miniapp/output/skipped_work.hpp"

#include "miniapp/deck/search_choice.hpp"

#include <iterator>

namespace brickwall::miniapp {

namespace {

double shareOf(std::int64_t part, double whole) {
  return whole > 0 ? static_cast<double>(part) / whole : 0;
}

// Terms of the ledger and columns of history that the scene's physics has no use for.
double shareOfAbsentTerms(const Config& config) {
  const ContactConfig& contact = config.contact;
  const bool there[] = {config.gravity != Triple{0, 0, 0},
                        config.viscosity.any(),
                        config.mass_damping > 0,
                        !config.pressures.empty(),
                        contact.enabled,
                        contact.enabled && contact.edges,
                        contact.enabled && contact.friction > 0,
                        contact.enabled && contact.damping > 0};
  int absent = 0;
  for (const bool is_there : there)
    absent += !is_there;
  return absent / static_cast<double>(std::size(there));
}

} // namespace

std::vector<SparedReport> sparedParts(const Config& config, const Simulation& simulation,
                                      const ContactCounts& counts, std::int64_t num_elems) {
  const double elems = static_cast<double>(num_elems);
  const std::int64_t steps = simulation.clock().step + 1; // the start evaluates forces too
  const SpecialElements special = specialElements(simulation);
  std::vector<SparedReport> parts = {
      {"element geometry", shareOf(special.congruent, elems),
       "of the elements are copies within their brick and store none (370 B each if one-point)",
       ""},
      {"connectivity", shareOf(special.in_lattices, elems),
       "of the elements are swept plane by plane without it", "spare.lattices"},
      {"ledger terms", shareOfAbsentTerms(config), "of the kinds of energy and work are absent",
       ""},
      {"steps", 1 - 1 / simulation.steps().gain().step,
       "of the steps of the worst element's bound are not taken (Lanczos)", "time.bound"},
  };
  if (!config.contact.enabled) {
    parts.push_back({"forces kept", shareOf(special.free, elems),
                     "of the elements are of bricks that drift, deform and are kicked in one sweep",
                     "spare.free_bricks"});
    return parts;
  }
  parts.push_back({"elements at rest",
                   special.skipped_steps > 0
                       ? shareOf(special.skipped_steps, elems * static_cast<double>(steps))
                       : shareOf(special.resting, elems),
                   special.skipped_steps > 0
                       ? "of the element-steps were of bodies that nothing had moved yet"
                       : "of the elements rest at the start, until something moves them",
                   "spare.resting_bodies"});
  parts.push_back({"contact of a body with itself", dropsSameBody(config) ? 1.0 : 0.0,
                   "of the bodies cannot touch themselves", "contact.self"});
  parts.push_back({"memory of friction", config.contact.friction > 0 ? 0.0 : 1.0,
                   "of the contacts have none (contact.friction = 0)", "contact.friction"});
  parts.push_back({"searches",
                   counts.updates > 0 ? 1 - shareOf(counts.searches, counts.updates) : 0,
                   "of the steps keep their lists", "search.reuse.margin"});
  return parts;
}

} // namespace brickwall::miniapp
