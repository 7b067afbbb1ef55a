#include "contact/enforcement/selection/touched_nodes.hpp"

namespace brickwall::contact {
namespace {

constexpr int min_nodes_per_listed = 8; // a longer list costs more than it saves

struct InsertNode {
  View<int*> nodes, is_listed;
  View<int> count;

  KOKKOS_INLINE_FUNCTION void operator()(int node) const {
    if (is_listed(node) == 0 && Kokkos::atomic_exchange(&is_listed(node), 1) == 0)
      nodes(Kokkos::atomic_fetch_add(&count(), 1)) = node;
  }
};

} // namespace

void zeroListed(const exec_space& space, const std::string& label, const NodeList& list,
                const View<std::int64_t* [3]>& values) {
  if (list.count > 0)
    Kokkos::parallel_for(
        label, rangePolicy(space, list.count), KOKKOS_LAMBDA(const std::int64_t i) {
          for (int d = 0; d < 3; ++d)
            values(list(i), d) = 0;
        });
}

void flagListed(const exec_space& space, const NodeList& list, const View<unsigned char*>& flags) {
  Kokkos::deep_copy(space, flags, static_cast<unsigned char>(0));
  Kokkos::parallel_for(
      "contact::flagListed", rangePolicy(space, list.count),
      KOKKOS_LAMBDA(const std::int64_t i) { flags(list(i)) = 1; });
}

void flagGhostsInUse(const exec_space& space, const FaceAccess& faces, const ContactHistory& pairs,
                     const View<unsigned char*>& flags) {
  if (faces.ghosts.count == 0)
    return;
  Kokkos::deep_copy(space, flags, static_cast<unsigned char>(0));
  const auto interactions = pairs.interactions;
  Kokkos::parallel_for(
      "contact::flagGhostsInUse", rangePolicy(space, pairs.count),
      KOKKOS_LAMBDA(const std::int64_t i) {
        const int face = interactions(i).face_index;
        if (!faces.isOwn(face))
          storeShared(flags(faces.ghostOf(face)), static_cast<unsigned char>(1));
      });
}

TouchedNodes::TouchedNodes(const std::string& label, int num_nodes)
    : _num_nodes(num_nodes), _nodes(label + "::touched_nodes", num_nodes),
      _is_listed(label + "::is_touched", num_nodes), _count(label + "::num_touched") {
  _list.nodes = _nodes;
}

void TouchedNodes::clear(const exec_space& space) {
  const auto nodes = _nodes;
  const auto is_listed = _is_listed;
  const auto count = _count;
  if (_num_listed > 0)
    Kokkos::parallel_for(
        "contact::TouchedNodes::clear", rangePolicy(space, _num_listed),
        KOKKOS_LAMBDA(const std::int64_t i) {
          is_listed(nodes(i)) = 0;
          if (i == 0)
            count() = 0;
        });
  _num_listed = 0;
  _list = {0, _nodes};
}

void TouchedNodes::listAll(const exec_space& space) {
  clear(space);
  _list = NodeList::allOf(_num_nodes);
}

void TouchedNodes::add(const exec_space& space, const SweptBoxes& surface,
                       const ContactHistory& pairs, const View<const int*>& to_node) {
  if (pairs.count == 0 || _list.isAll())
    return;
  // Flush pairs have a node each.
  if (min_nodes_per_listed * (_num_listed + pairs.count) > _num_nodes) {
    listAll(space);
    return;
  }
  const InsertNode insert{_nodes, _is_listed, _count};
  const auto interactions = pairs.interactions;
  const bool is_mapped = to_node.data() != nullptr;
  Kokkos::parallel_for(
      "contact::TouchedNodes::add", rangePolicy(space, pairs.count),
      KOKKOS_LAMBDA(const std::int64_t i) {
        const Interaction& pair = interactions(i);
        forEachNodeOf(pair.point, pair.face_index, surface,
                      [&](int node) { insert(is_mapped ? to_node(node) : node); });
      });
  finishInsertion(space);
}

void TouchedNodes::addNodes(const exec_space& space, const View<const int*>& nodes) {
  const auto count = static_cast<std::int64_t>(nodes.extent(0));
  if (count == 0 || _list.isAll())
    return;
  const InsertNode insert{_nodes, _is_listed, _count};
  Kokkos::parallel_for(
      "contact::TouchedNodes::addNodes", rangePolicy(space, count),
      KOKKOS_LAMBDA(const std::int64_t i) { insert(nodes(i)); });
  finishInsertion(space);
}

void TouchedNodes::addCorners(const exec_space& space, const View<const int*>& faces,
                              std::int64_t count, const View<const int* [4]>& face_to_nodes) {
  if (count == 0 || _list.isAll())
    return;
  const InsertNode insert{_nodes, _is_listed, _count};
  Kokkos::parallel_for(
      "contact::TouchedNodes::addCorners", rangePolicy(space, count),
      KOKKOS_LAMBDA(const std::int64_t i) {
        for (int j = 0; j < 4; ++j)
          insert(face_to_nodes(faces(i), j));
      });
  finishInsertion(space);
}

void TouchedNodes::finishInsertion(const exec_space& space) {
  Kokkos::deep_copy(space, _num_listed, _count);
  space.fence();
  _list.count = _num_listed;
  if (min_nodes_per_listed * _num_listed > _num_nodes)
    listAll(space);
}

} // namespace brickwall::contact
