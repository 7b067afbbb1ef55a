// Rendezvous by node id: each rank reports its nodes to their homes, and the homes send each sharer
// the list of the others.
#include "io/mesh/shared_nodes.hpp"

#include "contact/base/mpi.hpp"
#include "io/mesh/id_slices.hpp"
#include "io/mesh/local_numbering.hpp"

#include <algorithm>
#include <utility>

namespace brickwall::io {

namespace {

struct Sharer {
  global_id node;
  std::int64_t rank; // 64 bits: no padding goes through MPI
};

// The answer of the home of a slice of nodes to each rank: the other ranks that share its nodes.
std::vector<std::vector<Sharer>>
introduceSharers(const std::vector<std::vector<global_id>>& known) {
  std::vector<std::pair<global_id, int>> claims; // node, rank
  for (std::size_t q = 0; q < known.size(); ++q)
    for (const global_id node : known[q])
      claims.emplace_back(node, static_cast<int>(q));
  std::sort(claims.begin(), claims.end());

  std::vector<std::vector<Sharer>> answers(known.size());
  for (std::size_t begin = 0, end = 0; begin < claims.size(); begin = end) {
    while (end < claims.size() && claims[end].first == claims[begin].first)
      ++end;
    for (std::size_t a = begin; a < end; ++a)
      for (std::size_t b = begin; b < end; ++b)
        if (a != b)
          answers[claims[a].second].push_back({claims[a].first, claims[b].second});
  }
  return answers;
}

} // namespace

NodeSharing findSharedNodes(MPI_Comm comm, const std::vector<global_id>& node_ids,
                            global_id num_global_nodes) {
  const int size = sizeOf(comm), rank = rankOf(comm);
  NodeSharing sharing;
  sharing.node_owner.assign(node_ids.size(), rank);
  if (size == 1)
    return sharing;
  const IdSlices homes{num_global_nodes, size};
  std::vector<std::vector<global_id>> to_homes(size);
  for (const global_id node : node_ids)
    to_homes[homes.rankOf(node)].push_back(node);
  const auto answers = exchangeByRank(comm, introduceSharers(exchangeByRank(comm, to_homes)));
  std::vector<std::vector<int>> nodes_of_rank(size);
  // Homes hold ascending slices and answer in the order of node id, so each list ascends.
  for (const auto& from_home : answers)
    for (const Sharer& sharer : from_home) {
      const int node = localIndex(node_ids, sharer.node);
      const int other = static_cast<int>(sharer.rank);
      sharing.node_owner[node] = std::min(sharing.node_owner[node], other);
      nodes_of_rank[other].push_back(node);
    }
  for (int q = 0; q < size; ++q)
    if (!nodes_of_rank[q].empty())
      sharing.sharers.push_back({q, std::move(nodes_of_rank[q])});
  return sharing;
}

} // namespace brickwall::io
