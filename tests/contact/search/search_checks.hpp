// Shared by the search tests: methods by name, ghosts against the definition.
#pragma once

#include "contact/base/to_device.hpp"
#include "contact/search/global_search.hpp"
#include "tests/contact/search/host_rows.hpp"
#include "tests/contact/search/search_oracle.hpp"

#include <gtest/gtest.h>

#include <map>

namespace brickwall::contact::test {

constexpr SearchMethod all_methods[] = {SearchMethod::cluster, SearchMethod::paper,
                                        SearchMethod::reference};

inline const char* nameOf(SearchMethod method) {
  return method == SearchMethod::cluster ? "cluster"
         : method == SearchMethod::paper ? "paper"
                                         : "reference";
}

inline SearchConfig configOf(const SurfaceCase& c, SearchMethod method) {
  SearchConfig config;
  config.method = method;
  config.node_tolerance = c.node_tolerance;
  config.face_tolerance = c.face_tolerance;
  config.drop_same_body = c.drop_same_body;
  return config;
}

inline bool okOnAllRanks(MPI_Comm comm, bool ok) {
  return allReduce(comm, ok ? 1 : 0, MPI_MIN) == 1;
}

// [ghost] the face of the case; -1 for an id that the case does not have.
inline std::vector<int> facesOf(const SurfaceCase& c, const GhostFaces& ghosts) {
  std::map<global_id, int> face_of_id;
  for (std::size_t f = 0; f < c.faces.size(); ++f)
    face_of_id[c.faces[f].id] = static_cast<int>(f);
  const auto ids = toHost(ghosts.face_ids);
  std::vector<int> faces;
  for (int g = 0; g < ghosts.count; ++g) {
    const auto found = face_of_id.find(ids(g));
    faces.push_back(found == face_of_id.end() ? -1 : found->second);
  }
  return faces;
}

// The data of ghosts on the host.
class HostGhosts {
public:
  explicit HostGhosts(const GhostFaces& ghosts)
      : _bodies(toHost(ghosts.bodies)), _corners(toHost(ghosts.corner_ids)),
        _x_old(toHost(ghosts.coordinates_old)), _x_new(toHost(ghosts.coordinates_new)),
        _attributes(toHost(ghosts.attributes)) {}

  bool hasDataOf(const SurfaceCase& c, const CaseFace& face, int g) const {
    bool same = _bodies(g) == face.body;
    for (int k = 0; k < 4; ++k) {
      const CaseNode& node = c.nodes[face.corners[k]];
      same = same && _corners(g, k) == node.id;
      for (int d = 0; d < 3; ++d)
        same =
            same && _x_old(g, 3 * k + d) == node.x_old[d] && _x_new(g, 3 * k + d) == node.x_new[d];
    }
    for (int a = 0; a < num_test_attributes; ++a)
      same = same && attributesAt<TestAttributes>(_attributes, g).value[a] ==
                         testAttributes(face.id).value[a];
    return same;
  }

private:
  View<global_id*>::HostMirror _bodies;
  GhostFaces::CornerIds::HostMirror _corners;
  GhostFaces::CornerCoordinates::HostMirror _x_old, _x_new;
  AttributeWords::HostMirror _attributes;
};

// Checks that the ghosts are the expected faces with their data, by owner; the ghosts of one owner
// come by face id, except with the cluster method, which has an order of its own. Stops at the
// first difference, so that the message is readable.
inline ::testing::AssertionResult ghostsAre(const SurfaceCase& c, const std::vector<int>& expected,
                                            const GhostFaces& ghosts, SearchMethod method) {
  if (ghosts.count != static_cast<int>(expected.size()))
    return ::testing::AssertionFailure()
           << ghosts.count << " ghosts found, " << expected.size() << " expected";
  const std::vector<int> faces = facesOf(c, ghosts);
  const HostGhosts data(ghosts);
  std::vector<int> sorted = faces;
  if (method == SearchMethod::cluster)
    std::sort(sorted.begin(), sorted.end(), [&](int a, int b) {
      return std::make_pair(c.faces[std::max(a, 0)].rank, c.faces[std::max(a, 0)].id) <
             std::make_pair(c.faces[std::max(b, 0)].rank, c.faces[std::max(b, 0)].id);
    });
  for (int g = 0; g < ghosts.count; ++g) {
    if (sorted[g] != expected[g])
      return ::testing::AssertionFailure() << "ghost " << g << " is face " << sorted[g]
                                           << " of the case, expected " << expected[g];
    if (g > 0 && c.faces[faces[g]].rank < c.faces[faces[g - 1]].rank)
      return ::testing::AssertionFailure() << "ghost " << g << " is out of its owner's range";
    if (!data.hasDataOf(c, c.faces[faces[g]], g))
      return ::testing::AssertionFailure()
             << "ghost " << g << " has not the data of face " << c.faces[faces[g]].id;
  }
  return ::testing::AssertionSuccess();
}

} // namespace brickwall::contact::test
