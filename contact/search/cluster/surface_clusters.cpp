#include "contact/search/cluster/surface_clusters.hpp"

#include "contact/base/lanes.hpp"
#include "contact/base/region.hpp"
#include "contact/surface/construct_boxes.hpp"

namespace brickwall::contact {
namespace {

constexpr int sides = 6;

// Computes the bounds of the nodes of one cluster, and of the cluster. Rows of coordinates are
// gathered in the kept order.
struct RefitCluster {
  View<const double*[3]> x_old, x_new;
  View<const int*> node_order;
  View<const unsigned*> owned;
  View<const global_id*> ids;
  View<float*> corner_bounds, node_bounds, cluster_bounds;
  Vec3 from;
  double node_tolerance, face_tolerance;
  int num_nodes;
  bool same_bounds;

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t cluster,
                                         SurfaceClusters::Sums& all) const {
    const std::int64_t first = cluster * cluster_size;
    prefetchNodes(first + 4 * cluster_size); // the host's rows are scattered
    const double origin[4] = {from.x, from.y, from.z, 0};
    const unsigned is_owned = owned(cluster);
    FloatBounds of_owned;
    for (int lane = 0; lane < cluster_size && first + lane < num_nodes; ++lane) {
      const int node = node_order(first + lane);
      double rows[2][4];
      const double* const a = rowOfFour(x_old, node, rows[0]);
      const double* const b = rowOfFour(x_new, node, rows[1]);
      FloatBounds bounds;
      const bool is_finite = sweptBox(a, b, face_tolerance, origin, bounds.side);
      if (!is_finite)
        skip(node, bounds, all);
      storeRow(bounds, &corner_bounds((first + lane) * sides));
      if (!same_bounds) {
        if (is_finite)
          sweptBox(a, b, node_tolerance, origin, bounds.side);
        storeRow(bounds, &node_bounds((first + lane) * sides));
      }
      for (int s = 0; s < sides; ++s)
        of_owned.side[s] =
            minOf(of_owned.side[s], is_owned >> lane & 1u ? bounds.side[s] : HUGE_VALF);
    }
    storeRow(of_owned, &cluster_bounds(cluster * sides));
    all.owned_nodes.include(of_owned);
  }

  KOKKOS_FORCEINLINE_FUNCTION void prefetchNodes(std::int64_t first) const {
    if constexpr (cluster_size > 1)
      for (int lane = 0; lane < cluster_size && first + cluster_size <= num_nodes; ++lane) {
        const int node = node_order(first + lane);
        prefetch(&x_old(node, 0));
        prefetch(&x_new(node, 0));
      }
  }

  // A row of coordinates of which sweptBox() may read four numbers: in place where it is contiguous
  // and another row follows, otherwise a copy.
  KOKKOS_INLINE_FUNCTION const double* rowOfFour(const View<const double* [3]>& x, int node,
                                                 double (&copy)[4]) const {
    if (cluster_size > 1 && x.stride_1() == 1 && node + 1 < num_nodes)
      return &x(node, 0);
    for (int d = 0; d < 3; ++d)
      copy[d] = x(node, d);
    copy[3] = 0;
    return copy;
  }
  KOKKOS_INLINE_FUNCTION static void storeRow(const FloatBounds& bounds, float* row) {
    for (int s = 0; s < sides; ++s)
      row[s] = bounds.side[s];
  }
  // Counts a node that is not finite, which has no box.
  KOKKOS_INLINE_FUNCTION void skip(int node, FloatBounds& bounds,
                                   SurfaceClusters::Sums& all) const {
    bounds = FloatBounds();
    ++all.num_invalid;
    all.first_invalid = minOf(all.first_invalid, ids(node));
  }
};

// A box that contains all boxes of doubles that round to these bounds.
Box boxAround(const FloatBounds& bounds, const Vec3& origin) {
  constexpr double ulp = 0x1p-23; // of a float, and more than twice its rounding error
  Box box;
  if (bounds.side[0] == HUGE_VALF)
    return box;
  for (int d = 0; d < 3; ++d) {
    const double lower = bounds.side[d], upper = -double(bounds.side[3 + d]);
    box.lower[d] = lower - ulp * (std::fabs(lower) + std::fabs(origin[d])) + origin[d];
    box.upper[d] = upper + ulp * (std::fabs(upper) + std::fabs(origin[d])) + origin[d];
    if (-lower >= double(FLT_MAX)) // beyond the range of floats
      box.lower[d] = -HUGE_VAL;
    if (upper >= double(FLT_MAX))
      box.upper[d] = HUGE_VAL;
    // denormals
    box.lower[d] -= FLT_MIN;
    box.upper[d] += FLT_MIN;
  }
  return box;
}

// The union of all boxes of a tree. Fences.
FloatBounds boundsOfTree(const exec_space& space, const BoxTree& tree) {
  if (tree.num_levels == 0)
    return {};
  float top[block_floats];
  using OnHost = Kokkos::View<float*, Kokkos::HostSpace, Kokkos::MemoryUnmanaged>;
  using OnDevice = Kokkos::View<const float*, memory_space, Kokkos::MemoryUnmanaged>;
  Kokkos::deep_copy(space, OnHost(top, block_floats),
                    OnDevice(tree.block(tree.num_levels - 1, 0), block_floats));
  space.fence();
  return unionOfBlock(top);
}

// Computes the boxes of one block of faces, and their union as an item of the next level. The box
// of a face is the union of those of its corners, since rounding is monotone. Returns the sum of
// the extents of the block.
struct RefitBlock {
  BoxTree tree;
  View<const int*> corners;
  View<const float*> corner_bounds;

