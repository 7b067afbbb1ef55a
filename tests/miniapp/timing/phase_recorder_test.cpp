// Times and memory: phases from regions, statistics over steps and ranks.
#include "contact/base/error.hpp"
#include "contact/base/mpi.hpp"
#include "contact/base/region.hpp"
#include "miniapp/timing/phase_recorder.hpp"
#include "miniapp/timing/process_memory.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <thread>
#include <vector>

namespace {

using namespace brickwall;
using namespace brickwall::miniapp;

void work(double seconds) {
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

const PhaseTime& named(const std::vector<PhaseTime>& phases, const std::string& name) {
  for (const PhaseTime& phase : phases)
    if (phase.name == name)
      return phase;
  throw std::out_of_range(name);
}

void oneSearch(double seconds) {
  const Region search("contact::search");
  {
    const Region boxes("contact::search::node_boxes");
    work(seconds);
    const Region copies("contact::search::host_device_copies");
    work(seconds);
  }
  const Region phase("anything");
  const Region last("contact::search::search_2");
  work(seconds);
}

// Sleeping for s takes at least s, and longer on a busy machine, so that upper bounds come from
// sums.
TEST(PhaseRecorder, SeparatesTimers) {
  PhaseRecorder recorder(MPI_COMM_WORLD, Timing::normal);
  oneSearch(0.01);
  oneSearch(0.01);
  const auto timers = recorder.searchTimers();
  ASSERT_EQ(timers.size(), 13u);
  EXPECT_EQ(timers.front().name, "initialization");
  EXPECT_EQ(timers.back().name, "other");
  EXPECT_GE(named(timers, "node boxes").min, 0.02);
  EXPECT_GE(named(timers, "host-device copies").min, 0.02);
  EXPECT_GE(named(timers, "search 2").min, 0.02);
  EXPECT_EQ(named(timers, "migration").max, 0.0);
  EXPECT_EQ(named(timers, "node boxes").calls, 2);
  double sum = 0;
  for (const PhaseTime& timer : timers)
    sum += timer.mean;
  EXPECT_NEAR(sum, named(recorder.phases(), "contact::search").mean, 1e-9); // own times add up
  EXPECT_GE(recorder.seconds("contact::search::node_boxes"), 0.04); // with the region inside it
}

TEST(PhaseRecorder, ForgetsWhenReset) {
  PhaseRecorder recorder(MPI_COMM_WORLD, Timing::normal);
  oneSearch(0.02);
  {
    const Region outer("outer");
    work(0.02);
    recorder.reset();
    EXPECT_EQ(recorder.calls("contact::search"), 0);
    EXPECT_EQ(recorder.seconds("contact::search"), 0.0);
  }
  EXPECT_EQ(recorder.calls("outer"), 1);
  EXPECT_LT(recorder.seconds("outer"), 0.02); // counts from the reset on
}

TEST(PhaseRecorder, TakesTheMedianOfTheSlowestRank) {
  PhaseRecorder recorder(MPI_COMM_WORLD, Timing::normal);
  recorder.watch("contact::search", 3);
  const int rank = rankOf(MPI_COMM_WORLD), last = sizeOf(MPI_COMM_WORLD) - 1;
  for (const double seconds : {0.003, 0.2, 0.006}) {
    if (rank == last) { // only the last rank searches for long
      const Region search("contact::search");
      work(seconds);
    } else {
      const Region search("contact::search");
    }
    recorder.endStep();
  }
  EXPECT_GE(recorder.medianPerStep("contact::search"), 0.006);
  EXPECT_LT(recorder.medianPerStep("contact::search"), 0.2);
  EXPECT_THROW(recorder.medianPerStep("unheard"), Error);
}

TEST(PhaseRecorder, AgreesOnRegionsThatFewRanksOpen) {
  PhaseRecorder recorder(MPI_COMM_WORLD, Timing::normal);
  const int rank = rankOf(MPI_COMM_WORLD);
  { const Region everyone("everyone"); }
  { const Region own(("rank " + std::to_string(rank)).c_str()); }
  const auto phases = recorder.phases();
  ASSERT_EQ(static_cast<int>(phases.size()), 1 + sizeOf(MPI_COMM_WORLD));
  EXPECT_EQ(named(phases, "everyone").calls, 1);
  EXPECT_EQ(named(phases, "rank 0").calls, 1);
}

TEST(PhaseRecorder, PutsTheLongestPhaseFirst) {
  const PhaseRecorder recorder(MPI_COMM_WORLD, Timing::normal);
  for (const double seconds : {0.0, 0.1, 0.02}) {
    const Region region(std::to_string(seconds).c_str());
    work(seconds);
  }
  const auto phases = recorder.phases();
  ASSERT_EQ(phases.size(), 3u);
  EXPECT_TRUE(std::is_sorted(phases.begin(), phases.end(),
                             [](const auto& a, const auto& b) { return a.mean > b.mean; }));
}

TEST(PhaseRecorder, CountsWaitsSeparatelyWithPaperTiming) {
  PhaseRecorder recorder(MPI_COMM_WORLD, Timing::paper);
  const bool is_late = rankOf(MPI_COMM_WORLD) == 0;
  {
    const Region search("contact::search");
    if (is_late)
      work(0.05);
    const Region phase("contact::search::rank_box_exchange");
  }
  const auto timers = recorder.searchTimers();
  if (sizeOf(MPI_COMM_WORLD) > 1) {
    EXPECT_GE(named(timers, "waiting").max, 0.04);
  }
  EXPECT_LT(named(timers, "rank-box exchange").max, 0.04);
}

// Work that uses CPU time of this thread; sleeping does not.
void burn(double seconds) {
  timespec begin{}, end{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &begin);
  double spent = 0;
  while (spent < seconds) {
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &end);
    spent = static_cast<double>(end.tv_sec - begin.tv_sec) +
            1e-9 * static_cast<double>(end.tv_nsec - begin.tv_nsec);
  }
}

TEST(PhaseRecorder, CountsCpuTimeWithoutWaits) {
  PhaseRecorder recorder(MPI_COMM_WORLD, Timing::paper);
  recorder.watch("contact::search", 2);
  recorder.watchCpu({"contact::search", "contact::search::local_search"}, 2);
  recorder.watchSearchTimers(2);
  recorder.reset();
  for (int step = 0; step < 2; ++step) {
    {
      const Region search("contact::search");
      { const Region early("contact::search::node_boxes"); }
      if (rankOf(MPI_COMM_WORLD) == 0)
        burn(0.05); // the others wait, some MPIs by spinning
      {
        const Region phase("contact::search::search_2");
        burn(0.01);
        work(0.02);
      }
      const Region waiting("contact::search::waiting"); // of the library itself
      burn(0.03);
    }
    recorder.endStep();
  }
  const StepStatistics wall = recorder.secondsPerStep("contact::search");
  const StepStatistics cpu = recorder.busyCpuPerStep("contact::search");
  EXPECT_GE(wall.min, 0.05 + 0.01 + 0.02 + 0.03);
  EXPECT_GE(cpu.min, 0.06); // of rank 0
  EXPECT_LT(cpu.min, 0.08); // neither sleep nor waits
  EXPECT_LE(cpu.min, cpu.median);
  EXPECT_LE(cpu.median, cpu.max);
  const int ranks = sizeOf(MPI_COMM_WORLD);
  // Rank 0 has 60 ms of work, the others 10 ms.
  EXPECT_NEAR(cpu.imbalance, 0.06 * ranks / (0.06 + 0.01 * (ranks - 1)), 0.25);
  EXPECT_EQ(recorder.busyCpuPerStep("contact::search::local_search").max, 0.0);
  const auto timers = recorder.searchTimersPerStep();
  ASSERT_EQ(timers.size(), 13u);
  EXPECT_EQ(timers[9].name, "search 2");
  EXPECT_GE(timers[9].cpu_seconds.min, 0.01);
  EXPECT_LT(timers[9].cpu_seconds.min, 0.02);
  EXPECT_GE(timers[9].seconds.min, 0.03);
  EXPECT_THROW(recorder.busyCpuPerStep("contact::findGhosts"), Error);
}

TEST(PhaseRecorder, TakesSearchesInsideTheLocalSearchForItsOwn) {
  PhaseRecorder recorder(MPI_COMM_WORLD, Timing::normal);
  {
    const Region search("contact::search");
    const Region local("contact::search::local_search");
    const Region copies("contact::search::host_device_copies");
    work(0.01);
  }
  for (const PhaseTime& timer : recorder.searchTimers())
    EXPECT_LT(timer.max, 0.01) << timer.name;
}

TEST(StepSamples, GiveStatisticsOverStepsAndRanks) {
  const int rank = rankOf(MPI_COMM_WORLD), ranks = sizeOf(MPI_COMM_WORLD);
  StepSamples samples(4, 7.0);
  // Steps of 1, 5, 2 and 4 on the slowest rank, the last; a rank r has (r + 1) / ranks of it.
  double total = 7;
  for (const double step : {1.0, 5.0, 2.0, 4.0}) {
    total += step * (rank + 1) / ranks;
    samples.endStep(total);
  }
  const StepStatistics statistics = samples.statistics(MPI_COMM_WORLD);
  EXPECT_NEAR(statistics.min, 1, 1e-12);
  EXPECT_NEAR(statistics.median, 3, 1e-12); // between the two in the middle
  EXPECT_NEAR(statistics.max, 5, 1e-12);
  const double mean_share = 0.5 * (ranks + 1) / ranks;
  EXPECT_NEAR(statistics.mean, 3 * mean_share, 1e-12);
  EXPECT_NEAR(statistics.imbalance, 1 / mean_share, 1e-12);
  samples.reset();
  EXPECT_EQ(samples.statistics(MPI_COMM_WORLD).max, 0.0);
}

TEST(MemoryAbove, MeasuresTemporaryUseAndNotEarlierUse) {
  constexpr std::size_t megabyte = 1 << 20;
  const auto use = [&](std::size_t megabytes) {
    std::vector<char> bytes(megabytes * megabyte);
    for (std::size_t i = 0; i < bytes.size(); i += 512)
      bytes[i] = static_cast<char>(i);
    return std::count(bytes.begin(), bytes.end(), 1);
  };
  EXPECT_GE(use(200), 0); // a larger set-up, freed
  const MemoryAbove memory;
  EXPECT_GE(use(64), 0);
  EXPECT_GE(memory.bytes(), static_cast<std::int64_t>(60 * megabyte));
  EXPECT_LE(memory.bytes(), static_cast<std::int64_t>(80 * megabyte));
  EXPECT_GE(memory.peakBytes(), static_cast<std::int64_t>(200 * megabyte));
  EXPECT_GT(memory.baselineBytes(), 0);
}

int chained_calls = 0;
TEST(PhaseRecorder, LetsEarlierToolsListen) {
  chained_calls = 0;
  Kokkos::Tools::Experimental::set_push_region_callback([](const char*) { ++chained_calls; });
  {
    PhaseRecorder recorder(MPI_COMM_WORLD, Timing::normal);
    const Region region("any");
  }
  const Region after("after the recorder");
  EXPECT_EQ(chained_calls, 2);
  Kokkos::Tools::Experimental::set_push_region_callback(nullptr);
}

} // namespace
