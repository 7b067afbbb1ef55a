// Times Brickwall's contact search and its peers on the same boxes of the wall W(n), in turns in
// one process, and compares their sets of pairs. Prints medians, ratios and, for Brickwall's steady
// step, the distance to the memory bandwidth of the same run. PEERS.md defines the figures.
#include "io/wall/shuffle_surface.hpp"
#include "verification/performance/benchmarks/bench_wall.hpp"
#include "verification/performance/benchmarks/own_search.hpp"
#include "verification/performance/benchmarks/timings.hpp"
#include "verification/performance/benchmarks/triad.hpp"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <cstdio>
#include <fstream>
#include <iostream>

namespace {

using namespace brickwall;
using namespace brickwall::peers;

// An estimate of the least that a search must move, the unit of the distance to the bandwidth.
constexpr double bytes_per_face = 165;

struct Options {
  int n = 8;
  contact::SearchMethod method = contact::SearchMethod::cluster;
  int repetitions = 5;
  int warmup = 2;
  int triad_mebibytes = 256;
  bool compares = true;
  bool steady = true, first = true;
  std::string only; // part of the name of the peers to run
  std::string json;
};

struct Line {
  std::string name;
  bool is_exact = true;
  Timings times;
  bool compared = false;
  PairDifference difference;

  bool passes() const {
    return difference.missing == 0 && difference.repeated == 0 &&
           (!is_exact || difference.extra == 0);
  }
};

struct Contest {
  std::string title;
  std::int64_t pairs = 0; // of all ranks, own faces included
  std::vector<Line> lines; // Brickwall's first
};

struct Runner {
  std::string name;
  std::unique_ptr<Peer> peer;
};

std::vector<Runner> runners(MPI_Comm comm, const Options& options) {
  std::vector<Runner> all;
  for (const PeerKind& kind : peerKinds())
    if ((sizeOf(comm) == 1 || kind.on_several_ranks) &&
        kind.name.find(options.only) != std::string::npos)
      all.push_back({kind.name, kind.make()});
  if (all.empty())
    throw InputError("no peer with a name that contains \"" + options.only + "\" runs on " +
                     std::to_string(sizeOf(comm)) + " rank(s)");
  return all;
}

Contest startContest(const std::string& title, const Options& options,
                     const std::vector<Runner>& peers) {
  Contest contest;
  contest.title = title;
  for (const auto& [name, method] : searchMethods())
    if (method == options.method)
      contest.lines.push_back({"Brickwall " + name, true, {}, false, {}});
  for (const Runner& runner : peers)
    contest.lines.push_back({runner.name, runner.peer->isExact(), {}, false, {}});
  return contest;
}

// One turn of all peers on the boxes of `surface`, which `ours` has just searched.
void runPeers(const exec_space& space, MPI_Comm comm, const contact::Surface& surface,
              const OwnSearch& ours, bool compares, const std::vector<Runner>& peers,
              Contest& contest) {
  const SearchBoxes boxes = searchBoxes(space, surface, ours.global().config());
  std::vector<IdPair> reference;
  if (compares) {
    reference = ours.pairsWithOwnFaces(surface);
    contest.pairs = allReduce(comm, static_cast<std::int64_t>(reference.size()), MPI_SUM);
  }
  for (std::size_t p = 0; p < peers.size(); ++p) {
    Line& line = contest.lines[p + 1];
    Peer& peer = *peers[p].peer;
    peer.prepare(space, comm, boxes);
    line.times.measure(comm, [&] { peer.search(space, comm); });
    if (compares) {
      std::vector<IdPair> found = peer.pairs();
      line.difference = comparePairs(comm, reference, found);
      line.compared = true;
    }
  }
}

// A search in every step, after some steps that are not counted: the cost of the search in a time
// step of a run.
Contest runSteadySteps(MPI_Comm comm, const Options& options, const io::SurfacePart& part) {
  const exec_space space;
  auto wall = movingWall(space, comm, options.n, part);
  OwnSearch ours(comm, wallSearch(options.n, options.method));
  const auto peers = runners(comm, options);
  Contest contest = startContest("steady step", options, peers);
  for (int step = 0; step < options.warmup + options.repetitions; ++step) {
    if (step == options.warmup)
      for (Line& line : contest.lines)
        line.times.forget();
    wall.move(space, step);
    space.fence();
    const contact::Surface surface = wall.surface();
    contest.lines[0].times.measure(comm, [&] { ours.search(space, surface); });
    const bool last = step + 1 == options.warmup + options.repetitions;
    if (step >= options.warmup)
      runPeers(space, comm, surface, ours, options.compares && last, peers, contest);
  }
  return contest;
}

// The first search of new objects, with nodes and faces in random order.
Contest runFirstSteps(MPI_Comm comm, const Options& options, io::SurfacePart part) {
  const exec_space space;
  io::shuffleSurface(2, part);
  auto wall = movingWall(space, comm, options.n, part);
  auto peers = runners(comm, options);
  Contest contest = startContest("first step, shuffled input", options, peers);
  for (int repetition = 0; repetition < options.repetitions; ++repetition) {
    peers = runners(comm, options);
    wall.move(space, repetition);
    space.fence();
    const contact::Surface surface = wall.surface();
    OwnSearch ours(comm, wallSearch(options.n, options.method));
    contest.lines[0].times.measure(comm, [&] { ours.search(space, surface); });
    const bool last = repetition + 1 == options.repetitions;
    runPeers(space, comm, surface, ours, options.compares && last, peers, contest);
  }
  return contest;
}

std::string verdict(const Line& line) {
  if (!line.compared)
    return "";
  const PairDifference& d = line.difference;
  if (d.missing == 0 && d.extra == 0 && d.repeated == 0)
    return "same pairs";
  return std::to_string(d.missing) + " missing, " + std::to_string(d.extra) + " extra, " +
         std::to_string(d.repeated) + " repeated" +
         (line.passes() ? " (rounded outward to float)" : ": NOT THE SAME PAIRS");
}

void print(const Contest& contest) {
  std::printf("\n%s%s\n%-36s %10s %10s %10s %8s\n", contest.title.c_str(),
              contest.pairs > 0 ? (", " + std::to_string(contest.pairs) + " pairs").c_str() : "",
              "", "median ms", "min", "max", "ratio");
  for (const Line& line : contest.lines)
    std::printf("%-36s %10.2f %10.2f %10.2f %8.2f  %s\n", line.name.c_str(),
                1e3 * line.times.median(), 1e3 * line.times.shortest(), 1e3 * line.times.longest(),
                line.times.median() / contest.lines[0].times.median(), verdict(line).c_str());
}

nlohmann::json toJson(const Contest& contest) {
  nlohmann::json lines = nlohmann::json::array();
  for (const Line& line : contest.lines)
    lines.push_back({{"name", line.name},
                     {"median_seconds", line.times.median()},
                     {"min_seconds", line.times.shortest()},
                     {"max_seconds", line.times.longest()},
                     {"compared", line.compared},
                     {"missing", line.difference.missing},
                     {"extra", line.difference.extra},
                     {"repeated", line.difference.repeated}});
  return {{"title", contest.title}, {"pairs", contest.pairs}, {"lines", lines}};
}

// Returns whether all compared sets are right.
bool runAll(MPI_Comm comm, const Options& options) {
  const io::SurfacePart part = wallSurface(comm, options.n);
  const bool prints = rankOf(comm) == 0;
  const auto owned = std::count(part.node_owner.begin(), part.node_owner.end(), rankOf(comm));
  const auto num_nodes = allReduce(comm, static_cast<std::int64_t>(owned), MPI_SUM);
  if (prints)
    std::printf("wall W(%d): %lld faces, %lld nodes; %d rank(s) x %d thread(s); %d repetitions\n",
                options.n, static_cast<long long>(part.num_global_faces),
                static_cast<long long>(num_nodes), sizeOf(comm), concurrency(exec_space()),
                options.repetitions);
  double bandwidth = triadBandwidth(comm, options.triad_mebibytes);
  std::vector<Contest> contests;
  if (options.steady)
    contests.push_back(runSteadySteps(comm, options, part));
  if (options.first)
    contests.push_back(runFirstSteps(comm, options, part));
  bandwidth = std::max(bandwidth, triadBandwidth(comm, options.triad_mebibytes));
  const double floor = bytes_per_face * static_cast<double>(part.num_global_faces) / bandwidth;
  bool passed = true;
  nlohmann::json report = {{"n", options.n},
                           {"faces", part.num_global_faces},
                           {"nodes", num_nodes},
                           {"ranks", sizeOf(comm)},
                           {"threads", concurrency(exec_space())},
                           {"triad_bytes_per_second", bandwidth}};
  for (const Contest& contest : contests) {
    if (prints)
      print(contest);
    report["contests"].push_back(toJson(contest));
    for (const Line& line : contest.lines)
      passed = passed && line.passes();
  }
  if (prints) {
    std::printf("\ntriad %.2f GB/s; %.0f bytes per face take %.3f ms at that rate\n",
                1e-9 * bandwidth, bytes_per_face, 1e3 * floor);
    if (options.steady)
      std::printf("Brickwall's steady step takes %.2f times as long\n",
                  contests[0].lines[0].times.median() / floor);
    if (!options.json.empty() && !(std::ofstream(options.json) << report.dump(2) << '\n'))
      throw OutputError("cannot write " + options.json);
  }
  return passed;
}

int runInsideKokkos(MPI_Comm comm, const Options& options) {
  try {
    return runAll(comm, options) ? 0 : 1;
  } catch (const std::exception& error) {
    std::cerr << "peer_search: " << error.what() << '\n';
    MPI_Abort(comm, 1);
    return 1;
  }
}

} // namespace

