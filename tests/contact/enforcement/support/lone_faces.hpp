// Faces on their own, for tests of kinematics on a host.
#pragma once

#include "contact/base/to_device.hpp"
#include "contact/surface/surface.hpp"

namespace brickwall::contact::testing {

// Faces with four nodes of their own each, followed by `more` nodes.
struct LoneFaces {
  LoneFaces(int n, int more, int words)
      : count(n), x_old("x_old", 4 * n + more), x_new("x_new", 4 * n + more),
        to_nodes("to_nodes", n), body("body", n), ids("ids", n),
        attributes("attributes", n, words) {
    surface.num_nodes = 4 * n + more;
    surface.num_faces = n;
    surface.coordinates_old = x_old;
    surface.coordinates_new = x_new;
    surface.face_to_nodes = to_nodes;
    surface.face_body = body;
    surface.face_ids = ids;
    surface.face_attributes = attributes;
    for (int f = 0; f < n; ++f) {
      body(f) = ids(f) = f;
      for (int j = 0; j < 4; ++j)
        to_nodes(f, j) = 4 * f + j;
    }
  }
  void set(int node, const Vec3& now, const Vec3& before) {
    for (int d = 0; d < 3; ++d) {
      x_new(node, d) = now[d];
      x_old(node, d) = before[d];
    }
  }
  EdgeAttributes& edge(int e) { return attributesAt<EdgeAttributes>(attributes, e); }
  int count;
  View<double*[3]> x_old, x_new;
  View<int* [4]> to_nodes;
  View<global_id*> body, ids;
  AttributeWords attributes;
  Surface surface;
};

} // namespace brickwall::contact::testing
