// Worked example of CONTRIBUTING.md, "Adding a search method": the local search by a sweep along x.
// The phases between ranks are those of PaperSearch.
#include "contact/search/paper/paper_search.hpp"
#include "contact/surface/candidate_rows.hpp"
#include "tests/contact/search/host_rows.hpp"
#include "tests/contact/search/search_oracle.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

namespace brickwall::contact {
namespace {

class SweepSearch final : public PaperSearch {
protected:
  // [node + 1] offsets and faces of the rows; PaperSearch sorts each row.
  void findRows(const exec_space& space, const SweptBoxes& surface, const GhostFaces& ghosts,
                const View<const Box*>& face_boxes, const Box&, bool drop_same_body) override {
    const auto nodes = toHost(View<const Box*>(_boxes.node_boxes)), faces = toHost(face_boxes);
    const auto owned = toHost(surface.node_is_owned);
    const PairRules<Kokkos::HostSpace> rules(surface, ghosts, drop_same_body);
    std::vector<int> by_begin(surface.num_faces + ghosts.count);
    std::iota(by_begin.begin(), by_begin.end(), 0);
    std::sort(by_begin.begin(), by_begin.end(),
              [&](int a, int b) { return faces(a).lower[0] < faces(b).lower[0]; });
    double longest = 0;
    for (const int face : by_begin)
      longest = std::max(longest, faces(face).upper[0] - faces(face).lower[0]);
    std::vector<std::int64_t> offsets(1, 0);
    std::vector<int> found;
    for (int node = 0; node < surface.num_nodes; ++node) {
      auto first =
          std::lower_bound(by_begin.begin(), by_begin.end(), nodes(node).lower[0] - longest,
                           [&](int face, double x) { return faces(face).lower[0] < x; });
      for (;
           owned(node) && first != by_begin.end() && faces(*first).lower[0] <= nodes(node).upper[0];
           ++first)
        if (nodes(node).overlaps(faces(*first)) && rules.allow(node, *first))
          found.push_back(*first);
      offsets.push_back(static_cast<std::int64_t>(found.size()));
    }
    copyToDevice(space, offsets, _offsets);
    copyToDevice(space, found, _pairs.faces);
  }
};

// GlobalSearch makes these calls; on one rank the phases between them have nothing to do.
TEST(ExampleSearchMethod, FindsThePairsOfTheDefinition) {
  if (sizeOf(MPI_COMM_WORLD) > 1)
    GTEST_SKIP() << "the example makes the calls of one rank";
  const exec_space space;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const test::SurfaceCase c = test::makeCase(seed, 1);
    const test::LocalSurface local = test::localSurface(c, 0);
    SearchConfig config;
    config.node_tolerance = c.node_tolerance;
    config.face_tolerance = c.face_tolerance;
    config.drop_same_body = c.drop_same_body;
    SweepSearch search;
    search.constructBoxes(space, local.surface, config);
    search.findPairs(space, local.surface, GhostFaces(), config);
    const test::Expected expected = test::expectedOnRank(c, local, 0);
    const test::HostRows rows(search.pairs());
    for (int row = 0; row < search.pairs().num_rows; ++row) {
      std::vector<int> found;
      for (const int face : rows.faces(row))
        found.push_back(local.faces[face]);
      EXPECT_EQ(found, expected.pairs[rows.node(row)]) << "seed " << seed;
    }
  }
}

} // namespace
} // namespace brickwall::contact
