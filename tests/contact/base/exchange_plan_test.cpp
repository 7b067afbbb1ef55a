// Messages between ranks on each path (message_path.hpp) that this host offers. On a host without a
// device, or without ranks that reach each other, the tests of the other paths say so.
#include "contact/base/messages/exchange_plan.hpp"
#include "contact/base/to_device.hpp"
#include "tests/support/communicator.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <optional>
#include <string>

namespace brickwall {
namespace {

// A ring: rows 0 and 1 are owned; rows 2 and 3 are copies of rows 1 and 0 of the previous rank, row
// 4 of row 0 of the next rank.
struct Ring {
  int rank = rankOf(comm), size = sizeOf(comm);
  int next = (rank + 1) % size, previous = (rank + size - 1) % size;
  ExchangePlan plan() const {
    std::vector<int> partners{std::min(next, previous)};
    if (next != previous)
      partners.push_back(std::max(next, previous));
    std::vector<std::vector<int>> send(partners.size()), receive(partners.size());
    for (std::size_t p = 0; p < partners.size(); ++p) {
      // With two ranks the next and the previous rank are one partner: both sides list the forward
      // rows first. With one rank it is this one.
      if (partners[p] == next)
        send[p].insert(send[p].end(), {1, 0});
      if (partners[p] == previous) {
        send[p].push_back(0);
        receive[p].insert(receive[p].end(), {2, 3});
      }
      if (partners[p] == next)
        receive[p].push_back(4);
    }
    return ExchangePlan(exec_space(), Communicator(comm), 99, partners, send, receive);
  }
};

// The path of all messages while it lives. False if this MPI and device cannot take it.
class MessagePathTest : public testing::TestWithParam<MessagePath> {
protected:
  void SetUp() override {
    if (GetParam() == MessagePath::direct && !host_accessible && !isDeviceAware())
      GTEST_SKIP() << "this MPI does not read the memory of devices";
    setenv("BRICKWALL_MESSAGES", nameOf(GetParam()), 1);
  }
  void TearDown() override { unsetenv("BRICKWALL_MESSAGES"); }
};

TEST_P(MessagePathTest, ForwardCopiesOwnersRowsToGhosts) {
  const Ring ring;
  const exec_space space;
  ExchangePlan plan = ring.plan();
  EXPECT_EQ(plan.numSendRows(), 3);
  View<double* [2]> values("values", 5);
  const auto host = Kokkos::create_mirror_view(values);
  for (int repeat = 0; repeat < 5; ++repeat) { // buffers persist
    const auto owned = [&](int rank, int row, int w) {
      return 1000 * repeat + 100 * rank + 10 * row + w + 0.1;
    };
    for (int row = 0; row < 5; ++row)
      for (int w = 0; w < 2; ++w)
        host(row, w) = row < 2 ? owned(ring.rank, row, w) : -1;
    Kokkos::deep_copy(values, host);
    plan.forward(space, values);
    space.fence();
    Kokkos::deep_copy(host, values);
    for (int w = 0; w < 2; ++w) {
      ASSERT_EQ(host(2, w), owned(ring.previous, 1, w));
      ASSERT_EQ(host(3, w), owned(ring.previous, 0, w));
      ASSERT_EQ(host(4, w), owned(ring.next, 0, w));
    }
  }
}

TEST_P(MessagePathTest, ReverseSumAddsGhostsToTheirOwner) {
  const Ring ring;
  const exec_space space;
  ExchangePlan plan = ring.plan();
  View<std::int64_t* [1]> values("values", 5);
  const auto host = Kokkos::create_mirror_view(values);
  for (int row = 0; row < 5; ++row)
    host(row, 0) = (std::int64_t(1) << 40) * (ring.rank + 1) + row;
  Kokkos::deep_copy(values, host);
  plan.reverseSum(space, values);
  space.fence();
  Kokkos::deep_copy(host, values);
  const auto initial = [](int rank, int row) { return (std::int64_t(1) << 40) * (rank + 1) + row; };
  // The owned row 0 is row 3 of the next rank and row 4 of the previous one, the owned row 1 is row
  // 2 of the next.
  EXPECT_EQ(host(0, 0), initial(ring.rank, 0) + initial(ring.next, 3) + initial(ring.previous, 4));
  EXPECT_EQ(host(1, 0), initial(ring.rank, 1) + initial(ring.next, 2));
  for (int row = 2; row < 5; ++row)
    EXPECT_EQ(host(row, 0), initial(ring.rank, row)); // ghosts keep their values
}

// Kernels of the same space run between the two parts of a sum, on other rows.
TEST_P(MessagePathTest, ASumInTwoPartsLeavesTimeForKernels) {
  const int rank = rankOf(comm), size = sizeOf(comm);
  std::vector<int> partners;
  for (int q = 0; q < size; ++q)
    if (q != rank)
      partners.push_back(q);
  const std::vector<std::vector<int>> rows(partners.size(), {0, 2});
  const exec_space space;
  ExchangePlan plan(space, Communicator(comm), 99, partners, rows, rows);
  View<std::int64_t* [3]> values("values", 3);
  for (int repeat = 0; repeat < 5; ++repeat) {
    Kokkos::deep_copy(values, std::int64_t(rank + 1));
    plan.startSum(space, values);
    Kokkos::deep_copy(space, Kokkos::subview(values, 1, Kokkos::ALL()), std::int64_t(repeat));
    plan.finishSum(space, values);
    const auto host = toHost(values);
    for (int w = 0; w < 3; ++w) {
      ASSERT_EQ(host(0, w), size * (size + 1) / 2);
      ASSERT_EQ(host(1, w), repeat);
      ASSERT_EQ(host(2, w), size * (size + 1) / 2);
    }
  }
}

// Each rank sends more words to the next rank in each round, and none to others: buffers grow, and
// receivers do not know the sizes. The second time the path `peer` begins with memory of the first.
TEST_P(MessagePathTest, MessagesOfAnySizeArriveWithTheirSizes) {
  const Ring ring;
  if (ring.size == 1)
    GTEST_SKIP() << "needs partners";
  const exec_space space;
  const Communicator own(comm);
  std::optional<MessageBuffers> made;
  for (const std::int64_t words : {3, 0, 1000, 40, 600000, 600000, 7, 2000000, 3, 3, 2000000}) {
    if (words == 3)
      made.emplace();
    MessageBuffers& buffers = *made;
    const auto wordOf = [](int rank, std::int64_t i) { return 10 * i + rank; };
    std::vector<std::int64_t> data;
    for (std::int64_t i = 0; i < words; ++i)
      data.push_back(wordOf(ring.rank, i));
    growTo(space, buffers.send, words);
    if (words > 0)
      Kokkos::deep_copy(Kokkos::subview(buffers.send, std::make_pair(std::size_t(0), data.size())),
                        Kokkos::View<std::int64_t*, Kokkos::HostSpace>(data.data(), data.size()));
    std::vector<std::int64_t> offsets;
    buffers.exchangeOfAnySize(space, own, 98, {ring.next}, {0, words}, {ring.previous}, offsets);
    ASSERT_EQ(offsets, (std::vector<std::int64_t>{0, words}));
    const auto received = toHost(buffers.receive);
    space.fence();
    for (std::int64_t i = 0; i < words; ++i)
      ASSERT_EQ(received(i), wordOf(ring.previous, i));
  }
}

TEST_P(MessagePathTest, SentMessagesAreCounted) {
  const Ring ring;
  ExchangePlan plan = ring.plan();
  const MessageCounts before = messagesSent();
  plan.forward(exec_space(), View<double* [2]>("values", 5));
  const int partners = ring.size == 1 ? 0 : ring.size == 2 ? 1 : 2;
  EXPECT_EQ(messagesSent().messages - before.messages, partners);
  EXPECT_EQ(messagesSent().words - before.words, partners == 0 ? 0 : 6);
}

TEST_P(MessagePathTest, AnExchangeWithoutPartnersDoesNothing) {
  MessageBuffers buffers;
  const MessageCounts before = messagesSent();
  buffers.exchange(exec_space(), comm, 98, {}, {0}, {0});
  EXPECT_EQ(messagesSent().messages, before.messages);
  EXPECT_EQ(buffers.receive.extent(0), 0u);
}

INSTANTIATE_TEST_SUITE_P(Paths, MessagePathTest,
                         testing::Values(MessagePath::direct, MessagePath::staged,
                                         MessagePath::peer),
                         [](const auto& info) { return std::string(nameOf(info.param)); });

TEST(ExchangePlanTest, APlanWithoutPartnersDoesNothing) {
  ExchangePlan plan;
  View<std::int64_t* [1]> values("values", 1);
  plan.reverseSum(exec_space(), values);
  EXPECT_EQ(plan.numReceiveRows(), 0);
}

// Shared memory is not freed: a run that makes exchanges again and again must not pile it up.
TEST(PeerMessagesTest, LaterExchangesUseTheSharedMemoryAgain) {
  if (!host_accessible)
    GTEST_SKIP() << "the memory of a device is not listed among the mapped files";
  setenv("BRICKWALL_MESSAGES", nameOf(MessagePath::peer), 1);
  const Ring ring;
  const auto mapped = [&] {
    ring.plan().forward(exec_space(), View<double* [2]>("values", 5));
    std::ifstream maps("/proc/self/maps");
    int count = 0;
    for (std::string line; std::getline(maps, line);)
      count += line.find("memfd:brickwall") != std::string::npos;
    return count;
  };
  const int before = mapped();
  EXPECT_GT(before, 0);
  for (int repeat = 0; repeat < 10; ++repeat)
    EXPECT_EQ(mapped(), before);
  unsetenv("BRICKWALL_MESSAGES");
}

TEST(MessagePathChoiceTest, AnUnknownPathIsRefused) {
  setenv("BRICKWALL_MESSAGES", "pigeon", 1);
  EXPECT_THROW(chooseMessagePath(), InputError);
  unsetenv("BRICKWALL_MESSAGES");
}

} // namespace
} // namespace brickwall
