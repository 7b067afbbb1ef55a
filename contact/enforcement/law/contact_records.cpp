#include "contact/enforcement/law/contact_records.hpp"

#include "contact/base/error.hpp"
#include "contact/enforcement/law/contact_law.hpp"
#include "contact/surface/row_of_id.hpp"

#include <algorithm>
#include <numeric>
#include <string>

namespace brickwall::contact {

std::vector<ContactRecord> recordsOf(const exec_space& space,
                                     const View<const global_id*>& node_ids,
                                     const ContactHistory& history, const LastContacts& last) {
  space.fence();
  const auto ids = toHost(node_ids);
  const auto interactions = history.interactions.toHost(history.count);
  const auto friction = history.friction.toHost(history.count);
  const auto fading = history.fading.toHost(history.count);
  std::vector<ContactRecord> records(static_cast<std::size_t>(history.count));
  for (std::int64_t i = 0; i < history.count; ++i) {
    ContactRecord& record = records[static_cast<std::size_t>(i)];
    record.pair = interactions(i);
    record.node = ids(record.pair.node);
    if (friction.extent(0) > 0)
      record.friction = friction(i);
    if (record.pair.fade_weight < 1)
      record.fading = fading(i);
  }
  const auto row_count = toHost(history.row_count), last_step = toHost(last.step);
  for (std::size_t row = 0; row < last_step.extent(0); ++row) {
    ContactRecord record;
    record.node = ids(row);
    record.steps_since = last.num_steps + 1 - last_step(row);
    if (row_count(row) == 0 && last_step(row) > 0 &&
        record.steps_since <= ContactLaw::settling_steps)
      records.push_back(record);
  }
  return records;
}

namespace {

// The contacts among `records`, with rows of this surface. Sets the last steps of nodes without
// contact.
std::vector<ContactRecord> contactsOf(const View<const global_id*>& node_ids,
                                      const std::vector<ContactRecord>& records,
                                      const std::function<ContactPoint(int row)>& pointOf,
                                      LastContacts& last) {
  const RowOfId row_of(node_ids);
  int row = 0;
  const auto last_step = Kokkos::create_mirror_view(last.step);
  Kokkos::deep_copy(last_step, 0);
  last.num_steps = ContactLaw::settling_steps;
  std::vector<ContactRecord> active;
  for (const ContactRecord& record : records) {
    row = row_of.findNear(row, record.node);
    if (row == RowOfId::none)
      throw Error(ExitCode::internal, "setHistory: found a record of node " +
                                          std::to_string(record.node) +
                                          ", which is not on the surface of this rank");
    if (record.steps_since > 0) {
      if (last_step.extent(0) > 0) // otherwise nothing has friction
        last_step(static_cast<std::size_t>(row)) = last.num_steps + 1 - record.steps_since;
      continue;
    }
    active.push_back(record);
    Interaction& pair = active.back().pair;
    pair.node = row;
    pair.face_index = -1;
    const double share = pair.point.share;
    pair.point = pointOf(pair.node);
    pair.point.share = share;
  }
  Kokkos::deep_copy(last.step, last_step);
  return active;
}

} // namespace

void setHistory(const exec_space& space, const View<const global_id*>& node_ids,
                const std::vector<ContactRecord>& records, bool has_friction,
                const std::function<ContactPoint(int row)>& pointOf, ContactHistory& history,
                LastContacts& last) {
  const std::vector<ContactRecord> active = contactsOf(node_ids, records, pointOf, last);
  std::vector<int> order(active.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int i, int j) {
    const Interaction &a = active[i].pair, &b = active[j].pair;
    return a.node != b.node ? a.node < b.node : a.side < b.side;
  });
  history.count = static_cast<std::int64_t>(active.size());
  growTo(space, history.interactions, history.count);
  const std::int64_t room = history.interactions.size();
  if (has_friction)
    growTo(space, history.friction, room);
  growTo(space, history.fading, room);
  space.fence();
  std::vector<Interaction> interactions;
  std::vector<FrictionSpring> friction;
  std::vector<FadingForce> fading;
  const auto row_begin = Kokkos::create_mirror_view(history.row_begin);
  const auto row_count = Kokkos::create_mirror_view(history.row_count);
  Kokkos::deep_copy(row_begin, 0);
  Kokkos::deep_copy(row_count, 0);
  for (const int i : order) {
    const ContactRecord& record = active[i];
    if (row_count(record.pair.node)++ == 0)
      row_begin(record.pair.node) = static_cast<int>(interactions.size());
    interactions.push_back(record.pair);
    if (has_friction)
      friction.push_back(record.friction);
    fading.push_back(record.fading);
  }
  history.interactions.assign(interactions);
  history.friction.assign(friction);
  history.fading.assign(fading);
  Kokkos::deep_copy(history.row_begin, row_begin);
  Kokkos::deep_copy(history.row_count, row_count);
}

} // namespace brickwall::contact