  KOKKOS_INLINE_FUNCTION double operator()(std::int64_t block) const {
    const int* const corner = &corners(block * 4 * block_size);
    float* const boxes = tree.block(0, block);
    float all[8];
    for (int s = 0; s < 8; ++s)
      all[s] = HUGE_VALF;
    const int used = minOf<int>(block_size, tree.num_items - static_cast<int>(block) * block_size);
    for (int lane = 0; lane < used; ++lane) {
      float box[8]; // eight, not six: one SIMD register; the last two belong to the next node
      const float* from = &corner_bounds(std::int64_t(corner[lane]) * sides);
      for (int s = 0; s < 8; ++s)
        box[s] = from[s];
      float hole = box[0]; // infinite for a node that is not finite
      for (int k = 1; k < 4; ++k) {
        from = &corner_bounds(std::int64_t(corner[k * block_size + lane]) * sides);
        hole = maxOf(hole, from[0]);
        for (int s = 0; s < 8; ++s)
          box[s] = from[s] < box[s] ? from[s] : box[s];
      }
      if (hole == HUGE_VALF)
        for (int s = 0; s < 8; ++s)
          box[s] = HUGE_VALF;
      for (int s = 0; s < 8; ++s)
        all[s] = box[s] < all[s] ? box[s] : all[s];
      for (int s = 0; s < sides; ++s)
        boxes[s * block_size + lane] = box[s];
    }
    for (int lane = used; lane < block_size; ++lane)
      storeLane(boxes, lane, FloatBounds());
    if (tree.num_levels > 1) {
      float* const parent = tree.block(1, block / block_size);
      for (int s = 0; s < sides; ++s)
        parent[s * block_size + block % block_size] = all[s];
    }
    double extent = 0;
    for (int d = 0; d < 3; ++d)
      extent -= double(all[d]) + double(all[3 + d]);
    return extent > 0 ? extent : 0;
  }
};

// Returns the sum of the extents of the blocks; one block contributes at most `most`, so that a
// huge face does not dominate.
double refitFaces(const exec_space& space, const RefitBlock& refit, double most) {
  const BoxTree tree = refit.tree;
  if (tree.num_levels == 0)
    return 0;
  const std::int64_t num_blocks = tree.numBlocks(0);
  if (tree.num_levels > 1) // lanes after the last block
    Kokkos::parallel_for(
        "contact::SurfaceClusters::empty_lanes", rangePolicy(space, block_size),
        KOKKOS_LAMBDA(const std::int64_t lane) {
          const std::int64_t parent = tree.numBlocks(1) - 1;
          if (parent * block_size + lane >= num_blocks)
            storeLane(tree.block(1, parent), static_cast<int>(lane), FloatBounds());
        });
  double extent = 0;
  Kokkos::parallel_reduce(
      "contact::SurfaceClusters::faces", rangePolicy(space, num_blocks),
      KOKKOS_LAMBDA(const std::int64_t block, double& sum) { sum += minOf(refit(block), most); },
      extent);
  space.fence();
  return extent;
}

} // namespace

bool SurfaceClusters::isNew(const SweptBoxes& surface) const {
  return surface.num_nodes != _surface.num_nodes || surface.num_faces != _surface.num_faces ||
         surface.face_to_nodes.data() != _surface.face_to_nodes.data() ||
         surface.node_is_owned.data() != _surface.node_is_owned.data() ||
         surface.node_ids.data() != _surface.node_ids.data() ||
         surface.face_ids.data() != _surface.face_ids.data() ||
         surface.face_body.data() != _surface.face_body.data();
}

