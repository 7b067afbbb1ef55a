#include "contact/enforcement/law/contact_records.hpp"

#include "contact/base/error.hpp"

#include <algorithm>
#include <string>
#include <unordered_map>

namespace brickwall::contact {

std::vector<ContactRecord> recordsOf(const exec_space& space,
                                     const View<const global_id*>& node_ids,
                                     const ContactHistory& history) {
  space.fence();
  const auto ids = toHost(node_ids);
  const auto interactions = toHost(history.interactions);
  const auto friction = toHost(history.friction);
  const auto fading = toHost(history.fading);
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
  return records;
}

void setHistory(const exec_space& space, const View<const global_id*>& node_ids,
                const std::vector<ContactRecord>& records, bool has_friction,
                const std::function<ContactPoint(int row)>& pointOf, ContactHistory& history) {
  const auto ids = toHost(node_ids);
  std::unordered_map<global_id, int> row_of;
  for (std::size_t i = 0; i < ids.extent(0); ++i)
    row_of.emplace(ids(i), static_cast<int>(i));
  std::vector<ContactRecord> sorted = records;
  for (ContactRecord& record : sorted) {
    const auto found = row_of.find(record.node);
    if (found == row_of.end())
      throw Error(ExitCode::internal, "setHistory: found a contact of node " +
                                          std::to_string(record.node) +
                                          ", which is not on the surface of this rank");
    Interaction& pair = record.pair;
    pair.node = found->second;
    pair.face_index = -1;
    const double share = pair.point.share;
    pair.point = pointOf(pair.node);
    pair.point.share = share;
  }
  std::sort(sorted.begin(), sorted.end(), [](const ContactRecord& a, const ContactRecord& b) {
    return a.pair.node != b.pair.node ? a.pair.node < b.pair.node : a.pair.body < b.pair.body;
  });
  history.count = static_cast<std::int64_t>(sorted.size());
  growTo(space, history.interactions, history.count);
  const auto room = static_cast<std::int64_t>(history.interactions.extent(0));
  if (has_friction)
    growTo(space, history.friction, room);
  growTo(space, history.fading, room);
  space.fence();
  const auto interactions = Kokkos::create_mirror_view(history.interactions);
  const auto friction = Kokkos::create_mirror_view(history.friction);
  const auto fading = Kokkos::create_mirror_view(history.fading);
  const auto row_begin = Kokkos::create_mirror_view(history.row_begin);
  const auto row_count = Kokkos::create_mirror_view(history.row_count);
  Kokkos::deep_copy(row_begin, 0);
  Kokkos::deep_copy(row_count, 0);
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    const int row = sorted[i].pair.node;
    if (row_count(row)++ == 0)
      row_begin(row) = static_cast<int>(i);
    interactions(i) = sorted[i].pair;
    if (has_friction)
      friction(i) = sorted[i].friction;
    fading(i) = sorted[i].fading;
  }
  Kokkos::deep_copy(history.interactions, interactions);
  Kokkos::deep_copy(history.friction, friction);
  Kokkos::deep_copy(history.fading, fading);
  Kokkos::deep_copy(history.row_begin, row_begin);
  Kokkos::deep_copy(history.row_count, row_count);
}

} // namespace brickwall::contact
