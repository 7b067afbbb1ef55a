// Queries of the tree (paper, section 5): stack traversal, one query per thread, queries in Morton
// order to reduce divergence, results through an atomic index into one buffer. On overflow the
// buffer is resized and the search repeated.
#pragma once

#include "contact/search/spatial/bvh.hpp"

namespace brickwall::contact {

// Accepted items of each query. The rows of a query are contiguous. The order of rows within a
// query and of queries in the buffer is arbitrary.
struct QueryResults {
  View<std::int64_t*> begin{"contact::QueryResults::begin", 0}; // [query] first row
  View<std::int64_t*> count{"contact::QueryResults::count", 0}; // [query] number of rows
  View<int*> items{"contact::QueryResults::items", 0}; // buffer, kept at its greatest size
  View<std::int64_t*> total{"contact::QueryResults::total", 1}; // the atomic result index
  std::int64_t num_rows = 0;
  int num_passes = 0; // 2 when the buffer overflowed
};

// The order in which queries run.
struct QueryOrder {
  SortedKeys sorted;
};

// Results that a query keeps on the stack before it reserves rows of the buffer.
constexpr int local_results = 32;

// Walks the tree with one query, calling visit(item) for each leaf whose float box overlaps the
// query's.
template <class Visit>
KOKKOS_FORCEINLINE_FUNCTION void traverse(const View<const TreeNode*>& nodes,
                                          const FloatQuery& query, const Visit& visit) {
  const TreeNode* const first = nodes.data();
  int stack[max_tree_depth];
  int depth = 0, next = 0;
  for (;;) {
    const TreeNode& node = first[next];
    bool overlaps[2];
    query.test(node, overlaps);
    for (int side = 0; side < 2; ++side)
      if (overlaps[side] && node.child[side] < 0) {
        visit(~node.child[side]);
        overlaps[side] = false;
      }
    if (overlaps[0]) {
      if (overlaps[1])
        stack[depth++] = node.child[1];
      next = node.child[0];
    } else if (overlaps[1]) {
      next = node.child[1];
    } else {
      if (depth == 0)
        return;
      next = stack[--depth];
    }
  }
}

// Queries need only be near those that run before and after them, for which 11 bits of the code per
// axis suffice.
constexpr int query_order_bits = 33;

template <class BoxOf>
struct SetQueryCode {
  MortonGrid grid;
  BoxOf box_of;
  View<std::uint64_t*> codes;
  View<int*> values;

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t query) const {
    codes(query) = mortonCode(grid, box_of(static_cast<int>(query)).centroid()) >>
                   (morton_bits - query_order_bits);
    values(query) = static_cast<int>(query);
  }
};

// Morton order of the boxes box_of(query), query < num_queries.
template <class BoxOf>
void sortQueries(const exec_space& space, const BoxOf& box_of, int num_queries, const Box& all,
                 QueryOrder& order) {
  order.sorted.grow(space, num_queries);
  Kokkos::parallel_for(
      "contact::sortQueries::codes", rangePolicy(space, num_queries),
      SetQueryCode<BoxOf>{MortonGrid(all), box_of, order.sorted.keys, order.sorted.values});
  sortByKey(space, num_queries, query_order_bits, order.sorted);
}

// The paper does not sort where one set is much smaller than the other.
inline bool worthSorting(std::int64_t num_queries, std::int64_t num_items) {
  return minOf(num_queries, num_items) * 8 >= maxOf(num_queries, num_items);
}

// The row of one query; a row that does not fit the buffer is counted only.
template <class BoxOf, class Accept>
struct QueryRow {
  BoxOf box_of;
  Accept accept;
  View<const TreeNode*> nodes;
  int num_items;
  View<const int*> order; // or empty
  View<std::int64_t*> begin, count, total;
  View<int*> items;

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t q) const {
    const int query = order.extent(0) > 0 ? order(q) : static_cast<int>(q);
    const FloatQuery box(box_of(query));
    const auto accepts = accept(query);
    int found[local_results + 1]; // the last entry takes the results beyond local_results
    std::int64_t num_found = 0;
    const auto keep = [&](const int item) {
      found[minOf(num_found, std::int64_t(local_results))] = item;
      num_found += accepts(item) ? 1 : 0;
    };
    if (num_items > 0)
      traverse(nodes, box, keep);
    std::int64_t next = num_found > 0 ? Kokkos::atomic_fetch_add(&total(0), num_found) : 0;
    begin(query) = next;
    count(query) = num_found;
    if (next + num_found > static_cast<std::int64_t>(items.extent(0)))
      return;
    if (num_found <= local_results) {
      for (std::int64_t i = 0; i < num_found; ++i)
        items(next + i) = found[i];
      return;
    }
    traverse(nodes, box, [&](const int item) { // found again, directly into the buffer
      if (accepts(item))
        items(next++) = item;
    });
  }
};

// Finds for each query < num_queries the items that accept(query)(item) accepts, among the leaves
// that box_of(query) may overlap in floats; accept() makes the exact test. Queries run in `order`
// if it is not null. Returns the number of rows. Fences.
template <class BoxOf, class Accept>
std::int64_t queryTree(const exec_space& space, const std::string& label, const Bvh& tree,
                       int num_queries, const BoxOf& box_of, const Accept& accept,
                       const QueryOrder* order, QueryResults& results) {
  growTo(space, results.begin, num_queries);
  growTo(space, results.count, num_queries);
  if (results.items.extent(0) == 0)
    growTo(space, results.items, 8 * static_cast<std::int64_t>(num_queries));
  const View<const int*> query_order = order ? order->sorted.values : View<int*>();
  for (results.num_passes = 1;; ++results.num_passes) {
    Kokkos::deep_copy(space, results.total, std::int64_t(0));
    Kokkos::parallel_for(label, rangePolicy(space, num_queries),
                         QueryRow<BoxOf, Accept>{box_of, accept, tree.nodes, tree.num_items,
                                                 query_order, results.begin, results.count,
                                                 results.total, results.items});
    Kokkos::deep_copy(space,
                      Kokkos::View<std::int64_t*, Kokkos::HostSpace, Kokkos::MemoryUnmanaged>(
                          &results.num_rows, 1),
                      results.total);
    space.fence();
    if (results.num_rows <= static_cast<std::int64_t>(results.items.extent(0)))
      return results.num_rows;
    growTo(space, results.items, results.num_rows);
  }
}

// The exact test of the box of one query against rows of an array.
struct OverlapsRow {
  Box box;
  const Box* rows;
  KOKKOS_INLINE_FUNCTION bool operator()(int row) const { return box.overlaps(rows[row]); }
};

// Queries that are rows of an array of boxes, or of a list of them.
struct BoxOfRow {
  View<const Box*> boxes;
  KOKKOS_INLINE_FUNCTION const Box& operator()(int query) const { return boxes(query); }
};
struct BoxOfListed {
  View<const Box*> boxes;
  View<const int*> rows;
  KOKKOS_INLINE_FUNCTION const Box& operator()(int query) const { return boxes(rows(query)); }
};

} // namespace brickwall::contact
