// Times Brickwall's migration of ghost faces beside Zoltan's (the paper's Fig. 9): both send the
// same faces of the wall W(n) to the same ranks, the same number of bytes a face, in turns in one
// process. The ghosts must be equal bit by bit. Needs at least two ranks.
#include "contact/base/to_device.hpp"
#include "contact/search/exchange/face_migration.hpp"
#include "verification/performance/benchmarks/bench_wall.hpp"
#include "verification/performance/benchmarks/own_search.hpp"
#include "verification/performance/benchmarks/timings.hpp"
#include "verification/performance/peers/zoltan_migration.hpp"

#include <CLI/CLI.hpp>

#include <cstdio>
#include <cstring>
#include <iostream>
#include <unordered_map>

namespace {

using namespace brickwall;
using namespace brickwall::peers;

struct Exports {
  std::vector<int> faces, destinations; // local face and rank, by rank
  contact::PartnerLists lists; // the same for Brickwall's migration
  std::vector<int> senders;
};

// Collective.
Exports findExports(const exec_space& space, MPI_Comm comm, const contact::Surface& surface,
                    const contact::GlobalSearch& search) {
  const auto ids = toHost(surface.face_ids);
  std::unordered_map<global_id, int> face_of;
  for (int face = 0; face < surface.num_faces; ++face)
    face_of[ids(face)] = face;
  Exports exports;
  std::vector<std::vector<char>> notices(sizeOf(comm)); // not empty for ranks that receive faces
  for (const contact::SentFace& sent : search.sentFaces(space, surface)) {
    exports.faces.push_back(face_of.at(sent.face));
    exports.destinations.push_back(sent.destination);
    notices[sent.destination] = {1};
    auto& lists = exports.lists;
    if (lists.ranks.empty() || lists.ranks.back() != sent.destination) {
      lists.ranks.push_back(sent.destination);
      lists.offsets.push_back(lists.offsets.back());
    }
    ++lists.offsets.back();
  }
  contact::copyToDevice(space, exports.faces, exports.lists.rows);
  const auto received = exchangeByRank(comm, notices);
  for (int rank = 0; rank < sizeOf(comm); ++rank)
    if (!received[rank].empty())
      exports.senders.push_back(rank);
  return exports;
}

std::vector<FaceRecord> recordsOf(const contact::GhostFaces& ghosts) {
  const auto ids = toHost(ghosts.face_ids), bodies = toHost(ghosts.bodies);
  const auto corners = toHost(ghosts.corner_ids);
  const auto x_old = toHost(ghosts.coordinates_old), x_new = toHost(ghosts.coordinates_new);
  std::vector<FaceRecord> records(static_cast<std::size_t>(ghosts.count));
  for (int g = 0; g < ghosts.count; ++g) {
    records[g].face = ids(g);
    records[g].body = bodies(g);
    for (int c = 0; c < 4; ++c)
      records[g].corners[c] = corners(g, c);
    for (int i = 0; i < 12; ++i) {
      records[g].x_old[i] = x_old(g, i);
      records[g].x_new[i] = x_new(g, i);
    }
  }
  return records;
}

// The order of arrival is the library's own.
bool sameRecords(std::vector<FaceRecord> a, std::vector<FaceRecord> b) {
  const auto by_face = [](const FaceRecord& x, const FaceRecord& y) { return x.face < y.face; };
  std::sort(a.begin(), a.end(), by_face);
  std::sort(b.begin(), b.end(), by_face);
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(FaceRecord)) == 0);
}

// Returns whether both gave the same ghosts in every repetition.
bool compareMigrations(MPI_Comm comm, int n, contact::SearchMethod method, int repetitions) {
  const exec_space space;
  const io::SurfacePart part = wallSurface(comm, n);
  auto wall = movingWall(space, comm, n, part);
  contact::GlobalSearch search(comm, wallSearch(n, method));
  Timings whole, ours, zoltans;
  contact::FaceMigration migration;
  const bool announces_sizes = method != contact::SearchMethod::cluster;
  bool same = true;
  std::int64_t num_ghosts = 0;
  constexpr int warmup = 2;
  for (int step = 0; step < warmup + repetitions; ++step) {
    if (step == warmup)
      for (Timings* times : {&whole, &ours, &zoltans})
        times->forget();
    wall.move(space, step);
    space.fence();
    const contact::Surface surface = wall.surface();
    whole.measure(comm, [&] {
      search.findGhosts(space, surface);
      space.fence();
    });
    const Exports exports = findExports(space, comm, surface, search);
    ZoltanMigration zoltan(comm, surface, exports.faces, exports.destinations);
    const std::vector<FaceRecord>* received = nullptr;
    const auto migrateOurs = [&] {
      contact::migrateFaces(space, comm, surface, exports.lists, exports.senders, 0,
                            announces_sizes, migration);
      space.fence();
    };
    const auto migrateZoltans = [&] { received = &zoltan.migrate(); };
    if (step % 2 == 0) // the first to run after the set-up above is at a disadvantage
      ours.measure(comm, migrateOurs);
    zoltans.measure(comm, migrateZoltans);
    if (step % 2 == 1)
      ours.measure(comm, migrateOurs);
    const auto found = recordsOf(search.ghosts());
    same = same && sameRecords(recordsOf(migration.ghosts), found) && sameRecords(*received, found);
    num_ghosts = allReduce(comm, static_cast<std::int64_t>(found.size()), MPI_SUM);
  }
  same = allReduce(comm, same ? 1 : 0, MPI_MIN) == 1;
  if (rankOf(comm) == 0) {
    std::printf("wall W(%d): %lld faces, %lld ghosts of %zu bytes; %d ranks x %d thread(s), %d "
                "repetitions\n",
                n, static_cast<long long>(part.num_global_faces),
                static_cast<long long>(num_ghosts), sizeof(FaceRecord), sizeOf(comm),
                concurrency(space), repetitions);
    std::printf("%-36s %10s %10s %10s %8s\n", "", "median ms", "min", "max", "ratio");
    const auto print = [&](const char* name, const Timings& times) {
      std::printf("%-36s %10.3f %10.3f %10.3f %8.2f\n", name, 1e3 * times.median(),
                  1e3 * times.shortest(), 1e3 * times.longest(), times.median() / ours.median());
    };
    print("Brickwall's migration", ours);
    print("Zoltan_Migrate", zoltans);
    print("Brickwall's whole global search", whole);
    std::printf("%s\n", same ? "same ghosts, bit by bit" : "NOT THE SAME GHOSTS");
  }
  return same && num_ghosts > 0;
}

} // namespace

int main(int argc, char** argv) {
  int n = 8, repetitions = 11;
  contact::SearchMethod method = contact::SearchMethod::cluster;
  CLI::App app("Times the migration of ghost faces beside Zoltan's on the wall W(n)");
  app.add_option("-n,--size", n, "n of W(n), 4350 n^2 faces")->check(CLI::PositiveNumber);
  app.add_option("--method", method, "Brickwall's method")
      ->transform(CLI::CheckedTransformer(searchMethods()));
  app.add_option("--repetitions", repetitions)->check(CLI::PositiveNumber);
  CLI11_PARSE(app, argc, argv);

  int provided = 0;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided);
  Kokkos::initialize();
  int code = 1;
  try {
    code = compareMigrations(MPI_COMM_WORLD, n, method, repetitions) ? 0 : 1;
  } catch (const std::exception& error) {
    std::cerr << "peer_migration: " << error.what() << '\n';
    MPI_Abort(MPI_COMM_WORLD, 1);
  }
  Kokkos::finalize();
  MPI_Finalize();
  return code;
}