void SurfaceClusters::order(const exec_space& space, const SweptBoxes& surface,
                            const SearchConfig& config) {
  const Region timer("contact::search::initialization");
  _is_ordered = false; // in case of a throw
  // The scratch of the sort and the memory of the boxes never exist at the same time.
  _order = ClusterOrder();
  _corner_bounds = _node_bounds = _cluster_bounds = View<float*>();
  _forest = BoxForest();
  _order = orderSurface(space, surface);
  const auto bounds = [&](const char* label, std::int64_t rows) {
    return allocate<View<float*>>(space, label, rows * sides + 2);
  };
  _same_bounds = config.node_tolerance == config.face_tolerance;
  const std::int64_t num_positions = std::int64_t(_order.num_clusters) * cluster_size;
  _corner_bounds = bounds("contact::SurfaceClusters::corner_bounds", num_positions);
  if (!_same_bounds)
    _node_bounds = bounds("contact::SurfaceClusters::node_bounds", num_positions);
  _cluster_bounds = bounds("contact::SurfaceClusters::cluster_bounds", _order.num_clusters);
  _forest.shape(space, std::int64_t(surface.num_faces));
  _surface = surface;
  _surface.coordinates_old = _surface.coordinates_new = View<const double* [3]>();
  _is_ordered = true;
  ++_num_orderings;
}

// Moves the origin along with a surface that has moved away as a whole, so that floats keep their
// resolution.
void SurfaceClusters::followSurface() {
  const Box& box = _rank_boxes.face_box;
  if (box.empty())
    return;
  const Vec3 centre = box.centroid();
  for (int d = 0; d < 3; ++d)
    if (std::fabs(centre[d] - _order.origin[d]) > 4 * (box.upper[d] - box.lower[d]) &&
        std::isfinite(centre[d]))
      _order.origin[d] = centre[d];
}

void SurfaceClusters::update(const exec_space& space, const SweptBoxes& surface,
                             const SearchConfig& config) {
  const Region region("contact::constructBoxes");
  // Bricks that separate stretch the blocks that span them, which makes queries dearer; a growth by
  // a quarter justifies a sort.
  constexpr double degraded = 1.25;
  const bool same_bounds = config.node_tolerance == config.face_tolerance;
  const bool fresh = !_is_ordered || isNew(surface) || same_bounds != _same_bounds ||
                     _extent > degraded * _extent_when_ordered;
  if (fresh)
    order(space, surface, config);
  else
    followSurface();
  {
    const Region timer("contact::search::node_boxes");
    Sums sums;
    Kokkos::parallel_reduce(
        "contact::SurfaceClusters::nodes", rangePolicy(space, _order.num_clusters),
        RefitCluster{surface.coordinates_old, surface.coordinates_new, _order.node_order,
                     _order.owned, surface.node_ids, _corner_bounds, _node_bounds, _cluster_bounds,
                     _order.origin, config.node_tolerance, config.face_tolerance, surface.num_nodes,
                     _same_bounds},
        PlusReducer<Sums>(sums));
    space.fence();
    _rank_boxes.node_box = boxAround(sums.owned_nodes, _order.origin);
    _rank_boxes.num_invalid = sums.num_invalid;
    _rank_boxes.first_invalid = sums.first_invalid;
  }
  const Region timer("contact::search::face_boxes");
  const RefitBlock refit{_forest.tree(0), _order.corners, _corner_bounds};
  double most = fresh ? HUGE_VAL : _max_extent;
  _extent = refitFaces(space, refit, most);
  if (fresh) { // the reference for later steps: without outliers, which would dominate
    constexpr double outlier = 16; // times the mean extent of a block
    const double num_blocks = maxOf(surface.num_faces / block_size, 1);
    double last = HUGE_VAL;
    while (_extent < 0.5 * last) {
      last = _extent;
      most = outlier * _extent / num_blocks;
      _extent = refitFaces(space, refit, most);
    }
    // A surface that lies in one point gives no measure.
    _max_extent = most > 0 ? most : HUGE_VAL;
    _extent_when_ordered = _extent;
  }
  _forest.refitUpperLevels(space, 2);
  _rank_boxes.face_box = boxAround(boundsOfTree(space, _forest.tree(0)), _order.origin);
}

} // namespace brickwall::contact
