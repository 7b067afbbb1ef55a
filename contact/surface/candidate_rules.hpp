// Which overlapping (node, face) pairs are candidates, and the order of a node's row.
#pragma once

#include "contact/surface/surface.hpp"

namespace brickwall::contact {

// Read access to own and ghost faces by one index: ghosts follow the own faces. `Space` is where it is read.
template <class Space>
class PairRules {
public:
  PairRules(const Surface& surface, const GhostFaces& ghosts, bool drop_same_body)
      : _num_faces(surface.num_faces), _drop_same_body(drop_same_body),
        _face_to_nodes(accessible(surface.face_to_nodes)), _node_ids(accessible(surface.node_ids)),
        _node_body(accessible(surface.node_body)), _face_body(accessible(surface.face_body)),
        _face_ids(accessible(surface.face_ids)),
        _ghost_corners(accessible(View<const global_id* [4]>(ghosts.corner_ids))),
        _ghost_bodies(accessible(View<const global_id*>(ghosts.bodies))),
        _ghost_ids(accessible(View<const global_id*>(ghosts.face_ids))) {}

  // Not a face that the node belongs to or, if bodies matter, not one of its body (which its own faces are of).
  // Without branches on the outcome, since either is likely.
  KOKKOS_INLINE_FUNCTION bool allow(int node, int face) const {
    if (_drop_same_body)
      return bodyOf(face) != _node_body(node);
    if (face < _num_faces)
      return (_face_to_nodes(face, 0) != node) & (_face_to_nodes(face, 1) != node) &
             (_face_to_nodes(face, 2) != node) & (_face_to_nodes(face, 3) != node);
    const int ghost = face - _num_faces;
    const global_id id = _node_ids(node);
    return (_ghost_corners(ghost, 0) != id) & (_ghost_corners(ghost, 1) != id) &
           (_ghost_corners(ghost, 2) != id) & (_ghost_corners(ghost, 3) != id);
  }

  // Order of rows: body, then face id.
  KOKKOS_INLINE_FUNCTION bool before(int a, int b) const {
    const global_id body_a = bodyOf(a), body_b = bodyOf(b);
    return body_a != body_b ? body_a < body_b : idOf(a) < idOf(b);
  }

private:
  template <class T>
  using Array = Kokkos::View<T, typename View<T>::array_layout, Space>;

  template <class T>
  static Array<T> accessible(const View<T>& view) {
    return Kokkos::create_mirror_view_and_copy(Space(), view);
  }
  KOKKOS_INLINE_FUNCTION global_id bodyOf(int face) const {
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

} // namespace brickwall::contact
