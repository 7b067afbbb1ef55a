#include "contact/search/cluster/surface_clusters.hpp"

#include "contact/base/region.hpp"
#include "contact/search/cluster/host_refit.hpp"
#include "contact/search/cluster/team_refit.hpp"

namespace brickwall::contact {
namespace {

using Refit = std::conditional_t<fills_lanes, HostRefit, TeamRefit>;

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
  _order = orderSurface(space, surface, config.drop_same_body);
  const auto bounds = [&](const char* label, std::int64_t rows) {
    return allocate<View<float*>>(space, label, rows * 6 + 2);
  };
  _same_bounds = config.node_tolerance == config.face_tolerance;
  const std::int64_t num_positions = std::int64_t(_order.num_clusters) * cluster_size;
  _corner_bounds = bounds("contact::SurfaceClusters::corner_bounds", num_positions);
  if (!_same_bounds)
    _node_bounds = bounds("contact::SurfaceClusters::node_bounds", num_positions);
  if (cluster_size > 1)
    _cluster_bounds = bounds("contact::SurfaceClusters::cluster_bounds", _order.num_clusters);
  _forest.shape(space, std::int64_t(surface.num_faces));
  _surface = surface;
  _surface.coordinates_old = _surface.coordinates_new = View<const double* [3]>();
  _is_ordered = true;
  _blocks_when_ordered = 0;
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

void SurfaceClusters::noteSearch(std::int64_t num_blocks) {
  // Bodies that separate stretch the blocks that span them; a growth by a quarter justifies a sort.
  constexpr double degraded = 1.25;
  if (_blocks_when_ordered == 0)
    _blocks_when_ordered = num_blocks;
  else if (static_cast<double>(num_blocks) > degraded * static_cast<double>(_blocks_when_ordered))
    orderAgain();
}

void SurfaceClusters::launchUpdate(const exec_space& space, const SweptBoxes& surface,
                                   const SearchConfig& config) {
  const Region region("contact::constructBoxes");
  const bool same_bounds = config.node_tolerance == config.face_tolerance;
  if (!_is_ordered || isNew(surface) || same_bounds != _same_bounds)
    order(space, surface, config);
  else
    followSurface();
  const RefitInput input{surface.coordinates_old,
                         surface.coordinates_new,
                         surface.node_ids,
                         _order.node_order,
                         _order.owned,
                         _order.corners,
                         _corner_bounds,
                         _node_bounds,
                         _cluster_bounds,
                         _forest.tree(0),
                         _order.origin,
                         config.node_tolerance,
                         config.face_tolerance,
                         surface.num_nodes,
                         _same_bounds};
  _sums = RefitSums();
  {
    const Region timer("contact::search::node_boxes");
    Refit::refitNodes(space, input, _scratch, _sums);
  }
  const Region timer("contact::search::face_boxes");
  Refit::refitFaces(space, input, _scratch, _sums);
  Refit::refitUpperLevels(space, _forest, _sums);
}

void SurfaceClusters::readRankBoxes(const exec_space& space) {
  Refit::read(space, _scratch, _sums);
  _rank_boxes.node_box = boxAround(_sums.owned_nodes, _order.origin);
  _rank_boxes.face_box = boxAround(_sums.faces, _order.origin);
  _rank_boxes.num_invalid = _sums.num_invalid;
  _rank_boxes.first_invalid = _sums.first_invalid;
}

} // namespace brickwall::contact
