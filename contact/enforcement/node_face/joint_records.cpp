#include "contact/enforcement/node_face/joint_records.hpp"

#include <algorithm>
#include <string>
#include <tuple>

namespace brickwall::contact {

std::vector<JointRecord> recordsOf(const exec_space& space, const View<const global_id*>& node_ids,
                                   const JointAreas& joints) {
  space.fence();
  std::vector<JointRecord> records;
  if (joints.isEmpty())
    return records;
  const auto ids = toHost(node_ids);
  const auto row_begin = toHost(joints.row_begin), row_count = toHost(joints.row_count);
  const auto sides = toHost(joints.sides);
  const auto areas = toHost(joints.areas);
  for (std::size_t node = 0; node < ids.extent(0); ++node)
    for (int i = row_begin(node); i < row_begin(node) + row_count(node); ++i)
      records.push_back({ids(node), sides(i), areas(i)});
  return records;
}

JointAreas jointAreasOf(const exec_space& space, const View<const global_id*>& node_ids,
                        std::vector<JointRecord> records) {
  if (records.empty())
    return {};
  const auto before = [](const JointRecord& a, const JointRecord& b) {
    return std::tie(a.node, a.side) < std::tie(b.node, b.side);
  };
  if (!std::is_sorted(records.begin(), records.end(), before))
    std::sort(records.begin(), records.end(), before);
  const auto ids = toHost(node_ids);
  std::vector<int> row_begin, row_count;
  std::vector<global_id> sides;
  std::vector<double> areas;
  auto record = records.begin();
  for (std::size_t node = 0; node < ids.extent(0); ++node) {
    row_begin.push_back(static_cast<int>(sides.size()));
    if (record == records.end() || record->node != ids(node)) // otherwise ids follow each other
      record = std::lower_bound(records.begin(), records.end(),
                                JointRecord{ids(node), INT64_MIN, 0}, before);
    for (; record != records.end() && record->node == ids(node); ++record) {
      sides.push_back(record->side);
      areas.push_back(record->area);
    }
    row_count.push_back(static_cast<int>(sides.size()) - row_begin.back());
  }
  const std::string label = "contact::JointAreas::";
  return {toDevice<View<int*>>(space, label + "row_begin", row_begin),
          toDevice<View<int*>>(space, label + "row_count", row_count),
          toDevice<View<global_id*>>(space, label + "sides", sides),
          toDevice<View<double*>>(space, label + "areas", areas)};
}

} // namespace brickwall::contact
