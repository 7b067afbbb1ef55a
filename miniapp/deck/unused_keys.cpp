#include "miniapp/deck/unused_keys.hpp"

namespace brickwall::miniapp {

namespace {

template <class Entries>
void warnOfReplaced(const Entries& entries, const std::string& block, io::Deck& deck) {
  for (std::size_t later = 1; later < entries.size(); ++later)
    if (entries[later].isOfAll()) {
      for (std::size_t i = 0; i < later; ++i)
        deck.warn(block + "[" + std::to_string(i) + "]", "",
                  "has no effect: " + deck.placeOf(block + "[" + std::to_string(later) + "]") +
                      " sets all bodies anew");
      return;
    }
}

} // namespace

void warnOfUnusedKeys(const Config& config, io::Deck& deck) {
  const ContactConfig& contact = config.contact;
  if (contact.friction == 0 && contact.friction_stiffness != ContactConfig().friction_stiffness)
    deck.warn("contact", "friction_stiffness", "has no effect: contact.friction is 0");
  const PartitionConfig& partition = config.partition;
  if (partition.rebalance == Rebalance::never && partition.interval != PartitionConfig().interval)
    deck.warn("partition", "interval", "has no effect: partition.rebalance is \"never\"");
  warnOfReplaced(config.initial_velocities, "initial.velocity", deck);
  warnOfReplaced(config.initial_deformations, "initial.deformation", deck);
}

} // namespace brickwall::miniapp
