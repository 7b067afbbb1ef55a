// Phase times from regions, the history and the reports.
#include "contact/base/error.hpp"
#include "contact/base/mpi.hpp"
#include "contact/base/region.hpp"
#include "miniapp/output/history.hpp"
#include "miniapp/output/output_files.hpp"
#include "miniapp/output/report.hpp"
#include "miniapp/output/search_report.hpp"
#include "miniapp/timing/phase_report.hpp"
#include "miniapp/timing/process_memory.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <sstream>
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
  const Region search("search");
  {
    const Region boxes("search::node boxes");
    work(seconds);
    const Region copies("search::host-device copies");
    work(seconds);
  }
  const Region phase("anything");
  const Region last("search::search 2");
  work(seconds);
}

// Sleeping for s takes at least s; how much longer is the machine's affair, so upper bounds come from sums.
TEST(PhaseRecorder, TellsTimersApart) {
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
  EXPECT_NEAR(sum, named(recorder.phases(), "search").mean, 1e-9); // own times add up
  EXPECT_GE(recorder.seconds("search::node boxes"), 0.04); // with the region inside it
}

TEST(PhaseRecorder, ForgetsWhenReset) {
  PhaseRecorder recorder(MPI_COMM_WORLD, Timing::normal);
  oneSearch(0.02);
  {
    const Region outer("outer");
    work(0.02);
    recorder.reset();
    EXPECT_EQ(recorder.calls("search"), 0);
    EXPECT_EQ(recorder.seconds("search"), 0.0);
  }
  EXPECT_EQ(recorder.calls("outer"), 1);
  EXPECT_LT(recorder.seconds("outer"), 0.02); // counts from the reset on
}

TEST(PhaseRecorder, TakesTheMedianOfTheSlowestRank) {
  PhaseRecorder recorder(MPI_COMM_WORLD, Timing::normal);
  recorder.watch("search", 3);
  const int rank = rankOf(MPI_COMM_WORLD), last = sizeOf(MPI_COMM_WORLD) - 1;
  for (const double seconds : {0.003, 0.2, 0.006}) {
    if (rank == last) { // only the last rank searches for long
      const Region search("search");
      work(seconds);
    } else {
      const Region search("search");
    }
    recorder.endStep();
  }
  EXPECT_GE(recorder.medianPerStep("search"), 0.006);
  EXPECT_LT(recorder.medianPerStep("search"), 0.2);
  EXPECT_THROW(recorder.medianPerStep("unheard"), Error);
}

TEST(PhaseRecorder, AgreesOnRegionsThatFewRanksOpen) {
  PhaseRecorder recorder(MPI_COMM_WORLD, Timing::normal);
  const int rank = rankOf(MPI_COMM_WORLD);
  { const Region everyone("everyone"); }
  { const Region own(("rank " + std::to_string(rank)).c_str()); }
  const auto phases = recorder.phases();
  ASSERT_EQ(static_cast<int>(phases.size()), 1 + sizeOf(MPI_COMM_WORLD));
  EXPECT_EQ(phases[0].name, "everyone");
  EXPECT_EQ(named(phases, "rank 0").calls, 1);
}

TEST(PhaseRecorder, CountsWaitsApartWithPaperTiming) {
  PhaseRecorder recorder(MPI_COMM_WORLD, Timing::paper);
  const bool is_late = rankOf(MPI_COMM_WORLD) == 0;
  {
    const Region search("search");
    if (is_late)
      work(0.05);
    const Region phase("search::rank-box exchange");
  }
  const auto timers = recorder.searchTimers();
  if (sizeOf(MPI_COMM_WORLD) > 1) {
    EXPECT_GE(named(timers, "waiting").max, 0.04);
  }
  EXPECT_LT(named(timers, "rank-box exchange").max, 0.04);
}

