#include "contact/search/cluster/cluster_order.hpp"

#include "contact/base/mpi.hpp"
#include "contact/search/cluster/cluster_bodies.hpp"
#include "contact/search/exchange/partner_lists.hpp"
#include "contact/search/spatial/hilbert.hpp"
#include "contact/search/spatial/radix_sort.hpp"
#include "contact/surface/candidate_rows.hpp"

#include <algorithm>
#include <vector>

namespace brickwall::contact {
namespace {

KOKKOS_INLINE_FUNCTION Vec3 centroidOf(const View<const int* [4]>& face_to_nodes,
                                       const View<const double* [3]>& x, std::int64_t face) {
  Vec3 sum;
  for (int corner = 0; corner < 4; ++corner)
    sum += rowOf(x, face_to_nodes(face, corner));
  return 0.25 * sum;
}

// Keys and values of n rows without the spare rows of growTo(), since this scratch is the peak
// memory of the search.
SortedKeys scratchFor(const exec_space& space, std::int64_t n) {
  SortedKeys scratch;
  scratch.keys = allocate<View<std::uint64_t*>>(space, "contact::ClusterOrder::keys", n);
  scratch.values = allocate<View<int*>>(space, "contact::ClusterOrder::values", n);
  scratch.other_keys = allocate<View<std::uint64_t*>>(space, "contact::ClusterOrder::keys", n);
  scratch.other_values = allocate<View<int*>>(space, "contact::ClusterOrder::values", n);
  return scratch;
}

// The median of the finite values; 0 if there are none.
double medianOf(const exec_space& space, const View<double*>& values) {
  std::vector<double> finite;
  copyToHost(space, values, static_cast<std::int64_t>(values.extent(0)), finite);
  finite.erase(std::remove_if(finite.begin(), finite.end(),
                              [](const double value) { return !std::isfinite(value); }),
               finite.end());
  if (finite.empty())
    return 0;
  const auto middle = finite.begin() + static_cast<std::ptrdiff_t>(finite.size() / 2);
  std::nth_element(finite.begin(), middle, finite.end());
  return *middle;
}

// Sorts every run of Width entries. Within a run the order of the host is as good, makes its memory
// faster to read, and rows of candidates faster to sort.
template <int Width>
void sortWithin(const exec_space& space, const View<int*>& order, std::int64_t n) {
  Kokkos::parallel_for(
      "contact::ClusterOrder::sortWithin", rangePolicy(space, dividedUp(n, Width)),
      KOKKOS_LAMBDA(const std::int64_t run) {
        sortRow(&order(run * Width), minOf<std::int64_t>(Width, n - run * Width),
                [](const int a, const int b) { return a < b; });
      });
}

// The curve through the faces of a surface, or through its nodes if it has no faces.
struct Curve {
  MortonGrid grid;
  int bits = 0;

