// Faces near a cluster of nodes, and those of its last search.
#pragma once

#include "contact/search/cluster/cluster_pairs.hpp"

#include <cstdint>

namespace brickwall::contact {

constexpr int max_hits =
    cluster_size > 1 ? 256
                     : 32; // faces that a cluster keeps; clusters with more take a slower path
constexpr int max_sorted_hits = 64; // most hits that selectRows() sorts
// Blocks whose faces a cluster tests one after another.
constexpr int blocks_at_once = cluster_size > 1 ? 32 : 1;

// Faces whose boxes overlap those of some nodes of a cluster. An item is the position of an own
// face, or num_faces + ghost index.
struct Hits {
  int item[max_hits + blocks_at_once * block_size];
  int key[max_hits]; // of own faces: rank in the order of rows, set by applyRules()
  unsigned lanes[max_hits + blocks_at_once * block_size]; // the nodes
  unsigned surely[max_hits + blocks_at_once * block_size]; // those without a tie in floats
  int count = 0;
  bool are_own = true; // none of them is a ghost
  bool may_be_same_body = false; // some own faces may belong to the body of some of the nodes
};

// The hits of the last search from which a cluster made its rows, in the order of the tree and
// without ties. Equal hits give the same rows while the order is kept, since rules look at ids
// only.
struct KeptHits {
  View<int*> count; // [cluster], plus 1; 0: none are kept. Empty where clusters have one node.
  View<unsigned*> words; // [cluster][item, lanes][max_sorted_hits]

  KOKKOS_INLINE_FUNCTION unsigned* wordsOf(int cluster) const {
    return words.data() + std::int64_t(cluster) * (2 * max_sorted_hits);
  }
  // Asks for what areEqual() reads.
  KOKKOS_FORCEINLINE_FUNCTION void prefetchHits(int cluster) const {
    constexpr int words_of_line = 16;
    const unsigned* const items = wordsOf(cluster);
    for (int i = 0; i < count(cluster) - 1; i += words_of_line) {
      prefetch(items + i);
      prefetch(items + max_sorted_hits + i);
    }
  }
  KOKKOS_INLINE_FUNCTION bool areEqual(int cluster, const Hits& hits) const {
    if (count(cluster) != hits.count + 1)
      return false;
    const unsigned* const items = wordsOf(cluster);
    const unsigned* const lanes = items + max_sorted_hits;
    unsigned difference = 0;
    for (int i = 0; i < hits.count; ++i)
      difference |= (items[i] ^ static_cast<unsigned>(hits.item[i])) | (lanes[i] ^ hits.lanes[i]);
    return difference == 0;
  }
  KOKKOS_INLINE_FUNCTION void keep(int cluster, const Hits& hits) const {
    unsigned* const items = wordsOf(cluster);
    for (int i = 0; i < hits.count; ++i) {
      items[i] = static_cast<unsigned>(hits.item[i]);
      items[max_sorted_hits + i] = hits.lanes[i];
    }
    count(cluster) = hits.count + 1;
  }
};

} // namespace brickwall::contact