// Work that burns this thread's CPU time, where sleeping does not.
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
  recorder.watch("search", 2);
  recorder.watchCpu({"search", "search::local search"}, 2);
  recorder.watchSearchTimers(2);
  recorder.reset();
  for (int step = 0; step < 2; ++step) {
    {
      const Region search("search");
      { const Region early("search::node boxes"); }
      if (rankOf(MPI_COMM_WORLD) == 0)
        burn(0.05); // the others wait, some MPIs by spinning
      {
        const Region phase("search::search 2");
        burn(0.01);
        work(0.02);
      }
      const Region waiting("search::waiting"); // of the library itself
      burn(0.03);
    }
    recorder.endStep();
  }
  const StepStatistics wall = recorder.secondsPerStep("search");
  const StepStatistics cpu = recorder.busyCpuPerStep("search");
  EXPECT_GE(wall.min, 0.05 + 0.01 + 0.02 + 0.03);
  EXPECT_GE(cpu.min, 0.06); // of rank 0
  EXPECT_LT(cpu.min, 0.08); // neither sleep nor waits
  EXPECT_LE(cpu.min, cpu.median);
  EXPECT_LE(cpu.median, cpu.max);
  const int ranks = sizeOf(MPI_COMM_WORLD);
  // Rank 0 has 60 ms of work, the others 10 ms.
  EXPECT_NEAR(cpu.imbalance, 0.06 * ranks / (0.06 + 0.01 * (ranks - 1)), 0.25);
  EXPECT_EQ(recorder.busyCpuPerStep("search::local search").max, 0.0);
  const auto timers = recorder.searchTimersPerStep();
  ASSERT_EQ(timers.size(), 13u);
  EXPECT_EQ(timers[9].name, "search 2");
  EXPECT_GE(timers[9].cpu_seconds.min, 0.01);
  EXPECT_LT(timers[9].cpu_seconds.min, 0.02);
  EXPECT_GE(timers[9].seconds.min, 0.03);
  EXPECT_THROW(recorder.busyCpuPerStep("findGhosts"), Error);
}