  KOKKOS_INLINE_FUNCTION std::uint64_t operator()(const Vec3& point) const {
    return hilbertCode(grid, point, bits);
  }
};

Curve layCurve(const exec_space& space, const SweptBoxes& surface, ClusterOrder& order) {
  const bool by_faces = surface.num_faces > 0;
  const std::int64_t n = by_faces ? surface.num_faces : surface.num_nodes;
  const View<const int* [4]> face_to_nodes = surface.face_to_nodes;
  const View<const double* [3]> x = surface.coordinates_new;
  const std::int64_t num_samples = minOf<std::int64_t>(n, 4096);
  View<Vec3*> sample("contact::ClusterOrder::sample", static_cast<std::size_t>(num_samples));
  View<double*> extents("contact::ClusterOrder::extents", static_cast<std::size_t>(num_samples));
  Kokkos::parallel_for(
      "contact::layCurve::sample", rangePolicy(space, num_samples),
      KOKKOS_LAMBDA(const std::int64_t i) {
        const std::int64_t at = i * n / num_samples;
        sample(i) = by_faces ? centroidOf(face_to_nodes, x, at) : rowOf(x, at);
        if (by_faces)
          extents(i) = norm(rowOf(x, face_to_nodes(at, 2)) - rowOf(x, face_to_nodes(at, 0)));
      });
  const Box box = boxWithoutOutliers(space, sample, num_samples);
  const Vec3 centre = box.empty() ? Vec3() : box.centroid();
  if (std::isfinite(norm(centre)))
    order.origin = centre;
  Curve curve;
  curve.grid = MortonGrid(box);
  curve.bits = hilbertBits(2097151.0 / curve.grid.cells_per_length, medianOf(space, extents));
  return curve;
}

// Sorts the rows (values) stably by an id of the face that each names.
void sortById(const exec_space& space, const View<const global_id*>& ids, std::int64_t n,
              SortedKeys& sorted) {
  global_id least = 0, most = 0;
  Kokkos::parallel_reduce(
      "contact::sortById::least", rangePolicy(space, n),
      KOKKOS_LAMBDA(const std::int64_t i, global_id& found) { found = minOf(found, ids(i)); },
      Kokkos::Min<global_id>(least));
  Kokkos::parallel_reduce(
      "contact::sortById::most", rangePolicy(space, n),
      KOKKOS_LAMBDA(const std::int64_t i, global_id& found) { found = maxOf(found, ids(i)); },
      Kokkos::Max<global_id>(most));
  const auto keys = sorted.keys;
  const auto values = sorted.values;
  const auto base = static_cast<std::uint64_t>(least);
  Kokkos::parallel_for(
      "contact::sortById::keys", rangePolicy(space, n), KOKKOS_LAMBDA(const std::int64_t i) {
        keys(i) = static_cast<std::uint64_t>(ids(values(i))) - base;
      });
  const std::uint64_t range = static_cast<std::uint64_t>(most) - base;
  sortByKey(space, n, range == UINT64_MAX ? 64 : bitsFor(range + 1), sorted);
}

// Groups the faces (values), sorted along the curve, by body: the bodies follow each other as their
// first faces do.
void groupByBody(const exec_space& space, const SweptBoxes& surface, const Curve& curve,
                 SortedKeys& sorted) {
  const std::int64_t n = surface.num_faces;
  sortById(space, surface.face_body, n, sorted);
  const auto keys = sorted.keys, first_code = sorted.other_keys;
  const auto values = sorted.values, index = sorted.other_values;
  const auto bodies = surface.face_body;
  const View<const int* [4]> face_to_nodes = surface.face_to_nodes;
  const View<const double* [3]> x = surface.coordinates_new;
  Kokkos::parallel_scan(
      "contact::groupByBody::index", rangePolicy(space, n),
      KOKKOS_LAMBDA(const std::int64_t i, int& sum, const bool final) {
        const bool is_first = i == 0 || bodies(values(i)) != bodies(values(i - 1));
        sum += is_first ? 1 : 0;
        if (final) {
          index(i) = sum - 1;
          if (is_first)
            first_code(sum - 1) = curve(centroidOf(face_to_nodes, x, values(i)));
        }
      });
  Kokkos::parallel_for(
      "contact::groupByBody::keys", rangePolicy(space, n),
      KOKKOS_LAMBDA(const std::int64_t i) { keys(i) = first_code(index(i)); });
  sortByKey(space, n, 3 * curve.bits, sorted);
}

// Sets face_order: along the curve.
void orderFaces(const exec_space& space, const SweptBoxes& surface, const Curve& curve,
                bool by_body, ClusterOrder& order) {
  const std::int64_t n = surface.num_faces;
  const View<const int* [4]> face_to_nodes = surface.face_to_nodes;
  const View<const double* [3]> x = surface.coordinates_new;
  SortedKeys sorted = scratchFor(space, n);
  const auto keys = sorted.keys;
  const auto values = sorted.values;
  Kokkos::parallel_for(
      "contact::orderFaces::keys", rangePolicy(space, n), KOKKOS_LAMBDA(const std::int64_t face) {
        keys(face) = curve(centroidOf(face_to_nodes, x, face));
        values(face) = static_cast<int>(face);
      });
  sortByKey(space, n, 3 * curve.bits, sorted);
  if (by_body)
    groupByBody(space, surface, curve, sorted);
  order.face_order = sorted.values;
  sortWithin<block_size>(space, order.face_order, n);
  space.fence();
}

// Places the nodes of no face after the others, along the curve.
void placeLoneNodes(const exec_space& space, const SweptBoxes& surface, const Curve& curve,
                    const View<std::int64_t*>& first, int used, const View<int*>& places) {
  const std::int64_t num_lone = surface.num_nodes - used;
  if (num_lone == 0)
    return;
  SortedKeys sorted = scratchFor(space, num_lone);
  const auto keys = sorted.keys;
  const auto values = sorted.values;
  const View<const double* [3]> x = surface.coordinates_new;
  Kokkos::parallel_scan(
      "contact::placeNodes::lone", rangePolicy(space, surface.num_nodes),
      KOKKOS_LAMBDA(const std::int64_t node, int& sum, const bool final) {
        if (first(node) != INT64_MAX)
          return;
        if (final) {
          keys(sum) = curve(rowOf(x, node));
          values(sum) = static_cast<int>(node);
        }
        ++sum;
      });
  sortByKey(space, num_lone, 3 * curve.bits, sorted);
  const auto ordered = sorted.values;
  Kokkos::parallel_for(
      "contact::placeNodes::place_lone", rangePolicy(space, num_lone),
      KOKKOS_LAMBDA(const std::int64_t i) { places(ordered(i)) = used + static_cast<int>(i); });
  space.fence();
}

// [node] position of the node: by the first face, in order, that has it as a corner; nodes of no
// face come last.
View<int*> placeNodes(const exec_space& space, const SweptBoxes& surface, const Curve& curve,
                      const ClusterOrder& order) {
  const std::int64_t num_faces = surface.num_faces, num_nodes = surface.num_nodes;
  const auto face_to_nodes = surface.face_to_nodes;
  const auto face_order = order.face_order;
  auto first = allocate<View<std::int64_t*>>(space, "contact::ClusterOrder::first", num_nodes);
  auto places = allocate<View<int*>>(space, "contact::ClusterOrder::node_position", num_nodes);
  Kokkos::deep_copy(space, first, INT64_MAX);
  Kokkos::parallel_for(
      "contact::placeNodes::first", rangePolicy(space, num_faces),
      KOKKOS_LAMBDA(const std::int64_t position) {
        const int face = face_order(position);
        for (int corner = 0; corner < 4; ++corner) {
          std::int64_t& of_node = first(face_to_nodes(face, corner));
          const std::int64_t use = 4 * position + corner;
          if (loadShared(of_node) > use) // most uses are not the first
            Kokkos::atomic_fetch_min(&of_node, use);
        }
      });
  int used = 0;
  Kokkos::parallel_scan(
      "contact::placeNodes::used", rangePolicy(space, num_faces),
      KOKKOS_LAMBDA(const std::int64_t position, int& sum, const bool final) {
        const int face = face_order(position);
        for (int corner = 0; corner < 4; ++corner) {
          const int node = face_to_nodes(face, corner);
          if (first(node) != 4 * position + corner)
            continue;
          if (final)
            places(node) = sum;
          ++sum;
        }
      },
      used);
  placeLoneNodes(space, surface, curve, first, used, places);
  return places;
}

// Sets node_order, owned and corners from the positions of the nodes.
void orderNodes(const exec_space& space, const SweptBoxes& surface, const Curve& curve,
                ClusterOrder& order) {
  const int num_nodes = surface.num_nodes, num_faces = surface.num_faces;
  const View<int*> places = placeNodes(space, surface, curve, order);
  order.num_clusters = dividedUp(num_nodes, cluster_size);
  order.node_order = allocate<View<int*>>(space, "contact::ClusterOrder::node_order", num_nodes);
  order.owned =
      View<unsigned*>("contact::ClusterOrder::owned", static_cast<std::size_t>(order.num_clusters));
  const std::int64_t num_blocks = dividedUp<std::int64_t>(num_faces, block_size);
  order.corners =
      allocate<View<int*>>(space, "contact::ClusterOrder::corners", num_blocks * 4 * block_size);
  const auto node_order = order.node_order, face_order = order.face_order, corners = order.corners;
  const auto owned = order.owned;
  const auto is_owned = surface.node_is_owned;
  const auto face_to_nodes = surface.face_to_nodes;
  Kokkos::parallel_for(
      "contact::orderNodes::invert", rangePolicy(space, num_nodes),
      KOKKOS_LAMBDA(const std::int64_t node) {
        node_order(places(node)) = static_cast<int>(node);
      });
  Kokkos::parallel_for(
      "contact::orderNodes::owned", rangePolicy(space, order.num_clusters),
      KOKKOS_LAMBDA(const std::int64_t cluster) {
        unsigned bits = 0;
        for (int i = 0; i < cluster_size; ++i) {
          const std::int64_t position = cluster * cluster_size + i;
          if (position < num_nodes && is_owned(node_order(position)))
            bits |= 1u << i;
        }
        owned(cluster) = bits;
      });
  Kokkos::parallel_for(
      "contact::orderNodes::corners", rangePolicy(space, num_blocks * block_size),
      KOKKOS_LAMBDA(const std::int64_t position) {
        int* const corner =
            &corners(position / block_size * 4 * block_size + position % block_size);
        for (int k = 0; k < 4; ++k)
          corner[k * block_size] =
              position < num_faces ? places(face_to_nodes(face_order(position), k)) : -1;
      });
  space.fence();
}

// Number of host faces that precede their predecessor by (body, id).
std::int64_t countDescents(const exec_space& space, const SweptBoxes& surface) {
  const auto bodies = surface.face_body, ids = surface.face_ids;
  std::int64_t descents = 0;
  Kokkos::parallel_reduce(
      "contact::rankFaces::descents", rangePolicy(space, maxOf(surface.num_faces - 1, 0)),
      KOKKOS_LAMBDA(const std::int64_t i, std::int64_t& sum) {
        const bool ordered =
            bodies(i) != bodies(i + 1) ? bodies(i) < bodies(i + 1) : ids(i) < ids(i + 1);
        sum += ordered ? 0 : 1;
      },
      descents);
  return descents;
}

// Sets face_rank if the order of the host differs.
void rankFaces(const exec_space& space, const SweptBoxes& surface, ClusterOrder& order) {
  if (countDescents(space, surface) == 0)
    return;
  const std::int64_t n = surface.num_faces;
  SortedKeys sorted = scratchFor(space, n);
  const auto start = sorted.values;
  Kokkos::parallel_for(
      "contact::rankFaces::start", rangePolicy(space, n),
      KOKKOS_LAMBDA(const std::int64_t i) { start(i) = static_cast<int>(i); });
  sortById(space, surface.face_ids, n, sorted);
  sortById(space, surface.face_body, n, sorted);
  order.face_rank = allocate<View<int*>>(space, "contact::ClusterOrder::face_rank", n);
  const auto by_rank = sorted.values, rank = sorted.other_values, at_position = order.face_rank;
  const auto face_order = order.face_order;
  Kokkos::parallel_for(
      "contact::rankFaces::ranks", rangePolicy(space, n),
      KOKKOS_LAMBDA(const std::int64_t i) { rank(by_rank(i)) = static_cast<int>(i); });
  Kokkos::parallel_for(
      "contact::rankFaces::by_position", rangePolicy(space, n),
      KOKKOS_LAMBDA(const std::int64_t i) { at_position(i) = rank(face_order(i)); });
  space.fence();
}

} // namespace

Box boxWithoutOutliers(const exec_space& space, const View<const Vec3*>& points, std::int64_t n) {
  std::vector<Vec3> sample(static_cast<std::size_t>(n));
  if (n > 0)
    Kokkos::deep_copy(space,
                      Kokkos::View<Vec3*, Kokkos::HostSpace, Kokkos::MemoryUnmanaged>(
                          sample.data(), sample.size()),
                      points);
  space.fence();
  Box box;
  std::vector<double> along;
  for (int d = 0; d < 3; ++d) {
    along.clear();
    for (const Vec3& point : sample)
      if (std::isfinite(point[d]))
        along.push_back(point[d]);
    if (along.empty())
      return Box();
    std::sort(along.begin(), along.end());
    const std::size_t tail = along.size() / 64, last = along.size() - 1;
    const double low = along[tail], high = along[last - tail];
    box.lower[d] = std::max(along[0], low - (high - low));
    box.upper[d] = std::min(along[last], high + (high - low));
  }
  return box;
}

ClusterOrder orderSurface(const exec_space& space, const SweptBoxes& surface, bool by_body) {
  ClusterOrder order;
  const Curve curve = layCurve(space, surface, order);
  orderFaces(space, surface, curve, by_body, order);
  orderNodes(space, surface, curve, order);
  rankFaces(space, surface, order);
  if (by_body)
    nameBodies(space, surface, order);
  return order;
}

} // namespace brickwall::contact
