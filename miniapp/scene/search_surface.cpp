#include "miniapp/scene/search_surface.hpp"

#include "contact/base/to_device.hpp"
#include "io/wall/hashed_random.hpp"

#include <algorithm>
#include <utility>

namespace brickwall::miniapp {

SearchSurface::SearchSurface(const exec_space& space, const io::SurfacePart& part, int rank,
                             double drift, std::uint64_t seed)
    : _drift(drift), _seed(seed), _bricks(part.node_body) {
  std::sort(_bricks.begin(), _bricks.end());
  _bricks.erase(std::unique(_bricks.begin(), _bricks.end()), _bricks.end());
  std::vector<int> node_brick;
  node_brick.reserve(part.node_body.size());
  for (const global_id body : part.node_body)
    node_brick.push_back(
        static_cast<int>(std::lower_bound(_bricks.begin(), _bricks.end(), body) - _bricks.begin()));
  _node_brick = toDevice<View<int*>>(space, "miniapp::SearchSurface::node_brick", node_brick);
  _motion = View<double* [3]>("miniapp::SearchSurface::motion", _bricks.size());
  _motion_host = Kokkos::create_mirror_view(_motion);
  _new = toDevice<View<double* [3]>>(space, "miniapp::SearchSurface::x_new", part.coordinates);
  _old = toDevice<View<double* [3]>>(space, "miniapp::SearchSurface::x_old", part.coordinates);

  _surface.num_nodes = static_cast<int>(part.node_ids.size());
  _surface.num_faces = static_cast<int>(part.face_ids.size());
  _surface.face_to_nodes =
      toDevice<View<int* [4]>>(space, "miniapp::SearchSurface::face_to_nodes", part.face_nodes);
  _surface.node_ids =
      toDevice<View<global_id*>>(space, "miniapp::SearchSurface::node_ids", part.node_ids);
  _surface.face_ids =
      toDevice<View<global_id*>>(space, "miniapp::SearchSurface::face_ids", part.face_ids);
  _surface.node_body =
      toDevice<View<global_id*>>(space, "miniapp::SearchSurface::node_body", part.node_body);
  _surface.face_body =
      toDevice<View<global_id*>>(space, "miniapp::SearchSurface::face_body", part.face_body);
  std::vector<unsigned char> is_owned;
  is_owned.reserve(part.node_owner.size());
  for (const int owner : part.node_owner)
    is_owned.push_back(owner == rank);
  _surface.node_is_owned =
      toDevice<View<unsigned char*>>(space, "miniapp::SearchSurface::node_is_owned", is_owned);
}

void SearchSurface::move(const exec_space& space, std::int64_t step) {
  for (std::size_t b = 0; b < _bricks.size(); ++b)
    for (int d = 0; d < 3; ++d)
      _motion_host(b, d) =
          _drift * io::hashedUniform(_seed, _bricks[b], static_cast<int>(3 * step + d));
  Kokkos::deep_copy(space, _motion, _motion_host);
  std::swap(_old, _new);
  const auto x_old = _old, x_new = _new, motion = _motion;
  const auto node_brick = _node_brick;
  Kokkos::parallel_for(
      "miniapp::SearchSurface::move", rangePolicy(space, _surface.num_nodes),
      KOKKOS_LAMBDA(const std::int64_t node) {
        for (int d = 0; d < 3; ++d)
          x_new(node, d) = x_old(node, d) + motion(node_brick(node), d);
      });
}

contact::Surface SearchSurface::surface() const {
  contact::Surface surface = _surface;
  surface.coordinates_old = _old;
  surface.coordinates_new = _new;
  return surface;
}

} // namespace brickwall::miniapp
