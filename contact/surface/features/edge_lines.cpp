// See edge_lines.hpp. The rank chosen by the id of a node decides which of the edges that end there
// continue each other. Lines are joined on their rank first; parts that go on on other ranks are
// told to all.
#include "contact/surface/features/edge_lines.hpp"

#include "contact/base/hash.hpp"
#include "contact/base/to_device.hpp"
#include "contact/base/vec3.hpp"
#include "contact/surface/features/joined_parts.hpp"

namespace brickwall::contact {
namespace {

constexpr double head_on = -0.75; // cosine of the directions of edges that continue each other

// One end of a convex edge. The id of an edge is 4 times that of its face, plus its number there.
struct EdgeEnd {
  global_id node, edge;
  Vec3 direction; // unit, from the node along the edge
  int rank, index, end; // of the sender
  int unused;

  auto key() const { return std::tie(node, edge); }
};
// That the edge `index` of the receiver goes on beyond `end` in the edge `next`.
struct Continuation {
  global_id next;
  int index, end;
};

template <class FaceToNodes, class Coordinates>
Vec3 directionFrom(int end, const FeatureEdge& edge, const FaceToNodes& face_to_nodes,
                   const Coordinates& x) {
  const Vec3 way = rowOf(x, face_to_nodes(edge.face, (edge.edge + 1 - end) % 4)) -
                   rowOf(x, face_to_nodes(edge.face, (edge.edge + end) % 4));
  return (1 / norm(way)) * way;
}

std::vector<Continuation> findContinuations(MPI_Comm comm, const Surface& surface,
                                            const std::vector<FeatureEdge>& edges,
                                            const std::vector<global_id>& ids) {
  const int num_ranks = sizeOf(comm), rank = rankOf(comm);
  const auto face_to_nodes = toHost(surface.face_to_nodes);
  const auto x = toHost(surface.coordinates_new);
  const auto node_ids = toHost(surface.node_ids);
  std::vector<std::vector<EdgeEnd>> ends(num_ranks);
  for (std::size_t i = 0; i < edges.size(); ++i)
    for (int end = 0; end < 2; ++end) {
      const global_id node = node_ids(face_to_nodes(edges[i].face, (edges[i].edge + end) % 4));
      ends[node % num_ranks].push_back({node, ids[i],
                                        directionFrom(end, edges[i], face_to_nodes, x), rank,
                                        static_cast<int>(i), end, 0});
    }
  std::vector<EdgeEnd> all = joined(exchangeByRank(comm, ends));
  std::sort(all.begin(), all.end(),
            [](const EdgeEnd& a, const EdgeEnd& b) { return a.key() < b.key(); });
  std::vector<std::vector<Continuation>> replies(num_ranks);
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t j = i + 1; j < all.size() && all[j].node == all[i].node; ++j)
      if (dot(all[i].direction, all[j].direction) < head_on) {
        replies[all[i].rank].push_back({all[j].edge, all[i].index, all[i].end});
        replies[all[j].rank].push_back({all[i].edge, all[j].index, all[j].end});
      }
  return joined(exchangeByRank(comm, replies));
}

// The lowest ids of the lines that go on on other ranks, by the lowest ids of their parts here.
// `lines` [edge] the latter.
std::map<global_id, global_id> joinLines(MPI_Comm comm, const std::vector<global_id>& ids,
                                         const std::vector<global_id>& lines,
                                         const std::vector<Continuation>& continuations) {
  std::vector<Meeting> meetings;
  for (const Continuation& c : continuations)
    meetings.push_back(
        {std::min(ids[c.index], c.next), std::max(ids[c.index], c.next), lines[c.index]});
  std::vector<Meeting> all = gatherFromAll(comm, meetings);
  std::sort(all.begin(), all.end());
  return joinParts(all, [](const Meeting&) { return true; });
}

} // namespace

void findLines(MPI_Comm comm, const Surface& surface, std::vector<FeatureEdge>& edges) {
  const auto face_ids = toHost(surface.face_ids);
  std::vector<global_id> ids;
  std::vector<std::pair<global_id, int>> places; // of ids in `edges`
  for (const FeatureEdge& edge : edges) {
    places.emplace_back(4 * face_ids(edge.face) + edge.edge, static_cast<int>(ids.size()));
    ids.push_back(places.back().first);
  }
  std::sort(places.begin(), places.end());
  DisjointSets parts(edges.size());
  std::vector<Continuation> on_other_ranks;
  for (const Continuation& c : findContinuations(comm, surface, edges, ids)) {
    edges[c.index].goes_on |= 1 << c.end;
    const auto next = std::lower_bound(places.begin(), places.end(), std::make_pair(c.next, 0));
    if (next != places.end() && next->first == c.next)
      parts.join(c.index, next->second);
    else
      on_other_ranks.push_back(c);
  }
  const std::vector<global_id> lines = parts.lowestOfSets(ids);
  const auto joined = joinLines(comm, ids, lines, on_other_ranks);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const auto whole = joined.find(lines[i]);
    const global_id line = whole == joined.end() ? lines[i] : whole->second;
    edges[i].line = static_cast<int>(hashOfWord(static_cast<std::uint64_t>(line)) % num_lines);
  }
}

} // namespace brickwall::contact
