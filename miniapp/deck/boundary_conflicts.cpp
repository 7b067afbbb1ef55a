#include "miniapp/deck/boundary_conflicts.hpp"

#include <tuple>

namespace brickwall::miniapp {

namespace {

bool isSamePulse(const PulseConfig& a, const PulseConfig& b) {
  return std::tie(a.shape, a.start, a.duration, a.decay) ==
         std::tie(b.shape, b.start, b.duration, b.decay);
}

bool differ(const PrescribedVelocityConfig& a, const PrescribedVelocityConfig& b,
            std::size_t component) {
  if (!a.components[component] || !b.components[component])
    return false;
  if (a.velocity[component] != b.velocity[component])
    return true;
  return a.velocity[component] != 0 && !isSamePulse(a.pulse, b.pulse);
}

} // namespace

std::vector<Boundary> boundariesOf(const Config& config) {
  std::vector<Boundary> all;
  for (const FixedConfig& fixed : config.fixed)
    all.push_back({"boundary.fixed[" + std::to_string(all.size()) + "]",
                   {fixed.node_set, {0, 0, 0}, fixed.components, {}, fixed.place}});
  for (std::size_t i = 0; i < config.prescribed.size(); ++i)
    all.push_back({"boundary.velocity[" + std::to_string(i) + "]", config.prescribed[i]});
  return all;
}

std::string differingComponents(const PrescribedVelocityConfig& a,
                                const PrescribedVelocityConfig& b) {
  std::string components;
  for (std::size_t d = 0; d < 3; ++d)
    if (differ(a, b, d))
      components += (components.empty() ? "" : ", ") + std::string(1, "xyz"[d]);
  return components;
}

void complainOfConflicts(const Config& config, io::Deck& deck) {
  const std::vector<Boundary> all = boundariesOf(config);
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const auto &one = all[j].motion, &other = all[i].motion;
      // An entry without a node set has a fault already.
      if (one.node_set != other.node_set || one.node_set.empty())
        continue;
      const std::string components = differingComponents(one, other);
      if (!components.empty())
        deck.complain(all[i].block, "",
                      "another motion of " + components + " of node set \"" + other.node_set +
                          "\" than in " + deck.placeOf(all[j].block),
                      "one motion of each component");
    }
}

} // namespace brickwall::miniapp
