// The ghosts and pairs of a random surface by the definition, from all pairs. Uses nothing of the
// search but its data types.
#pragma once

#include "tests/contact/search/search_cases.hpp"

namespace brickwall::contact::test {

// The definition of a pair: the inflated ranges of node and face overlap in all three directions.
inline bool boxesMeet(const SurfaceCase& c, const CaseNode& node, const CaseFace& face) {
  for (int d = 0; d < 3; ++d) {
    const double node_low = std::min(node.x_old[d], node.x_new[d]) - c.node_tolerance;
    const double node_high = std::max(node.x_old[d], node.x_new[d]) + c.node_tolerance;
    double face_low = c.nodes[face.corners[0]].x_old[d], face_high = face_low;
    for (const int corner : face.corners)
      for (const double x : {c.nodes[corner].x_old[d], c.nodes[corner].x_new[d]}) {
        face_low = std::min(face_low, x);
        face_high = std::max(face_high, x);
      }
    if (node_high < face_low - c.face_tolerance || face_high + c.face_tolerance < node_low)
      return false;
  }
  return true;
}

struct Expected {
  std::vector<int> ghosts; // indices of faces, in order
  std::vector<std::vector<int>> pairs; // [local node] indices of faces, in order
};

inline Expected expectedOnRank(const SurfaceCase& c, const LocalSurface& local, int rank) {
  Expected expected;
  expected.pairs.resize(local.nodes.size());
  for (std::size_t f = 0; f < c.faces.size(); ++f) {
    const CaseFace& face = c.faces[f];
    bool touched = false;
    for (std::size_t i = 0; i < local.nodes.size(); ++i) {
      const CaseNode& node = c.nodes[local.nodes[i]];
      if (node.owner != rank || !boxesMeet(c, node, face))
        continue;
      touched = true;
      const bool own = std::any_of(face.corners.begin(), face.corners.end(),
                                   [&](int corner) { return corner == local.nodes[i]; });
      if (!own && !(c.drop_same_body && node.body == face.body))
        expected.pairs[i].push_back(static_cast<int>(f));
    }
    if (touched && face.rank != rank)
      expected.ghosts.push_back(static_cast<int>(f));
  }
  const auto byOwner = [&](int a, int b) {
    return std::make_pair(c.faces[a].rank, c.faces[a].id) <
           std::make_pair(c.faces[b].rank, c.faces[b].id);
  };
  const auto byBody = [&](int a, int b) {
    return std::make_pair(c.faces[a].body, c.faces[a].id) <
           std::make_pair(c.faces[b].body, c.faces[b].id);
  };
  std::sort(expected.ghosts.begin(), expected.ghosts.end(), byOwner);
  for (auto& row : expected.pairs)
    std::sort(row.begin(), row.end(), byBody);
  return expected;
}

} // namespace brickwall::contact::test
