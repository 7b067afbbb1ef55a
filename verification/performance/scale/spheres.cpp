// Touching spheres in a lattice, as in ArborX's benchmarks/distributed_contact: each rank has the
// outer layer of a cube of ROWS^3 triangulated spheres of diameter 1 at distances of 0.8. The boxes
// of the triangles of every second sphere look for overlaps among those of the others: with 40
// rows, 4.65 million boxes each. A looking box is a node that moves from one corner of the box to
// the opposite one, another box is a face all of whose corners are one such node. Positions are
// computed in float, as there.
//   contact_spheres [--rows N] [--sphere FILE] [--repetitions N] [--check]
// FILE: ArborX's unit_sphere.txt; otherwise a sphere of as many triangles, 1018, is made. --check
// compares the number of pairs with plain loops. Prints JSON.
#include "contact/base/mpi.hpp"
#include "contact/base/to_device.hpp"
#include "contact/search/candidate_search.hpp"
#include "verification/performance/benchmarks/benchmark_main.hpp"
#include "verification/performance/benchmarks/timings.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

namespace brickwall::contact {
namespace {

constexpr float diameter = 1, distance = 0.8f;

struct Options {
  int rows = 40, repetitions = 5;
  std::string sphere;
  bool checks = false;
};

struct Sphere {
  std::vector<std::array<float, 3>> points;
  std::vector<std::array<int, 3>> triangles;
};

Sphere readSphere(const std::string& file) {
  std::ifstream input(file);
  std::size_t num_points = 0, num_triangles = 0;
  if (!(input >> num_points >> num_triangles))
    throw InputError(file + ": no numbers of points and triangles");
  Sphere sphere;
  sphere.points.resize(num_points);
  sphere.triangles.resize(num_triangles);
  for (auto& point : sphere.points)
    input >> point[0] >> point[1] >> point[2];
  for (auto& triangle : sphere.triangles)
    for (int& corner : triangle) {
      input >> corner;
      --corner;
    }
  if (!input)
    throw InputError(file + ": too short");
  return sphere;
}

// 511 points and 1018 triangles of about equal size: rings of points between two poles.
Sphere makeSphere() {
  constexpr int num_rings = 19, ring_points = 509;
  const double pi = std::acos(-1.0);
  std::vector<int> counts;
  int rest = ring_points;
  for (int ring = 1; ring <= num_rings; ++ring) {
    counts.push_back(static_cast<int>(40 * std::sin(pi * ring / (num_rings + 1))));
    rest -= counts.back();
  }
  counts[num_rings / 2] += rest; // the equator
  Sphere sphere;
  const auto add = [&](double z, double radius, double angle) {
    sphere.points.push_back({float(0.5 * diameter * radius * std::cos(angle)),
                             float(0.5 * diameter * radius * std::sin(angle)),
                             float(0.5 * diameter * z)});
  };
  add(1, 0, 0);
  int first = 0, count = 1; // of the ring above
  for (int ring = 1; ring <= num_rings + 1; ++ring) {
    const double polar = pi * ring / (num_rings + 1);
    const int next = static_cast<int>(sphere.points.size());
    const int points = ring <= num_rings ? counts[std::size_t(ring) - 1] : 1;
    for (int i = 0; i < points; ++i)
      add(std::cos(polar), ring <= num_rings ? std::sin(polar) : 0, 2 * pi * i / points);
    // Around both rings at once: the next triangle is on the side that lags behind.
    for (int a = 0, b = 0; a < (count > 1 ? count : 0) || b < (points > 1 ? points : 0);) {
      const bool on_next =
          points > 1 && (count == 1 || double(b) / points <= double(a) / count) && b < points;
      if (on_next || a >= count || count == 1) {
        sphere.triangles.push_back({first + a % count, next + b % points, next + (b + 1) % points});
        ++b;
      } else {
        sphere.triangles.push_back({first + a % count, next + b % points, first + (a + 1) % count});
        ++a;
      }
    }
    first = next;
    count = points;
  }
  return sphere;
}

struct RankBoxesOfSpheres {
  std::vector<Box> looking, others;
  std::vector<global_id> looking_spheres, other_spheres;
};

// The boxes of rank `rank` of `size`, whose cubes stand in a cube of the largest whole number of
// ranks.
RankBoxesOfSpheres boxesOf(const Sphere& sphere, int rows, int rank, int size) {
  const int side = static_cast<int>(std::cbrt(size));
  const int place[3] = {rank / (side * side), rank % (side * side) / side, rank % side};
  RankBoxesOfSpheres boxes;
  const auto isInside = [&](int i) { return i > 0 && i < rows - 1; };
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < rows; ++j)
      for (int k = 0; k < rows; ++k) {
        if (isInside(i) && isInside(j) && isInside(k))
          continue;
        const bool looks = (i + j + k) % 2 == 0;
        const int at[3] = {i, j, k};
        float offset[3];
        for (int d = 0; d < 3; ++d)
          offset[d] = float(place[d] * rows) * distance + float(at[d]) * distance;
        const global_id id = ((global_id(rank) * rows + i) * rows + j) * rows + k;
        for (const auto& triangle : sphere.triangles) {
          Box box;
          for (const int corner : triangle) {
            const auto& p = sphere.points[std::size_t(corner)];
            box.include(Vec3{p[0] + offset[0], p[1] + offset[1], p[2] + offset[2]});
          }
          (looks ? boxes.looking : boxes.others).push_back(box);
          (looks ? boxes.looking_spheres : boxes.other_spheres).push_back(id);
        }
      }
  return boxes;
}

SweptBoxes onDevice(const exec_space& space, const RankBoxesOfSpheres& boxes, int rank) {
  const std::size_t num_looking = boxes.looking.size(), num_faces = boxes.others.size();
  const std::size_t num_nodes = num_looking + num_faces;
  std::vector<double> low, high;
  std::vector<global_id> ids, bodies(boxes.looking_spheres), face_ids;
  std::vector<int> corners;
  std::vector<unsigned char> owned(num_nodes, 0); // boxes of faces do not look for others
  std::fill_n(owned.begin(), num_looking, 1);
  bodies.insert(bodies.end(), boxes.other_spheres.begin(), boxes.other_spheres.end());
  for (const auto* list : {&boxes.looking, &boxes.others})
    for (const Box& box : *list) {
      low.insert(low.end(), box.lower, box.lower + 3);
      high.insert(high.end(), box.upper, box.upper + 3);
    }
  const global_id first = global_id(rank) << 32;
  for (std::size_t i = 0; i < num_nodes; ++i)
    ids.push_back(first + static_cast<global_id>(i));
  for (std::size_t i = 0; i < num_faces; ++i) {
    face_ids.push_back(first + static_cast<global_id>(i));
    corners.insert(corners.end(), 4, static_cast<int>(num_looking + i));
  }
  SweptBoxes swept;
  swept.num_nodes = checkedInt(std::int64_t(num_nodes), "boxes");
  swept.num_faces = checkedInt(std::int64_t(num_faces), "boxes");
  swept.coordinates_old = toDevice<View<double* [3]>>(space, "spheres::low", low);
  swept.coordinates_new = toDevice<View<double* [3]>>(space, "spheres::high", high);
  swept.face_to_nodes = toDevice<View<int* [4]>>(space, "spheres::corners", corners);
  swept.node_ids = toDevice(space, "spheres::ids", ids);
  swept.face_ids = toDevice(space, "spheres::face_ids", face_ids);
  swept.node_is_owned = toDevice(space, "spheres::owned", owned);
  swept.node_body = toDevice(space, "spheres::bodies", bodies);
  swept.face_body = toDevice(space, "spheres::face_bodies", boxes.other_spheres);
  return swept;
}

std::int64_t countByLoops(const Sphere& sphere, int rows, MPI_Comm comm,
                          const RankBoxesOfSpheres& own) {
  std::int64_t pairs = 0;
  for (int q = 0; q < sizeOf(comm); ++q)
    for (const Box& other : boxesOf(sphere, rows, q, sizeOf(comm)).others)
      for (const Box& box : own.looking)
        pairs += box.overlaps(other);
  return allReduce(comm, pairs, MPI_SUM);
}

void run(const Options& options) {
  const MPI_Comm comm = MPI_COMM_WORLD;
  const exec_space space;
  const int rank = rankOf(comm), size = sizeOf(comm);
  const Sphere sphere = options.sphere.empty() ? makeSphere() : readSphere(options.sphere);
  RankBoxesOfSpheres boxes = boxesOf(sphere, options.rows, rank, size);
  const SweptBoxes swept = onDevice(space, boxes, rank);
  CandidateSearch search(comm, SearchConfig());
  peers::Timings first, steady, global;
  first.measure(comm, [&] {
    search.update(space, swept);
    space.fence();
  });
  for (int i = 0; i < options.repetitions; ++i) {
    steady.measure(comm, [&] {
      search.update(space, swept);
      space.fence();
    });
    global.measure(comm, [&] {
      search.updateGhosts(space, swept);
      space.fence();
    });
  }
  search.update(space, swept);
  const SearchStatistics counts = search.statistics();
  const auto sum = [&](std::int64_t value) {
    return static_cast<long long>(allReduce(comm, value, MPI_SUM));
  };
  const long long pairs = sum(search.pairs().count), ghosts = sum(counts.num_ghosts);
  const long long node_boxes = sum(counts.node_boxes_sent);
  const int partners = allReduce(comm, counts.num_partners, MPI_MAX);
  if (options.checks && countByLoops(sphere, options.rows, comm, boxes) != pairs)
    throw Error(ExitCode::internal, "spheres: plain loops find another number of pairs");
  if (rank == 0)
    std::printf(
        "{\"ranks\": %d, \"rows\": %d, \"triangles\": %zu, \"looking_boxes\": %d, "
        "\"boxes\": %d, \"pairs\": %lld, \"ghosts\": %lld, \"node_boxes_sent\": %lld, "
        "\"most_partners\": %d, \"first_seconds\": %.6g, \"steady_seconds\": {\"min\": %.6g, "
        "\"median\": %.6g, \"max\": %.6g}, \"global_seconds\": %.6g}\n",
        size, options.rows, sphere.triangles.size(), swept.num_nodes - swept.num_faces,
        swept.num_faces, pairs, ghosts, node_boxes, partners, first.median(), steady.shortest(),
        steady.median(), steady.longest(), global.median());
}

Options optionsOf(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--check")
      options.checks = true;
    else if (i + 1 < argc && word == "--rows")
      options.rows = std::max(1, std::atoi(argv[++i]));
    else if (i + 1 < argc && word == "--repetitions")
      options.repetitions = std::max(1, std::atoi(argv[++i]));
    else if (i + 1 < argc && word == "--sphere")
      options.sphere = argv[++i];
    else
      throw InputError(
          "usage: contact_spheres [--rows N] [--sphere FILE] [--repetitions N] [--check]");
  }
  return options;
}

} // namespace
} // namespace brickwall::contact

int main(int argc, char** argv) {
  return brickwall::benchmarkMain(
      argc, argv, [&] { brickwall::contact::run(brickwall::contact::optionsOf(argc, argv)); });
}
