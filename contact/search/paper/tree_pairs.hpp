// The local search of the paper: node boxes against a tree of the face boxes.
#pragma once

#include "contact/search/spatial/bvh_query.hpp"
#include "contact/surface/candidate_rows.hpp"

namespace brickwall::contact {

// Scratch of the search.
struct TreePairs {
  Bvh tree;
  QueryOrder order;
  QueryResults results;
};

// Sets `offsets` [node + 1] and pairs.faces, the candidate faces of each node in no particular
// order. `face_boxes` [0, num_faces) are those of own faces, then of ghosts; `all` contains them.
// Not collective.
void findPairsByTree(const exec_space& space, const View<const Box*>& node_boxes, int num_nodes,
                     const View<const Box*>& face_boxes, int num_faces, const Box& all,
                     const PairRules<memory_space>& rules, TreePairs& search,
                     View<std::int64_t*>& offsets, CandidatePairs& pairs);

} // namespace brickwall::contact
