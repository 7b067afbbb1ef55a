#include "contact/search/exchange/rank_tree.hpp"

#include "contact/search/exchange/node_box_exchange.hpp"

#include <algorithm>

namespace brickwall::contact {
namespace {

enum RecordWord : int { record_rank, record_node_box, record_face_box = 7, record_words = 13 };
enum GroupWord : int { group_node_box, group_face_box = 6, group_counts = 12, group_words = 19 };

// The words of a group besides its boxes.
template <class Group, class Visit>
void forCounts(Group& group, const Visit& visit) {
  int word = group_counts;
  for (auto* count :
       {&group.num_invalid, &group.first_invalid, &group.invalid_rank, &group.rank_with_faces,
        &group.attributes, &group.other_rank, &group.other_attributes})
    visit(*count, word++);
}

void packRecord(const RankRecord& record, std::vector<std::int64_t>& words) {
  const std::size_t first = words.size();
  words.resize(first + record_words);
  words[first + record_rank] = record.rank;
  packBox(record.node_box, &words[first + record_node_box]);
  packBox(record.face_box, &words[first + record_face_box]);
}

RankRecord unpackRecord(const std::int64_t* words) {
  return {static_cast<int>(words[record_rank]), unpackBox(words + record_node_box),
          unpackBox(words + record_face_box)};
}

void packGroup(const RankGroup& group, std::vector<std::int64_t>& words) {
  const std::size_t first = words.size();
  words.resize(first + group_words);
  packBox(group.node_box, &words[first + group_node_box]);
  packBox(group.face_box, &words[first + group_face_box]);
  forCounts(group, [&](std::int64_t count, int word) { words[first + std::size_t(word)] = count; });
}

RankGroup unpackGroup(const std::int64_t* words) {
  RankGroup group;
  group.node_box = unpackBox(words + group_node_box);
  group.face_box = unpackBox(words + group_face_box);
  forCounts(group, [&](std::int64_t& count, int word) { count = words[word]; });
  return group;
}

// Of the ranks of a group, as Zoltan's bisection divides them.
int lowerHalf(int count) {
  return (count + 1) / 2;
}

} // namespace

void RankGroup::include(const RankGroup& higher) {
  node_box.include(higher.node_box);
  face_box.include(higher.face_box);
  if (higher.num_invalid > 0 && (num_invalid == 0 || higher.first_invalid < first_invalid)) {
    first_invalid = higher.first_invalid;
    invalid_rank = higher.invalid_rank;
  }
  num_invalid += higher.num_invalid;
  if (rank_with_faces == none) {
    rank_with_faces = higher.rank_with_faces;
    attributes = higher.attributes;
    other_rank = higher.other_rank;
    other_attributes = higher.other_attributes;
  } else if (other_rank == none && higher.rank_with_faces != none) {
    const bool differs = higher.attributes != attributes;
    other_rank = differs ? higher.rank_with_faces : higher.other_rank;
    other_attributes = differs ? higher.attributes : higher.other_attributes;
  }
}

RankTree::RankTree(int rank, int size) : _rank(rank), _size(size) {
  while (size >> (_levels + 1) > 0)
    ++_levels;
  _is_uneven = size != 1 << _levels;
  int first = 0, count = size;
  for (int level = 0; level < _levels; ++level) {
    const int lower = lowerHalf(count);
    const bool is_upper = rank >= first + lower;
    first += is_upper ? lower : 0;
    count = is_upper ? count - lower : lower;
    _position = 2 * _position + (is_upper ? 1 : 0);
  }
  _is_guest = rank != first;
  _is_host = !_is_guest && count == 2;
}

int RankTree::firstRankAt(int position) const {
  int first = 0, count = _size;
  for (int level = _levels - 1; level >= 0; --level) {
    const int lower = lowerHalf(count);
    const bool is_upper = (position >> level & 1) == 1;
    first += is_upper ? lower : 0;
    count = is_upper ? count - lower : lower;
  }
  return first;
}

RankTree::Place RankTree::placeOf(int round) const {
  const int i = round - (_is_uneven ? 1 : 0);
  if (i < 0)
    return {_is_guest || _is_host ? Part::join : Part::none, 0};
  if (i >= 2 * _levels)
    return {_is_guest || _is_host ? Part::leave : Part::none, 0};
  if (_is_guest)
    return {};
  return i < _levels ? Place{Part::up, i} : Place{Part::down, 2 * _levels - 1 - i};
}

int RankTree::peerAt(int level) const {
  return firstRankAt(_position ^ (1 << level));
}

RankTree::Round RankTree::round(int i) const {
  const Place place = placeOf(i);
  switch (place.part) {
  case Part::join:
    return {_is_guest ? _rank - 1 : _rank + 1, _is_guest, _is_host};
  case Part::leave:
    return {_is_guest ? _rank - 1 : _rank + 1, _is_host, _is_guest};
  case Part::up:
  case Part::down:
    return {peerAt(place.level), true, true};
  case Part::none:
    break;
  }
  return {};
}

void RankTree::begin(const RankRecord& record, const RankGroup& own) {
  _own = record;
  _own_group = own;
  _groups.assign(1, own);
  _beside.clear();
  _held.assign(1, record);
  _box_tests = 0;
}

bool RankTree::overlap(const RankRecord& a, const Box& node_box, const Box& face_box) {
  ++_box_tests;
  if (a.node_box.overlaps(face_box))
    return true;
  ++_box_tests;
  return a.face_box.overlaps(node_box);
}

void RankTree::pack(int i, std::vector<std::int64_t>& words) {
  words.clear();
  const Place place = placeOf(i);
  switch (place.part) {
  case Part::join:
    packRecord(_own, words);
    packGroup(_own_group, words);
    break;
  case Part::up:
    packGroup(_groups.back(), words);
    break;
  case Part::down: { // those that overlap the group beside, while those of this group are kept
    const RankGroup& beside = _beside[std::size_t(place.level)];
    const RankGroup& here = _groups[std::size_t(place.level)];
    _kept.clear();
    for (const RankRecord& record : _held) {
      if (overlap(record, beside.node_box, beside.face_box))
        packRecord(record, words);
      if (overlap(record, here.node_box, here.face_box))
        _kept.push_back(record);
    }
    _held.swap(_kept);
    break;
  }
  case Part::leave:
    packGroup(all(), words);
    for (const RankRecord& record : _held)
      if (record.rank != _guest_record.rank &&
          overlap(record, _guest_record.node_box, _guest_record.face_box))
        packRecord(record, words);
    break;
  case Part::none:
    break;
  }
}

void RankTree::unpack(int i, const std::int64_t* words, std::size_t size) {
  const Place place = placeOf(i);
  switch (place.part) {
  case Part::join:
    _guest_record = unpackRecord(words);
    _held.push_back(_guest_record);
    _groups[0].include(unpackGroup(words + record_words));
    break;
  case Part::up: {
    _beside.push_back(unpackGroup(words));
    const bool is_lower = (_position >> place.level & 1) == 0;
    RankGroup joined = is_lower ? _groups.back() : _beside.back();
    joined.include(is_lower ? _beside.back() : _groups.back());
    _groups.push_back(joined);
    break;
  }
  case Part::down:
    receiveRecords(words, size);
    break;
  case Part::leave:
    _groups.assign(1, unpackGroup(words));
    _held.clear();
    receiveRecords(words + group_words, size - group_words);
    break;
  case Part::none:
    break;
  }
}

void RankTree::receiveRecords(const std::int64_t* words, std::size_t size) {
  for (std::size_t first = 0; first < size; first += record_words)
    _held.push_back(unpackRecord(words + first));
}

std::vector<RankRecord> RankTree::partners() {
  std::vector<RankRecord> near;
  for (const RankRecord& record : _held)
    if (record.rank != _rank && overlap(record, _own.node_box, _own.face_box))
      near.push_back(record);
  std::sort(near.begin(), near.end(),
            [](const RankRecord& a, const RankRecord& b) { return a.rank < b.rank; });
  return near;
}

} // namespace brickwall::contact
