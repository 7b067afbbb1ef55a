#include "contact/enforcement/reports/history_checksum.hpp"

#include "contact/base/hash.hpp"

namespace brickwall::contact {

namespace {

struct HashInteraction {
  View<const global_id*> node_ids;
  ContactHistory history;
  bool has_friction;

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t i, std::uint64_t& sum) const {
    const Interaction& pair = history.interactions(i);
    Hash hash;
    hash.take(node_ids(pair.node));
    hash.take(pair.side);
    hash.take(pair.face);
    hash.take(pair.offset);
    hash.take(pair.depth);
    hash.take(pair.stiffness);
    hash.take(pair.fade_weight);
    hash.take(pair.stored);
    hash.take(pair.force);
    hash.take(pair.damping);
    hash.take(pair.closing);
    hash.take(pair.normal);
    hash.take(pair.is_retained);
    hash.take(static_cast<int>(pair.is_new));
    hash.take(static_cast<int>(pair.settles));
    hash.take(pair.point.share);
    hash.take(pair.first_force);
    for (const double weight : pair.weight)
      hash.take(weight);
    if (has_friction) {
      const FrictionSpring& spring = history.friction(i);
      hash.take(spring.force);
      hash.take(spring.motion);
      hash.take(spring.stiffness);
      hash.take(spring.lever[0]);
      hash.take(spring.lever[1]);
    }
    if (pair.fade_weight < 1) {
      const FadingForce& fading = history.fading(i);
      hash.take(fading.on_node);
      hash.take(fading.normal.on_end);
      for (const double force : fading.normal.on_corner)
        hash.take(force);
      hash.take(fading.work);
      hash.take(fading.factor);
    }
    sum += hash.value();
  }
};

} // namespace

std::uint64_t historyChecksum(const exec_space& space, const View<const global_id*>& node_ids,
                              const ContactHistory& history) {
  std::uint64_t sum = 0;
  Kokkos::parallel_reduce("contact::historyChecksum", rangePolicy(space, history.count),
                          HashInteraction{node_ids, history, history.friction.size() > 0},
                          Kokkos::Sum<std::uint64_t>(sum));
  return sum;
}

} // namespace brickwall::contact
