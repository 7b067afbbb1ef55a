// Rows of candidate faces: the rules by which a pair is a candidate, the order within a row, and
// rows laid out by node.
#pragma once

#include "contact/surface/surface.hpp"

#include <cstdint>
#include <type_traits>

namespace brickwall::contact {

// Which overlapping pairs are candidates, and in which order a row lists its faces. Ghosts follow
// the own faces in one index. `Space` is the memory space in which the rules are evaluated.
template <class Space>
class PairRules {
public:
  PairRules(const SweptBoxes& surface, const GhostFaces& ghosts, bool drop_same_body)
      : _num_faces(surface.num_faces), _drop_same_body(drop_same_body),
        _face_to_nodes(accessible(surface.face_to_nodes)), _node_ids(accessible(surface.node_ids)),
        _node_body(accessible(surface.node_body)), _face_body(accessible(surface.face_body)),
        _face_ids(accessible(surface.face_ids)),
        _ghost_corners(accessible(View<const global_id* [4]>(ghosts.corner_ids))),
        _ghost_bodies(accessible(View<const global_id*>(ghosts.bodies))),
        _ghost_ids(accessible(View<const global_id*>(ghosts.face_ids))) {}

  // Excludes the faces that the node belongs to or, with drop_same_body, all faces of its body. The
  // comparisons are joined without branches, since either outcome is likely.
  KOKKOS_INLINE_FUNCTION bool allow(int node, int face) const {
    if (_drop_same_body)
      return bodyOfSide(sideOf(face)) != _node_body(node);
    if (face < _num_faces)
      return (_face_to_nodes(face, 0) != node) & (_face_to_nodes(face, 1) != node) &
             (_face_to_nodes(face, 2) != node) & (_face_to_nodes(face, 3) != node);
    const int ghost = face - _num_faces;
    const global_id id = _node_ids(node);
    return (_ghost_corners(ghost, 0) != id) & (_ghost_corners(ghost, 1) != id) &
           (_ghost_corners(ghost, 2) != id) & (_ghost_corners(ghost, 3) != id);
  }

  // The order of a row: by side of a body, then by face id.
  KOKKOS_INLINE_FUNCTION bool before(int a, int b) const {
    const global_id side_a = sideOf(a), side_b = sideOf(b);
    return side_a != side_b ? side_a < side_b : idOf(a) < idOf(b);
  }

private:
  template <class T>
  using Array = Kokkos::View<T, typename View<T>::array_layout, Space>;

  template <class T>
  static Array<T> accessible(const View<T>& view) {
    if constexpr (std::is_same<Space, memory_space>::value)
      return view; // a copy, even if it is none, would fence
    else
      return Kokkos::create_mirror_view_and_copy(Space(), view);
  }
  KOKKOS_INLINE_FUNCTION global_id sideOf(int face) const {
    return face < _num_faces ? _face_body(face) : _ghost_bodies(face - _num_faces);
  }
  KOKKOS_INLINE_FUNCTION global_id idOf(int face) const {
    return face < _num_faces ? _face_ids(face) : _ghost_ids(face - _num_faces);
  }

  int _num_faces;
  bool _drop_same_body;
  Array<const int* [4]> _face_to_nodes;
  Array<const global_id*> _node_ids, _node_body, _face_body, _face_ids;
  Array<const global_id* [4]> _ghost_corners;
  Array<const global_id*> _ghost_bodies, _ghost_ids;
};

// Restores the heap property (largest first) of a heap of n entries below entry `root`.
template <class Before>
KOKKOS_INLINE_FUNCTION void siftDown(int* row, std::int64_t root, std::int64_t n,
                                     const Before& before) {
  for (std::int64_t child = 2 * root + 1; child < n; child = 2 * root + 1) {
    if (child + 1 < n && before(row[child], row[child + 1]))
      ++child;
    if (!before(row[root], row[child]))
      return;
    const int swapped = row[root];
    row[root] = row[child];
    row[child] = swapped;
    root = child;
  }
}

// Insertion sort for the usual short row, heap sort for a long one.
template <class Before>
KOKKOS_INLINE_FUNCTION void sortRow(int* row, std::int64_t n, const Before& before) {
  if (n <= 48) {
    for (std::int64_t i = 1; i < n; ++i) {
      const int face = row[i];
      std::int64_t to = i;
      for (; to > 0 && before(face, row[to - 1]); --to)
        row[to] = row[to - 1];
      row[to] = face;
    }
    return;
  }
  for (std::int64_t root = n / 2; root-- > 0;)
    siftDown(row, root, n, before);
  for (std::int64_t last = n - 1; last > 0; --last) {
    const int swapped = row[0];
    row[0] = row[last];
    row[last] = swapped;
    siftDown(row, 0, last, before);
  }
}

// Makes row i that of node i, with its faces at pairs.faces [offsets(i), offsets(i + 1)); `offsets`
// has num_nodes + 1 entries. Sets all of `pairs` but `faces`. For search methods that keep the node
// order of the host. Fences.
void layOutRowsByNode(const exec_space& space, int num_nodes,
                      const View<const std::int64_t*>& offsets, CandidatePairs& pairs);

} // namespace brickwall::contact