int main(int argc, char** argv) {
  Options options;
  std::string contests = "both";
  CLI::App app("Times Brickwall's contact search and its peers on the wall W(n)");
  app.add_option("-n,--size", options.n, "n of W(n), 4350 n^2 faces")->check(CLI::PositiveNumber);
  app.add_option("--method", options.method, "Brickwall's method")
      ->transform(CLI::CheckedTransformer(searchMethods()));
  app.add_option("--repetitions", options.repetitions)->check(CLI::PositiveNumber);
  app.add_option("--warmup", options.warmup, "steady steps that are not counted")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--contest", contests)->check(CLI::IsMember({"steady", "first", "both"}));
  app.add_option("--peers", options.only, "run only peers whose names contain this");
  app.add_option("--triad-mib", options.triad_mebibytes,
                 "size of each triad array, many times the caches")
      ->check(CLI::PositiveNumber);
  app.add_flag("!--no-compare", options.compares, "do not compare the sets of pairs");
  app.add_option("--json", options.json, "write the figures to this file");
  CLI11_PARSE(app, argc, argv);
  options.steady = contests != "first";
  options.first = contests != "steady";

  int provided = 0;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided);
  Kokkos::initialize();
  const int code = runInsideKokkos(MPI_COMM_WORLD, options);
  Kokkos::finalize();
  MPI_Finalize();
  return code;
}
