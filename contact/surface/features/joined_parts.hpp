// Parts of wholes that extend over several ranks, such as the patches of a surface: found on each
// rank first, then joined where they meet. For set-up.
#pragma once

#include "contact/base/backend.hpp"
#include "contact/base/group_by_key.hpp"
#include "contact/base/mpi.hpp"

#include <algorithm>
#include <map>
#include <tuple>
#include <vector>

namespace brickwall::contact {

// Where a part meets another one. Both have the same two ids there: those of the nodes of an edge
// that two faces share, or of two edges that share a node.
struct Meeting {
  global_id low, high;
  global_id part; // the lowest id in the part

  auto ids() const { return std::tie(low, high); }
  friend bool operator<(const Meeting& a, const Meeting& b) { return a.ids() < b.ids(); }
};

// Calls visit(a, b) for each two that meet; `meetings` are sorted. Where more than two have the
// same ids, none meet.
template <class T, class Visit>
void forPairs(const std::vector<T>& meetings, const Visit& visit) {
  for (std::size_t begin = 0, end = 0; begin < meetings.size(); begin = end) {
    while (end < meetings.size() && meetings[end].ids() == meetings[begin].ids())
      ++end;
    if (end - begin == 2)
      visit(meetings[begin], meetings[begin + 1]);
  }
}

// The lowest id of the whole of each part, of those sorted meetings that join(meeting) selects.
template <class T, class Joins>
std::map<global_id, global_id> joinParts(const std::vector<T>& meetings, const Joins& joins) {
  std::map<global_id, int> place;
  for (const T& meeting : meetings)
    place.emplace(meeting.part, 0);
  int next = 0;
  for (auto& part : place)
    part.second = next++;
  DisjointSets wholes(place.size());
  forPairs(meetings, [&](const T& a, const T& b) {
    if (joins(a))
      wholes.join(place[a.part], place[b.part]);
  });
  std::map<int, global_id> lowest; // by the root of a whole; parts ascend
  std::map<global_id, global_id> whole_of;
  for (const auto& [part, i] : place)
    whole_of[part] = lowest.emplace(wholes.rootOf(i), part).first->second;
  return whole_of;
}

} // namespace brickwall::contact
