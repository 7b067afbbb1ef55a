// Worked example of CONTRIBUTING.md, "Adding a contact law": a host's own law on the candidate
// pairs of the search, here Hertz's F = k p^1.5, without history or friction. Ranks add forces
// exactly.
#include "contact/base/to_device.hpp"
#include "contact/search/candidate_search.hpp"
#include "contact/surface/face_access.hpp"

#include <gtest/gtest.h>

namespace brickwall::contact {
namespace {

// The forces of the rows of one rank, in quanta: on its nodes, and on the corners of its ghosts.
struct HertzForces {
  FaceAccess faces;
  CandidatePairs pairs;
  double stiffness, deepest; // force/length^1.5, length
  Quantum quantum;
  View<std::int64_t* [3]> of_nodes;
  View<std::int64_t* [12]> of_ghosts; // [ghost][3 * corner + xyz]

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t row) const {
    const int node = pairs.node(row);
    for (std::int64_t i = pairs.begin(row); i < pairs.end(row); ++i) {
      const int face = pairs.faces(i);
      const FacePoint at = project(faces.quad(face), rowOf(faces.surface.coordinates_new, node));
      const double depth = -at.gap;
      if (!at.activeWithin(0.05) || !(depth > 0) || depth > deepest)
        continue;
      const Vec3 force = (stiffness * depth * std::sqrt(depth)) * at.normal; // on the node
      for (int d = 0; d < 3; ++d) {
        // The corners' parts are rounded, and the node gets what balances them exactly.
        std::int64_t sum = 0;
        for (int j = 0; j < 4; ++j) {
          const std::int64_t part = roundToFixed(-quantum.inverse * at.weight[j] * force[d]);
          Kokkos::atomic_add(faces.isOwn(face) ? &of_nodes(faces.surface.face_to_nodes(face, j), d)
                                               : &of_ghosts(faces.ghostOf(face), 3 * j + d),
                             part);
          sum += part;
        }
        Kokkos::atomic_add(&of_nodes(node, d), -sum);
      }
    }
  }
};

// Two unit squares that face each other, the upper one 0.01 below the lower one's surface; with
// several ranks, each on a rank of its own, and the other ranks have none.
Surface squareOfRank(int square, int num_squares) {
  std::vector<global_id> node_ids, node_bodies, face_ids;
  std::vector<double> x;
  std::vector<int> corners;
  for (int s = square; s < square + num_squares; ++s) {
    for (int c = 0; c < 4; ++c) {
      const int around = s == 0 ? c : 3 - c; // outward normals +z and -z
      x.insert(x.end(), {around % 3 == 0 ? 0.0 : 1.0, around < 2 ? 0.0 : 1.0, -0.01 * s});
      corners.push_back(static_cast<int>(node_ids.size()));
      node_ids.push_back(4 * s + c);
      node_bodies.push_back(s);
    }
    face_ids.push_back(s);
  }
  Surface surface;
  surface.num_nodes = static_cast<int>(node_ids.size());
  surface.num_faces = static_cast<int>(face_ids.size());
  View<double* [3]> coordinates("x", surface.num_nodes);
  View<int* [4]> face_to_nodes("faces", surface.num_faces);
  View<unsigned char*> owned("owned", surface.num_nodes);
  auto host_x = Kokkos::create_mirror_view(coordinates);
  auto host_faces = Kokkos::create_mirror_view(face_to_nodes);
  for (int i = 0; i < 3 * surface.num_nodes; ++i)
    host_x(i / 3, i % 3) = x[i];
  for (int i = 0; i < 4 * surface.num_faces; ++i)
    host_faces(i / 4, i % 4) = corners[i];
  Kokkos::deep_copy(coordinates, host_x);
  Kokkos::deep_copy(face_to_nodes, host_faces);
  const exec_space space;
  Kokkos::deep_copy(owned, static_cast<unsigned char>(1));
  surface.coordinates_old = surface.coordinates_new = coordinates;
  surface.face_to_nodes = face_to_nodes;
  surface.node_ids = toDevice(space, "node_ids", node_ids);
  surface.face_ids = surface.face_body = toDevice(space, "face_ids", face_ids);
  surface.node_is_owned = owned;
  surface.node_body = toDevice(space, "node_body", node_bodies);
  return surface;
}

// Each square has four nodes in contact, and the reactions of the other one's: 8 k p^1.5, exactly
// opposite. Weights of 1 at the corners; one rounding per contact, half a quantum, 2^-54.
TEST(ExampleContactLaw, SquaresPressEachOtherApart) {
  const exec_space space;
  const int rank = rankOf(MPI_COMM_WORLD), size = sizeOf(MPI_COMM_WORLD);
  const Surface surface = size == 1 ? squareOfRank(0, 2) : squareOfRank(rank, rank < 2 ? 1 : 0);
  SearchConfig config;
  config.node_tolerance = config.face_tolerance = 0.02;
  CandidateSearch search(MPI_COMM_WORLD, config);
  const CandidatePairs& pairs = search.update(space, surface); // in each step; collective
  const Quantum quantum = Quantum::forForceScale(1.0);
  const View<std::int64_t* [3]> of_nodes("of_nodes", surface.num_nodes);
  const View<std::int64_t* [12]> of_ghosts("of_ghosts", search.ghosts().count);
  Kokkos::parallel_for(
      "example::HertzForces", rangePolicy(space, pairs.num_rows),
      HertzForces{{surface, search.ghosts()}, pairs, 100, 0.05, quantum, of_nodes, of_ghosts});
  search.reverseSum(space, surface.face_to_nodes, of_ghosts, of_nodes);
  const auto forces = toHost(of_nodes);
  const auto bodies = toHost(surface.node_body);
  std::int64_t on_body[2] = {0, 0};
  for (int node = 0; node < surface.num_nodes; ++node)
    on_body[bodies(node)] += forces(node, 2);
  for (std::int64_t& sum : on_body)
    sum = allReduce(MPI_COMM_WORLD, sum, MPI_SUM);
  EXPECT_EQ(on_body[0], -on_body[1]);
  EXPECT_NEAR(quantum.value * on_body[1], 8 * 100 * 0.01 * 0.1, 1e-15);
}

} // namespace
} // namespace brickwall::contact
