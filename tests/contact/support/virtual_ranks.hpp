// Many ranks in one process: the messages of RankTree are carried from one object to the other
// instead of by MPI, and counted. Used by rank_tree_test and by verification/performance/scale.
#pragma once

#include "contact/search/exchange/rank_tree.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace brickwall::contact::test {

// Splits a domain as recursive coordinate bisection does, with equal volumes: the longest side is
// cut, and the ranks of the parts are consecutive.
inline void bisect(const Box& domain, int first_rank, int num_ranks, std::vector<Box>& cells) {
  if (num_ranks == 1) {
    cells[std::size_t(first_rank)] = domain;
    return;
  }
  int axis = 0;
  for (int d = 1; d < 3; ++d)
    if (domain.upper[d] - domain.lower[d] > domain.upper[axis] - domain.lower[axis])
      axis = d;
  const int lower = (num_ranks + 1) / 2;
  const double cut =
      domain.lower[axis] + (domain.upper[axis] - domain.lower[axis]) * lower / num_ranks;
  Box below = domain, above = domain;
  below.upper[axis] = above.lower[axis] = cut;
  bisect(below, first_rank, lower, cells);
  bisect(above, first_rank + lower, num_ranks - lower, cells);
}

inline std::vector<Box> bisectedCells(const Box& domain, int num_ranks) {
  std::vector<Box> cells(static_cast<std::size_t>(num_ranks));
  bisect(domain, 0, num_ranks, cells);
  return cells;
}

// Both boxes of a rank are its cell, which is inflated.
inline std::vector<RankRecord> recordsOf(const std::vector<Box>& cells, double margin) {
  std::vector<RankRecord> records;
  for (const Box& cell : cells) {
    Box box = cell;
    box.inflate(margin);
    records.push_back({static_cast<int>(records.size()), box, box});
  }
  return records;
}

// Of one rank in one exchange of rank boxes.
struct ExchangeCounts {
  std::int64_t messages = 0, bytes = 0; // sent
  std::int64_t box_tests = 0, partners = 0;
};

struct Replay {
  std::vector<ExchangeCounts> counts; // [rank]
  std::vector<std::vector<RankRecord>> partners; // [rank]
  std::vector<RankGroup> all; // [rank]
};

// The exchange among `records` [rank]; `groups` [rank] is each rank by itself.
inline Replay replayExchange(const std::vector<RankRecord>& records,
                             const std::vector<RankGroup>& groups) {
  const std::size_t size = records.size();
  std::vector<RankTree> trees;
  trees.reserve(size);
  for (std::size_t q = 0; q < size; ++q) {
    trees.emplace_back(static_cast<int>(q), static_cast<int>(size));
    trees[q].begin(records[q], groups[q]);
  }
  Replay replay;
  replay.counts.resize(size);
  std::vector<std::vector<std::int64_t>> messages(size);
  for (int i = 0; i < trees[0].numRounds(); ++i) {
    for (std::size_t q = 0; q < size; ++q)
      if (trees[q].round(i).sends) {
        trees[q].pack(i, messages[q]);
        ++replay.counts[q].messages;
        replay.counts[q].bytes += static_cast<std::int64_t>(8 * messages[q].size());
      }
    for (std::size_t q = 0; q < size; ++q)
      if (const RankTree::Round round = trees[q].round(i); round.receives) {
        const auto& message = messages[std::size_t(round.peer)];
        trees[q].unpack(i, message.data(), message.size());
      }
  }
  for (std::size_t q = 0; q < size; ++q) {
    replay.partners.push_back(trees[q].partners());
    replay.all.push_back(trees[q].all());
    replay.counts[q].partners = static_cast<std::int64_t>(replay.partners[q].size());
    replay.counts[q].box_tests = trees[q].boxTests();
  }
  return replay;
}

inline Replay replayExchange(const std::vector<RankRecord>& records) {
  std::vector<RankGroup> groups;
  for (const RankRecord& record : records) {
    RankGroup group;
    group.node_box = record.node_box;
    group.face_box = record.face_box;
    groups.push_back(group);
  }
  return replayExchange(records, groups);
}

// The mean and the largest of all ranks.
struct MeanAndMax {
  double mean = 0, max = 0;
};
inline MeanAndMax overRanks(const Replay& replay, std::int64_t ExchangeCounts::*count) {
  MeanAndMax result;
  for (const ExchangeCounts& of_rank : replay.counts) {
    const auto value = static_cast<double>(of_rank.*count);
    result.mean += value / static_cast<double>(replay.counts.size());
    result.max = std::max(result.max, value);
  }
  return result;
}

} // namespace brickwall::contact::test
