// The tree over ranks by which rank boxes are exchanged: its partners are those of plain loops, and
// its counts on many virtual ranks do not grow but with log2 of their number.
#include "tests/contact/support/virtual_ranks.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <utility>

namespace brickwall::contact::test {
namespace {

using Flags = std::pair<bool, bool>; // own nodes near its faces, own faces near its nodes

Flags near(const RankRecord& a, const RankRecord& b) {
  return {a.node_box.overlaps(b.face_box), a.face_box.overlaps(b.node_box)};
}

void expectPartnersOfLoops(const std::vector<RankRecord>& records) {
  const Replay replay = replayExchange(records);
  for (const RankRecord& own : records) {
    std::vector<int> expected, found;
    for (const RankRecord& other : records)
      if (other.rank != own.rank && near(own, other) != Flags(false, false))
        expected.push_back(other.rank);
    for (const RankRecord& other : replay.partners[std::size_t(own.rank)]) {
      found.push_back(other.rank);
      EXPECT_EQ(near(own, other), near(own, records[std::size_t(other.rank)]));
    }
    ASSERT_EQ(found, expected) << "rank " << own.rank << " of " << records.size();
  }
}

Box randomBox(std::mt19937_64& engine, double length) {
  std::uniform_real_distribution<double> place(0, 1), size(0, length);
  Box box;
  if (place(engine) < 0.1)
    return box; // a rank without faces or nodes
  for (int d = 0; d < 3; ++d) {
    box.lower[d] = place(engine);
    box.upper[d] = box.lower[d] + size(engine);
  }
  return box;
}

TEST(RankTreeTest, PartnersAreThoseOfLoopsOverAllRanks) {
  std::mt19937_64 engine(1);
  for (const int size : {1, 2, 3, 4, 5, 6, 7, 8, 9, 15, 16, 17, 31, 64, 100, 129})
    for (const double length : {0.05, 0.3, 2.0}) {
      std::vector<RankRecord> records;
      for (int q = 0; q < size; ++q)
        records.push_back({q, randomBox(engine, length), randomBox(engine, length)});
      expectPartnersOfLoops(records);
    }
}

TEST(RankTreeTest, AllRanksLearnTheSameOfAll) {
  for (const int size : {1, 2, 3, 5, 8, 13, 32, 45}) {
    std::vector<RankRecord> records;
    std::vector<RankGroup> groups;
    for (int q = 0; q < size; ++q) {
      RankGroup group;
      group.node_box.include(Vec3{1.0 * q, 0, 0});
      group.num_invalid = q % 3;
      group.first_invalid = (q * 7 + 3) % 5;
      group.invalid_rank = q;
      if (q % 4 != 0) {
        group.rank_with_faces = q;
        group.attributes = q < 6 ? 2 : q;
      }
      groups.push_back(group);
      records.push_back({q, group.node_box, group.face_box});
    }
    RankGroup expected = groups[0];
    for (int q = 1; q < size; ++q)
      expected.include(groups[std::size_t(q)]);
    if (size > 7) {
      EXPECT_EQ(expected.other_rank, 6);
      EXPECT_EQ(expected.rank_with_faces, 1);
    }
    for (const RankGroup& all : replayExchange(records, groups).all) {
      EXPECT_EQ(all.node_box.upper[0], size - 1.0);
      EXPECT_EQ(all.num_invalid, expected.num_invalid);
      EXPECT_EQ(all.first_invalid, expected.first_invalid);
      EXPECT_EQ(all.invalid_rank, expected.invalid_rank);
      EXPECT_EQ(all.rank_with_faces, expected.rank_with_faces);
      EXPECT_EQ(all.attributes, expected.attributes);
      EXPECT_EQ(all.other_rank, expected.other_rank);
      EXPECT_EQ(all.other_attributes, expected.other_attributes);
    }
  }
}

// A wall or a cube of `size` cells of volume 1.
std::vector<RankRecord> equalCells(int size, bool is_wall) {
  Box domain;
  const double side = is_wall ? std::sqrt(size) : std::cbrt(size);
  domain.include(Vec3{0, 0, 0});
  domain.include(Vec3{side, is_wall ? 1 : side, side});
  return recordsOf(bisectedCells(domain, size), 0.01);
}

// The bounds are 1.1 to 1.5 times the counts found, in units of what the theory says grows.
TEST(RankTreeTest, CountsOfARankGrowWithTheLogarithmOfTheirNumberOnly) {
  for (const bool is_wall : {true, false})
    for (const int size : {64, 1000, 4096, 20000}) {
      const Replay replay = replayExchange(equalCells(size, is_wall));
      const double levels = std::floor(std::log2(size));
      const auto of = [&](auto count) { return overRanks(replay, count); };
      EXPECT_LE(of(&ExchangeCounts::messages).max, 2 * levels + 1) << size;
      EXPECT_LE(of(&ExchangeCounts::partners).mean, is_wall ? 8 : 26) << size;
      EXPECT_LE(of(&ExchangeCounts::box_tests).mean / levels, is_wall ? 8 : 15) << size;
      EXPECT_LE(of(&ExchangeCounts::bytes).mean / levels, is_wall ? 360 : 600) << size;
    }
}

// A rank whose box overlaps all others has all of them as partners, whatever finds them; the others
// have one box more each.
TEST(RankTreeTest, OneStrayBoxCostsItsRankAllOthersAndEachOfTheseOneBox) {
  constexpr int size = 4096, stray = 1234;
  std::vector<RankRecord> records = equalCells(size, true);
  const Replay without = replayExchange(records);
  records[stray].face_box.inflate(1000);
  const Replay with = replayExchange(records);
  const double levels = std::log2(size);
  EXPECT_EQ(with.counts[stray].partners, size - 1);
  for (std::size_t q = 0; q < size; ++q) {
    if (q == stray)
      continue;
    EXPECT_LE(with.counts[q].partners, without.counts[q].partners + 1);
    EXPECT_EQ(with.counts[q].messages, without.counts[q].messages);
  }
  // The unions with the stray box reach everywhere, so boxes travel to it; and its own to all.
  EXPECT_LE(overRanks(with, &ExchangeCounts::bytes).mean,
            overRanks(without, &ExchangeCounts::bytes).mean + 2 * 104 * levels);
}

} // namespace
} // namespace brickwall::contact::test
