// The history and the reports.
#include "contact/base/error.hpp"
#include "contact/base/mpi.hpp"
#include "miniapp/output/history.hpp"
#include "miniapp/output/output_files.hpp"
#include "miniapp/output/report.hpp"
#include "miniapp/output/run_report.hpp"
#include "miniapp/output/search_report.hpp"
#include "miniapp/timing/phase_recorder.hpp"
#include "tests/support/expect_contains.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>
#include <sstream>

namespace {

using namespace brickwall;
using namespace brickwall::miniapp;

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
  report.phases = {{"search", 10, 0.1, 0.2, 0.5}, {"only in the first step", 0, 0, 0, 0}};
  report.options = {"--checksums"};
  report.over_ranks = {{"faces", 0, 12, 10}, {"ghost_faces", 0, 0, 0}, {"search", 0, 0.5, 0.2}};
  report.search.method = "paper";
  report.checksums = {255, 0x8000000000000001ull, 3};
  report.time_step = {
      "lanczos", {1.25, 20, 2}, 2.0, 0.5, {{StepCut::Reason::tunnelling, 3, 4.0, 2.0, 0.5}}, 7};
  return report;
}

TEST(Report, NamesItsFieldsAsAgreed) {
  RunReport report = sampleReport();
  report.provenance = describeRun(MPI_COMM_WORLD);
  report.max_rank_bytes = peakRankBytes(MPI_COMM_WORLD);
  const auto json = nlohmann::json::parse(reportJson(report));
  EXPECT_EQ(json["spared"], json["skipped"]); // the former name
  EXPECT_EQ(json["options"], nlohmann::json({"--checksums"}));
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

TEST(Report, StatesTheImbalanceOfTheRanks) {
  RunReport report = sampleReport();
  report.provenance.ranks = 4;
  const auto json = nlohmann::json::parse(reportJson(report))["imbalance"];
  EXPECT_EQ(json["faces"]["max"], 12);
  EXPECT_EQ(json["faces"]["mean"], 10.0);
  EXPECT_EQ(json["faces"]["max_over_mean"], 1.2);
  EXPECT_EQ(json["ghost_faces"]["max_over_mean"], 0.0); // there are none
  EXPECT_EQ(json["search"]["max_over_mean"], 2.5);
  std::ostringstream printed;
  printReport(printed, report);
  EXPECT_CONTAINS(
      printed.str(),
      "imbalance (largest over mean of the ranks): faces 1.2, ghost_faces 0, search 2.5\n");
}

TEST(Report, ListsTheTimesThatElementsMoved) {
  RunReport report = sampleReport();
  report.rebalance = "auto";
  EXPECT_EQ(nlohmann::json::parse(reportJson(report))["partition"].dump(),
            "{\"rebalance\":\"auto\",\"rebalancings\":[]}");
  report.rebalancings = {{40, 0.5, 2.0, 1.25}, {80, 0.25, 1.5, 0}};
  const auto json = nlohmann::json::parse(reportJson(report))["partition"]["rebalancings"];
  EXPECT_EQ(json.size(), 2u);
  EXPECT_EQ(json[0].dump(), "{\"imbalance_after\":1.25,\"imbalance_before\":2.0,\"seconds\":0.5,"
                            "\"step\":40}");
  std::ostringstream printed;
  printReport(printed, report);
  EXPECT_CONTAINS(printed.str(),
                  "elements rebalanced: 2 times; the first time in 0.5 s, imbalance of work 2, "
                  "then 1.25\n");
}

TEST(Report, NamesTheDeviceAndItsMemoryOnlyWhereThereIsOne) {
  RunReport report = sampleReport();
  report.provenance = describeRun(MPI_COMM_WORLD);
  EXPECT_EQ(report.provenance.device.name == "none", host_accessible);
  for (const Device& device : {report.provenance.device, Device{"G 1", "CUDA 1.2", 3000, 2000}}) {
    report.provenance.device = device;
    const bool is_there = device.name != "none";
    const auto json = nlohmann::json::parse(reportJson(report));
    EXPECT_EQ(json["device"], device.name);
    EXPECT_EQ(json.value("device_versions", ""), device.versions);
    ASSERT_EQ(json.contains("device_memory"), is_there);
    std::ostringstream printed;
    printReport(printed, report);
    EXPECT_EQ(printed.str().find(" in use") != std::string::npos, is_there);
    if (is_there) {
      EXPECT_EQ(json["device_memory"]["bytes"], device.bytes);
      EXPECT_EQ(json["device_memory"]["bytes_in_use"], device.bytes_in_use);
      EXPECT_GT(device.bytes_in_use, 0);
      EXPECT_LE(device.bytes_in_use, device.bytes);
    }
  }
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
  EXPECT_CONTAINS(out.str(), "\nFOM face_searches_per_second=1200 seconds_per_search=0.25\nPASS\n");
  EXPECT_EQ(out.str().find("element"), std::string::npos) << "nothing that only `run` has";
  report.searches = 0; // all lists were kept
  std::ostringstream kept;
  printSearchReport(kept, report);
  EXPECT_EQ(kept.str().find("FOM face"), std::string::npos);
  EXPECT_CONTAINS(kept.str(), "\nno FOM");
}

TEST(Report, StatesTheMessagesOfAStep) {
  RunReport report = sampleReport(); // 10 counted steps
  const MessageCounts now = messagesSent();
  addMessages(MPI_COMM_WORLD, {now.messages - 25, now.words - 400}, report);
  const auto json = nlohmann::json::parse(reportJson(report));
  EXPECT_EQ(json["imbalance"]["messages"]["mean"], 2.5);
  EXPECT_EQ(json["imbalance"]["bytes_sent"]["max"], 320.0);
  report = sampleReport();
  report.counted_steps = 0;
  addMessages(MPI_COMM_WORLD, {}, report);
  EXPECT_FALSE(nlohmann::json::parse(reportJson(report))["imbalance"].contains("messages"));
}

TEST(Report, EndsWithTheFigureOfMeritAndTheVerdict) {
  std::ostringstream out;
  RunReport report = sampleReport();
  printReport(out, report);
  EXPECT_CONTAINS(out.str(), "\nFOM element_steps_per_second=500 face_searches_per_second=1200 "
                             "loop_seconds=2\nPASS\n");
  EXPECT_CONTAINS(out.str(), "\n  search ");
  EXPECT_EQ(out.str().find("only in the first step"), std::string::npos);
  report.warnings = {"printed", "new"};
  report.printed_warnings = 1;
  out.str("");
  printReport(out, report);
  EXPECT_CONTAINS(out.str(), "\nwarning: new\n");
  EXPECT_EQ(out.str().find("warning: printed"), std::string::npos);
  report.failures = {"energy error 0.2 above 0.1", "momentum"};
  printReport(out, report);
  EXPECT_CONTAINS(out.str(), "\nFAIL: energy error 0.2 above 0.1; momentum\n");
}

TEST(Report, CountsOneThingInTheSingular) {
  EXPECT_EQ(counted(1, "face"), "1 face");
  EXPECT_EQ(counted(2, "search", "searches"), "2 searches");
  RunReport report = sampleReport();
  report.elements = report.contact.searches = report.time_step.guarded_steps = 1;
  report.time_step.cuts = {{StepCut::Reason::stability, 1, 0.1, 0.1, 0.05}};
  std::ostringstream out;
  printReport(out, report);
  for (const char* words :
       {": 1 element, ", ", 1 search, ", ", cut 1 time: ", "guard active in 1 step\n"})
    EXPECT_CONTAINS(out.str(), words);
}

TEST(Report, FailsForMissedPairsAndWarnsOfLostContacts) {
  RunReport report = sampleReport();
  judgeNumbers(report);
  EXPECT_TRUE(report.pass());
  EXPECT_TRUE(report.warnings.empty());
  report.search.audit = 10;
  report.contact.missed_pairs = 3;
  report.contact.lost = 2;
  report.has_contact = true;
  judgeNumbers(report);
  EXPECT_FALSE(report.pass());
  EXPECT_CONTAINS(report.failures.at(0), "3 candidate pairs");
  EXPECT_CONTAINS(report.warnings.at(0), "beyond a bent edge of their face: 2;");
  const auto json = nlohmann::json::parse(reportJson(report));
  EXPECT_EQ(json["search"]["missed_pairs"], 3);
  EXPECT_EQ(json["pass"], false);
  EXPECT_TRUE(json["balance"].contains("contact_error"));
  EXPECT_TRUE(json["balance"].contains("penetration"));
}

TEST(Report, WarnsOfEnergiesThatAreRounding) {
  RunReport report = sampleReport();
  report.balance.peak_total = 3e-20; // not above the noise
  judgeNumbers(report);
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_CONTAINS(report.warnings[0], "at most 3e-20");
  EXPECT_TRUE(report.pass());
}

TEST(Report, WarnsOfLoadsThatMoveNothing) {
  RunReport report = sampleReport();
  report.steps = 10;
  report.balance.peak_total = 0;
  judgeNumbers(report);
  EXPECT_TRUE(report.warnings.empty());
  report.has_load = true;
  judgeNumbers(report);
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_CONTAINS(report.warnings[0], "the loads have moved nothing");
}

TEST(Report, FindsAFullDisk) {
  if (!std::filesystem::exists("/dev/full"))
    GTEST_SKIP() << "no /dev/full here";
  EXPECT_THROW(writeTextFile(MPI_COMM_WORLD, "/dev/full", reportJson(sampleReport())), OutputError);
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
