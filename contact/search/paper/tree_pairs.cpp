#include "contact/search/paper/tree_pairs.hpp"

#include "contact/base/scan.hpp"

namespace brickwall::contact {
namespace {

// The exact test of a leaf, together with the rules.
struct IsCandidate {
  View<const Box*> node_boxes;
  View<const Box*> face_boxes;
  PairRules<memory_space> rules;

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

// Copies the rows of the result buffer in the order of nodes.
void compressRows(const exec_space& space, int num_nodes, const QueryResults& results,
                  const View<std::int64_t*>& offsets, CandidatePairs& pairs) {
  growTo(space, pairs.faces, results.num_rows);
  const auto begin = results.begin;
  const auto items = results.items;
  const auto faces = pairs.faces;
  launchScan(space, "contact::findPairsByTree::offsets", results.count, num_nodes, offsets);
  Kokkos::parallel_for(
      "contact::findPairsByTree::gather", rangePolicy(space, num_nodes),
      KOKKOS_LAMBDA(const std::int64_t node) {
        const std::int64_t first = offsets(node), n = offsets(node + 1) - first;
        for (std::int64_t i = 0; i < n; ++i)
          faces(first + i) = items(begin(node) + i);
      });
}

} // namespace

void findPairsByTree(const exec_space& space, const View<const Box*>& node_boxes, int num_nodes,
                     const View<const Box*>& face_boxes, int num_faces, const Box& all,
                     const PairRules<memory_space>& rules, TreePairs& search,
                     View<std::int64_t*>& offsets, CandidatePairs& pairs) {
  growTo(space, offsets, num_nodes + 1);
  buildTree(space, face_boxes, num_faces, all, search.tree);
  const BoxOfRow box_of{node_boxes};
  const bool sorted = worthSorting(num_nodes, num_faces);
  if (sorted)
    sortQueries(space, box_of, num_nodes, all, search.order);
  queryTree(space, "contact::findPairsByTree::query", search.tree, num_nodes, box_of,
            IsCandidate{node_boxes, face_boxes, rules}, sorted ? &search.order : nullptr,
            search.results);
  compressRows(space, num_nodes, search.results, offsets, pairs);
}

} // namespace brickwall::contact
