#include "contact/enforcement/law/check_enforcement_input.hpp"

#include "contact/base/same_on_all_ranks.hpp"
#include "contact/surface/check_surface.hpp"

namespace brickwall::contact {

void checkEnforcementInput(const exec_space& space, MPI_Comm comm, const std::string& function,
                           const Surface& surface, const View<const double*>& node_mass,
                           const EnforcementConfig& config, const Quantum& quantum,
                           const LimbScale& energy_scale) {
  const auto number = [](auto value) { return static_cast<double>(value); };
  const bool is_penalty = config.scheme == Scheme::penalty;
  requireSame(comm, function,
              {{"scheme", std::string(is_penalty ? "penalty" : "energy_neutral")},
               {"penalty", config.penalty},
               {"reference_step", config.reference_step},
               {"lateral_tolerance", config.lateral_tolerance},
               {"edge_tolerance", config.edge_tolerance},
               {"friction", config.friction},
               {"friction_stiffness", config.friction_stiffness},
               {"damping", config.damping},
               {"least_depth", config.least_depth},
               {"max_activation_depth", config.max_activation_depth},
               {"opposed_cosine", config.opposed_cosine},
               {"shared_cosine", config.shared_cosine},
               {"self_contact", number(config.self_contact)},
               {"skip_stationary", number(config.skip_stationary)},
               {"corrections", number(config.corrections)},
               {"relaxation", config.relaxation},
               {"quantum", quantum.value},
               {"energy_scale", energy_scale.high_quantum}});
  if (!(config.reference_step > 0) || !(config.penalty > 0))
    throw InputError(function + ": reference_step is " + std::to_string(config.reference_step) +
                     ", penalty " + std::to_string(config.penalty) + "; expected positive numbers");
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
  });
}

} // namespace brickwall::contact
