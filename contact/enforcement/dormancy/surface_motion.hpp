// Motion of a surface since the last call: the nodes that have not moved by a bit, and for every
// body the box of its nodes' motions, summed from call to call. The difference of two such sums
// bounds the motion of any node of the body in between, and the width of that box bounds the body's
// rotation and deformation.
#pragma once

#include "contact/base/sum_over.hpp"
#include "contact/surface/surface.hpp"

#include <cstring>

namespace brickwall::contact {

// Compares bits: 0 and -0 differ, so that kept results equal recomputed ones.
KOKKOS_INLINE_FUNCTION bool sameBits(double a, double b) {
  std::int64_t p, q;
  memcpy(&p, &a, sizeof p);
  memcpy(&q, &b, sizeof q);
  return p == q;
}

// Summed motions of bodies, for kernels.
struct BodyMotions {
  View<const global_id*> bodies; // ascending
  View<const double* [6]> sums; // [place in `bodies`][low xyz, high xyz], length
  // [place in `bodies`] 1: all nodes of the body on this rank are stationary
  View<const unsigned char*> is_at_rest;

  // Place of a body of this rank's nodes, otherwise -1.
  KOKKOS_INLINE_FUNCTION int find(global_id body) const {
    int begin = 0, end = static_cast<int>(bodies.extent(0));
    while (begin < end) {
      const int middle = (begin + end) / 2;
      if (bodies(middle) < body)
        begin = middle + 1;
      else
        end = middle;
    }
    return begin < static_cast<int>(bodies.extent(0)) && bodies(begin) == body ? begin : -1;
  }
  // Bounds of the motion of any node of the body at place `a` with respect to any node of the body
  // at `b`.
  KOKKOS_INLINE_FUNCTION double low(int a, int b, int d) const {
    return sums(a, d) - sums(b, 3 + d);
  }
  KOKKOS_INLINE_FUNCTION double high(int a, int b, int d) const {
    return sums(a, 3 + d) - sums(b, d);
  }
};

class SurfaceMotion {
public:
  // What the host reads of an update.
  struct AddedMotions {
    double largest = 0; // component of the sums
    std::int64_t num_moving = 0;

    KOKKOS_INLINE_FUNCTION AddedMotions& operator+=(const AddedMotions& b) {
      largest = maxOf(largest, b.largest);
      num_moving += b.num_moving;
      return *this;
    }
  };

  SurfaceMotion() = default;
  SurfaceMotion(const exec_space& space, const std::string& label, const Surface& surface);

  // Compares coordinates_new with those of the last call. Reads the coordinates once. Waits for the
  // device.
  void update(const exec_space& space, const Surface& surface);
  // Launches the next update() earlier, with the same surface.
  void start(const exec_space& space, const Surface& surface);

  // [node] odd: its coordinates are those of the last call, and it has not moved in this step;
  // `twice`: so it was in the last call.
  static constexpr unsigned char twice = 3;
  const View<const unsigned char*>& stationaryNodes() const { return _stationary; }
  bool isAllStationary() const { return _num_moving == 0; }
  bool isNoneStationary() const { return _num_moving == _num_nodes; }

  const BodyMotions& bodies() const { return _bodies; }
  // Bound of the rounding error in a distance between points of the surface, length.
  double rounding() const { return _rounding; }

private:
  void launchSums(const exec_space& space);

  bool _has_started = false;
  LaunchedSums<AddedMotions> _added;
  std::int64_t _num_nodes = 0, _num_moving = 0;
  bool _has_last = false;
  double _extent = 0, _rounding = 0;
  View<double* [3]> _last; // coordinates of the last call [node][xyz]
  View<const unsigned char*> _stationary;
  View<unsigned char*> _stationary_flags; // the same View as _stationary, writable
  View<int*> _piece_begin; // [piece + 1] first node of a run of nodes of one body
  View<int*> _piece_body; // [piece] place of its body
  View<double* [6]> _step; // [body] box of the motions since the last call; empty between calls
  View<double* [6]> _sums;
  View<int*> _moving; // [body] its nodes that move in this step; 0 between calls
  View<unsigned char*> _is_at_rest;
  BodyMotions _bodies;
};

} // namespace brickwall::contact
