#include "contact/enforcement/law/check_enforcement_input.hpp"

#include "contact/base/same_on_all_ranks.hpp"
#include "contact/base/to_device.hpp"
#include "contact/surface/check_surface.hpp"

#include <cfloat>
#include <climits>
#include <cmath>

namespace brickwall::contact {
namespace {

struct Range {
  double least, most; // NaN is in none
  const char* text;
};

constexpr Range positive{DBL_TRUE_MIN, DBL_MAX, "a finite number above 0"};
constexpr Range not_negative{0, DBL_MAX, "a finite number, 0 or more"};
constexpr Range depth{0, HUGE_VAL, "0 or more"};
constexpr Range cosine{-1, 1, "a number from -1 to 1"};
constexpr Range rounds{1, INT_MAX, "1 or more"};
constexpr Range flag{0, 1, "0 or 1"};

struct Parameter {
  const char* name;
  double value;
  Range range;
};

void requireRoomForEdgeIds(const View<const global_id*>& ids, const std::string& name) {
  const auto host_ids = toHost(ids);
  for (std::size_t row = 0; row < host_ids.extent(0); ++row)
    if (host_ids(row) >= first_edge_id)
      throw InputError(name + "(" + std::to_string(row) + ") = " + std::to_string(host_ids(row)) +
                       "; expected less than 2^60");
}

// Collective.
void checkParameters(MPI_Comm comm, const std::string& function, Scheme scheme,
                     const std::vector<Parameter>& parameters) {
  std::vector<NamedValue> values = {
      {"scheme", std::string(scheme == Scheme::penalty ? "penalty" : "energy_neutral")}};
  for (const Parameter& p : parameters)
    values.emplace_back(p.name, p.value);
  requireSame(comm, function, values);
  for (const Parameter& p : parameters)
    if (!(p.value >= p.range.least && p.value <= p.range.most))
      throw InputError(function + ": " + p.name + " is " + NamedValue(p.name, p.value).text +
                       "; expected " + p.range.text);
}

} // namespace

void checkEnforcementInput(const exec_space& space, MPI_Comm comm, const std::string& function,
                           const Surface& surface, const View<const double*>& node_mass,
                           const EnforcementConfig& config, const Quantum& quantum,
                           const LimbScale& energy_scale) {
  checkParameters(comm, function, config.scheme,
                  {{"penalty", config.penalty, positive},
                   {"reference_step", config.reference_step, positive},
                   {"lateral_tolerance", config.lateral_tolerance, not_negative},
                   {"edge_tolerance", config.edge_tolerance, not_negative},
                   {"friction", config.friction, not_negative},
                   {"friction_stiffness", config.friction_stiffness, not_negative},
                   {"damping", config.damping, not_negative},
                   {"least_depth", config.least_depth, not_negative},
                   {"max_activation_depth", config.max_activation_depth, depth},
                   {"opposed_cosine", config.opposed_cosine, cosine},
                   {"shared_cosine", config.shared_cosine, cosine},
                   {"self_contact", double(config.self_contact), flag},
                   {"skip_stationary", double(config.skip_stationary), flag},
                   {"corrections", double(config.corrections), rounds},
                   {"quantum", quantum.value, positive},
                   {"energy_scale", energy_scale.high_quantum, positive}});
  checkSurface(space, comm, function, surface);
  const auto num_masses = static_cast<int>(node_mass.extent(0));
  const auto num_words = static_cast<int>(surface.face_attributes.extent(1));
  rethrowOnAllRanks(comm, [&] {
    const std::string where = function + ": rank " + std::to_string(rankOf(comm)) + " has ";
    if (num_masses < surface.num_nodes)
      throw InputError(where + std::to_string(num_masses) + " rows of node_mass; expected " +
                       std::to_string(surface.num_nodes));
    if (surface.num_faces > 0 && num_words != words_of<FaceAttributes>)
      throw InputError(where + std::to_string(num_words) +
                       " words of attributes per face; expected those of FaceAttributes, " +
                       std::to_string(words_of<FaceAttributes>));
    requireRoomForEdgeIds(surface.node_ids, where + "node_ids");
    requireRoomForEdgeIds(surface.face_ids, where + "face_ids");
  });
}

} // namespace brickwall::contact
