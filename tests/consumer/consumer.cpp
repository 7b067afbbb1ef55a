// Uses the installed contact library alone: two unit squares that face each other closely. Each corner of the one may
// touch the other, and no corner lists its own square.
#include "contact/global_search.hpp"
#include "contact/local_search.hpp"

#include <mpi.h>

#include <cstdio>
#include <string>

namespace {

using namespace brickwall;

// A device View with the values that `value(row, column)` gives.
template <class ViewType, class Value>
ViewType fill(const std::string& label, int rows, Value value) {
  ViewType view(label, rows);
  auto host = Kokkos::create_mirror_view(view);
  for (int row = 0; row < rows; ++row)
    value(host, row);
  Kokkos::deep_copy(view, host);
  return view;
}

contact::Surface twoSquares(double gap) {
  contact::Surface surface;
  surface.num_nodes = 8;
  surface.num_faces = 2;
  const auto coordinates = fill<View<double* [3]>>("coordinates", 8, [gap](auto& view, int node) {
    const int corner = node % 4;
    view(node, 0) = corner == 1 || corner == 2 ? 1 : 0;
    view(node, 1) = corner >= 2 ? 1 : 0;
    view(node, 2) = node < 4 ? 0 : gap;
  });
  surface.coordinates_old = coordinates;
  surface.coordinates_new = coordinates;
  surface.face_to_nodes = fill<View<int* [4]>>("face_to_nodes", 2, [](auto& view, int face) {
    for (int corner = 0; corner < 4; ++corner)
      view(face, corner) = face == 0 ? corner : 7 - corner;
  });
  const auto own_number = [](auto& view, int i) { view(i) = i; };
  surface.node_ids = fill<View<global_id*>>("node_ids", 8, own_number);
  surface.face_ids = fill<View<global_id*>>("face_ids", 2, own_number);
  surface.face_body = surface.face_ids;
  surface.node_body =
      fill<View<global_id*>>("node_body", 8, [](auto& view, int node) { view(node) = node / 4; });
  surface.node_is_owned =
      fill<View<unsigned char*>>("node_is_owned", 8, [](auto& view, int node) { view(node) = 1; });
  return surface;
}

std::int64_t countPairs() {
  const exec_space space;
  contact::SearchConfig config;
  config.node_tolerance = config.face_tolerance = 0.05;
  contact::GlobalSearch global_search(MPI_COMM_SELF, config);
  contact::LocalSearch local_search(config);
  const contact::Surface surface = twoSquares(0.01);
  global_search.findGhosts(space, surface);
  return local_search.findCandidatePairs(space, surface, global_search).count;
}

} // namespace

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  Kokkos::initialize();
  const std::int64_t pairs = countPairs();
  Kokkos::finalize();
  MPI_Finalize();
  std::printf("%lld candidate pairs, 8 expected\n", static_cast<long long>(pairs));
  return pairs == 8 ? 0 : 1;
}