TEST(PhaseRecorder, TakesSearchesInsideTheLocalSearchForItsOwn) {
  PhaseRecorder recorder(MPI_COMM_WORLD, Timing::normal);
  {
    const Region search("search");
    const Region local("search::local search");
    const Region copies("search::host-device copies");
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

TEST(MemoryAbove, SeesWhatWasNeededForATimeAndNotWhatWasBefore) {
  constexpr std::size_t megabyte = 1 << 20;
  const auto use = [&](std::size_t megabytes) {
    std::vector<char> bytes(megabytes * megabyte);
    for (std::size_t i = 0; i < bytes.size(); i += 512)
      bytes[i] = static_cast<char>(i);
    return std::count(bytes.begin(), bytes.end(), 1);
  };
  EXPECT_GE(use(200), 0); // a larger set-up, gone before
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

RunReport sampleReport() {
  RunReport report;
  report.case_name = "sample";
  report.elements = 100;
  report.faces = 60;
  report.steps = 11;
  report.counted_steps = 10;
  report.loop_seconds = 2;
  report.solver_seconds = 1;
  report.search_seconds = 0.5;
  report.counted_searches = 10;
  report.phases = {{"search", 10, 0.1, 0.2, 0.5}};
  report.search.method = "paper";
  report.checksums = {255, 0x8000000000000001ull, 3};
  report.time_step = {"lanczos", 1.25, 20, 2, 2.0, 0.5, {{"tunnelling", 3, 4.0, 2.0, 0.5}}, 7};
  return report;
}

TEST(Report, NamesItsFieldsAsAgreed) {
  RunReport report = sampleReport();
  report.provenance = describeRun(MPI_COMM_WORLD);
  report.max_rank_bytes = peakRankBytes(MPI_COMM_WORLD);
  const auto json = nlohmann::json::parse(reportJson(report));
  for (const char* name :
       {"schema",   "case",   "version", "commit",  "compiler",         "flags",
        "kokkos",   "host",   "cpu",     "ranks",   "threads_per_rank", "execution_space",
        "elements", "nodes",  "faces",   "steps",   "end_time",         "loop_seconds",
        "fom",      "phases", "search",  "balance", "memory",           "pass"})
    EXPECT_TRUE(json.contains(name)) << name;
  EXPECT_EQ(json["fom"]["element_steps_per_second"], 500.0);
  EXPECT_EQ(json["fom"]["solver_element_steps_per_second"], 1000.0);
  EXPECT_EQ(json["fom"]["face_searches_per_second"], 1200.0);
  EXPECT_EQ(json["phases"][0]["max"], 0.5);
  for (const char* name : {"method", "margin", "searches", "steps_per_search", "seconds_per_step",
                           "ghost_faces", "candidate_pairs", "active_contacts"})
    EXPECT_TRUE(json["search"].contains(name)) << name;
  for (const char* name :
       {"energy_error", "momentum_error", "angular_momentum_error", "ledger_residual",
        "stored_error", "hourglass_share", "external_work", "dissipated_energy",
        "peak_kinetic_energy", "peak_stored_energy", "peak_energy"})
    EXPECT_TRUE(json["balance"].contains(name)) << name;
  EXPECT_FALSE(json["balance"].contains("contact_error")); // there is no contact
  EXPECT_FALSE(json["search"].contains("missed_pairs")); // nothing was audited
  EXPECT_EQ(json["checksums"]["nodes"], "00000000000000ff");
  EXPECT_EQ(json["checksums"]["contacts"], "8000000000000001");
  EXPECT_EQ(json["checksums"]["interactions"], 3);
  EXPECT_EQ(json["time_step"]["first"], 2.0);
  EXPECT_EQ(json["time_step"]["guarded_steps"], 7);
  EXPECT_EQ(json["time_step"]["bound"], "lanczos");
  EXPECT_EQ(json["time_step"]["gain"], 1.25);
  EXPECT_EQ(json["time_step"]["products"], 20);
  EXPECT_EQ(json["time_step"]["body_types"], 2);
  EXPECT_EQ(json["time_step"]["cuts"][0]["reason"], "tunnelling");
  EXPECT_EQ(json["time_step"]["cuts"][0]["step"], 3);
  EXPECT_EQ(json["time_step"]["cuts"][0]["to"], 0.5);
  EXPECT_GT(json["memory"]["max_rank_bytes"], 1000000);
  EXPECT_EQ(json["ranks"], sizeOf(MPI_COMM_WORLD));
  EXPECT_EQ(json["pass"], true);
}

TEST(SearchReport, NamesItsFieldsAsAgreed) {
  SearchOnlyReport report;
  report.provenance = describeRun(MPI_COMM_WORLD);
  report.faces = 300;
  report.method = "paper";
  report.timing = Timing::paper;
  report.searches = report.repetitions = 4;
  report.seconds.whole.median = 0.25;
  report.cpu_seconds.global.mean = 0.125;
  report.timers = {{"search 2", {0.1, 0.2, 0.3, 0.15, 1.5}, {0.01, 0.02, 0.03, 0.015, 1.25}}};
  report.search = overRanks(MPI_COMM_WORLD, 10);
  const auto json = nlohmann::json::parse(searchReportJson(report));
  for (const char* name : {"schema",
                           "case",
                           "version",
                           "commit",
                           "mpi",
                           "host",
                           "ranks",
                           "threads_per_rank",
                           "nodes",
                           "shuffled",
                           "jitter",
                           "drift",
                           "seed",
                           "warmup",
                           "repetitions",
                           "fom",
                           "seconds",
                           "phases",
                           "counts",
                           "memory",
                           "pass",
                           "local_search",
                           "first_search_seconds"})
    EXPECT_TRUE(json.contains(name)) << name;
  EXPECT_FALSE(json.contains("balance")); // of `run`
  EXPECT_EQ(json["fom"]["face_searches_per_second"], 1200.0);
  EXPECT_EQ(json["timing"], "paper");
  EXPECT_EQ(json["cpu_seconds"]["global_search"]["mean"], 0.125);
  EXPECT_EQ(json["timers"][0]["name"], "search 2");
  EXPECT_EQ(json["timers"][0]["imbalance"], 1.5);
  EXPECT_EQ(json["timers"][0]["cpu_seconds"]["median"], 0.02);
  EXPECT_EQ(json["memory"]["search"]["max_rank_bytes"], 10);
  EXPECT_EQ(json["memory"]["search"]["sum_bytes"], 10 * sizeOf(MPI_COMM_WORLD));
  std::ostringstream out;
  printSearchReport(out, report);
  EXPECT_NE(out.str().find("\nFOM face_searches_per_second=1200 seconds_per_search=0.25\nPASS\n"),
            std::string::npos)
      << out.str();
  EXPECT_EQ(out.str().find("element"), std::string::npos) << "nothing that only `run` has";
  report.searches = 0; // all lists were kept
  std::ostringstream kept;
  printSearchReport(kept, report);
  EXPECT_EQ(kept.str().find("FOM face"), std::string::npos);
  EXPECT_NE(kept.str().find("\nno FOM"), std::string::npos);
}

TEST(Report, EndsWithTheFigureOfMeritAndTheVerdict) {
  std::ostringstream out;
  RunReport report = sampleReport();
  printReport(out, report);
  EXPECT_NE(out.str().find("\nFOM element_steps_per_second=500 face_searches_per_second=1200 "
                           "loop_seconds=2\nPASS\n"),
            std::string::npos)
      << out.str();
  report.warnings = {"told", "new"};
  report.printed_warnings = 1;
  out.str("");
  printReport(out, report);
  EXPECT_NE(out.str().find("\nwarning: new\n"), std::string::npos);
  EXPECT_EQ(out.str().find("warning: told"), std::string::npos);
  report.failures = {"energy error 0.2 above 0.1", "momentum"};
  printReport(out, report);
  EXPECT_NE(out.str().find("\nFAIL: energy error 0.2 above 0.1; momentum\n"), std::string::npos);
}

TEST(Report, FailsForMissedPairsAndWarnsOfLostContacts) {
  RunReport report = sampleReport();
  judgeNumbers(report);
  EXPECT_TRUE(report.pass());
  EXPECT_TRUE(report.warnings.empty());
  report.search.audit = 10;
  report.search.missed_pairs = 3;
  report.search.lost_contacts = 2;
  report.balance.has_contact = true;
  judgeNumbers(report);
  EXPECT_FALSE(report.pass());
  EXPECT_NE(report.failures.at(0).find("3 candidate pairs"), std::string::npos);
  EXPECT_NE(report.warnings.at(0).find("2 times a loaded contact"), std::string::npos);
  const auto json = nlohmann::json::parse(reportJson(report));
  EXPECT_EQ(json["search"]["missed_pairs"], 3);
  EXPECT_EQ(json["pass"], false);
  EXPECT_TRUE(json["balance"].contains("contact_error"));
  EXPECT_TRUE(json["balance"].contains("penetration"));
}

TEST(Report, WarnsOfEnergiesThatAreRounding) {
  RunReport report = sampleReport();
  report.balance.is_rounding = true;
  report.balance.peak_energy = 3e-20;
  judgeNumbers(report);
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_NE(report.warnings[0].find("at most 3e-20"), std::string::npos);
  EXPECT_TRUE(report.pass());
}

TEST(Report, FindsAFullDisk) {
  if (!std::filesystem::exists("/dev/full"))
    GTEST_SKIP() << "no /dev/full here";
  EXPECT_THROW(writeReport(MPI_COMM_WORLD, "/dev/full", sampleReport()), OutputError);
  EXPECT_THROW(HistoryWriter(MPI_COMM_WORLD, "/dev/full", {"step", "time"}), OutputError);
  EXPECT_THROW(makeDirectory(MPI_COMM_WORLD, "/dev/full/x"), OutputError);
  EXPECT_THROW(writeTextFile(MPI_COMM_WORLD, "/no/such/folder/x", "text"), OutputError);
}

TEST(History, KeepsEveryBit) {
  const std::string path = "history_test_" + std::to_string(sizeOf(MPI_COMM_WORLD)) + ".csv";
  const double time = 1.0 / 3.0;
  {
    HistoryWriter history(MPI_COMM_WORLD, path, {"step", "time"});
    history.write({12345678.0, time});
    EXPECT_THROW(history.write({1.0}), Error);
    std::ifstream file(path); // readable while the run goes on
    std::string header, row;
    std::getline(file, header);
    std::getline(file, row);
    EXPECT_EQ(header, "step,time");
    EXPECT_EQ(row.substr(0, 9), "12345678,");
    EXPECT_EQ(std::stod(row.substr(9)), time);
    MPI_Barrier(MPI_COMM_WORLD);
  }
  if (rankOf(MPI_COMM_WORLD) == 0)
    std::filesystem::remove(path);
  HistoryWriter none(MPI_COMM_WORLD, "", {"step"});
  none.write({1.0});
}

} // namespace
