#include "contact/search/local_search.hpp"

#include "contact/base/count_scan_fill.hpp"
#include "contact/base/region.hpp"
#include "contact/search/paper/reference_search.hpp"
#include "contact/surface/candidate_rows.hpp"
#include "contact/surface/candidate_rules.hpp"
#include "contact/surface/row_order.hpp"

namespace brickwall::contact {
namespace {

using DeviceRules = PairRules<memory_space>;

// The exact test of a leaf, and the rules.
struct IsCandidate {
  View<const Box*> node_boxes;
  View<const Box*> face_boxes;
  DeviceRules rules;

  struct OfNode {
    const IsCandidate& all;
    Box box;
    int node;
    KOKKOS_INLINE_FUNCTION bool operator()(int face) const {
      return all.rules.allow(node, face) & box.overlaps(all.face_boxes(face));
    }
  };
  KOKKOS_INLINE_FUNCTION OfNode operator()(int node) const {
    return {*this, node_boxes(node), node};
  }
};

// Boxes of own faces, then of ghosts, by the same arithmetic as the owner's; `all` grows by the ghosts'.
void appendGhostBoxes(const exec_space& space, const View<const Box*>& own, int num_own,
                      const GhostFaces& ghosts, double tolerance, const View<Box*>& joined,
                      Box& all) {
  const auto x_old = ghosts.coordinates_old, x_new = ghosts.coordinates_new;
  Box ghost_box;
  Kokkos::parallel_for(
      "contact::localSearch::own_boxes", rangePolicy(space, num_own),
      KOKKOS_LAMBDA(const std::int64_t face) { joined(face) = own(face); });
  Kokkos::parallel_reduce(
      "contact::localSearch::ghost_boxes", rangePolicy(space, ghosts.count),
      KOKKOS_LAMBDA(const std::int64_t ghost, Box& sum) {
        const Box box = ghostBox(x_old, x_new, ghost, tolerance);
        joined(num_own + ghost) = box;
        sum.include(box);
      },
      PlusReducer<Box>(ghost_box));
  space.fence();
  all.include(ghost_box);
}

// The rows of the result buffer, in the order of nodes, become compressed rows.
void compressRows(const exec_space& space, int num_nodes, const QueryResults& results,
                  const View<std::int64_t*>& offsets, CandidatePairs& pairs) {
  growTo(space, pairs.faces, results.num_rows);
  const auto begin = results.begin, count = results.count;
  const auto items = results.items;
  const auto faces = pairs.faces;
  Kokkos::parallel_scan(
      "contact::localSearch::offsets", rangePolicy(space, num_nodes + 1),
      KOKKOS_LAMBDA(const std::int64_t node, std::int64_t& sum, const bool final) {
        if (final)
          offsets(node) = sum;
        sum += node < num_nodes ? count(node) : 0;
      });
  Kokkos::parallel_for(
      "contact::localSearch::gather", rangePolicy(space, num_nodes),
      KOKKOS_LAMBDA(const std::int64_t node) {
        const std::int64_t first = offsets(node), n = offsets(node + 1) - first;
        for (std::int64_t i = 0; i < n; ++i)
          faces(first + i) = items(begin(node) + i);
      });
}

void sortRows(const exec_space& space, const DeviceRules& rules, const CandidatePairs& pairs) {
  const auto faces = pairs.faces;
  Kokkos::parallel_for(
      "contact::localSearch::sort_rows", rangePolicy(space, pairs.num_rows),
      KOKKOS_LAMBDA(const std::int64_t row) {
        const std::int64_t first = pairs.begin(row), n = pairs.end(row) - first;
        if (n > 1)
          sortRow(&faces(first), n, [&](const int a, const int b) { return rules.before(a, b); });
      });
}

} // namespace

const CandidatePairs& LocalSearch::findCandidatePairs(const exec_space& space,
                                                      const Surface& surface,
                                                      const GlobalSearch& global) {
  const Region region("findCandidatePairs");
  const Region timer("search::local search");
  if (_config.method == SearchMethod::cluster)
    _clusters.find(space, surface, global.ghosts(), global.clusters(), _config, _pairs);
  else
    findByBoxes(space, surface, global.ghosts(), global.boxes());
  return _pairs;
}

void LocalSearch::findByBoxes(const exec_space& space, const Surface& surface,
                              const GhostFaces& ghosts, const SurfaceBoxes& boxes) {
  View<const Box*> face_boxes = boxes.face_boxes;
  Box all = boxes.face_box;
  const int num_faces = surface.num_faces + ghosts.count;
  if (ghosts.count > 0) {
    growTo(space, _face_boxes, num_faces);
    appendGhostBoxes(space, boxes.face_boxes, surface.num_faces, ghosts, _config.face_tolerance,
                     _face_boxes, all);
    face_boxes = _face_boxes;
  }
  const DeviceRules rules(surface, ghosts, _config.drop_same_body);
  if (_config.method == SearchMethod::reference) {
    referencePairs(space, surface, ghosts, boxes.node_boxes, face_boxes, _config.drop_same_body,
                   _offsets, _pairs);
  } else {
    growTo(space, _offsets, surface.num_nodes + 1);
    buildTree(space, face_boxes, num_faces, all, _tree);
    const BoxOfRow box_of{boxes.node_boxes};
    const bool sorted = worthSorting(surface.num_nodes, num_faces);
    if (sorted)
      sortQueries(space, box_of, surface.num_nodes, all, _order);
    queryTree(space, "contact::localSearch::query", _tree, surface.num_nodes, box_of,
              IsCandidate{boxes.node_boxes, face_boxes, rules}, sorted ? &_order : nullptr,
              _results);
    compressRows(space, surface.num_nodes, _results, _offsets, _pairs);
  }
  layOutRowsByNode(space, surface.num_nodes, _offsets, _pairs);
  _pairs.version = 0;
  sortRows(space, rules, _pairs);
}

} // namespace brickwall::contact
