// See feature_edges.hpp. A rank chosen by the nodes of an edge receives a record from each face of
// the edge, decides, and replies.
#include "contact/surface/feature_edges.hpp"

#include "contact/base/mpi.hpp"
#include "contact/base/to_device.hpp"
#include "contact/surface/check_surface.hpp"
#include "contact/surface/projection.hpp"

#include <algorithm>
#include <tuple>

namespace brickwall::contact {
namespace {

struct EdgeRecord {
  global_id low_node, high_node, face_id;
  Vec3 normal, centre; // of the face
  Vec3 on_edge; // the middle of the edge
  double width; // of the face: area over the edge's length
  int rank, face, edge; // of the sender
  int unused;

  auto key() const { return std::tie(low_node, high_node, face_id); }
  bool sameEdge(const EdgeRecord& b) const {
    return low_node == b.low_node && high_node == b.high_node;
  }
};

struct EdgeReply {
  int face, edge;
  int is_convex; // and this face lists it
  int unused;
  double cosine, sine, width[2];
};

std::vector<std::vector<EdgeRecord>> recordsOf(int num_ranks, int rank, const Surface& surface) {
  const auto face_to_nodes = toHost(surface.face_to_nodes);
  const auto x = toHost(surface.coordinates_new);
  const auto node_ids = toHost(surface.node_ids), face_ids = toHost(surface.face_ids);
  std::vector<std::vector<EdgeRecord>> records(num_ranks);
  for (int face = 0; face < surface.num_faces; ++face) {
    Quad quad;
    Vec3 centre;
    for (int j = 0; j < 4; ++j) {
      quad.corner[j] = rowOf(x, face_to_nodes(face, j));
      centre += 0.25 * quad.corner[j];
    }
    const MeanPlane plane = planeOfArea(areaVector(quad));
    for (int j = 0; j < 4; ++j) {
      const global_id a = node_ids(face_to_nodes(face, j));
      const global_id b = node_ids(face_to_nodes(face, (j + 1) % 4));
      if (a == b) // a triangle
        continue;
      EdgeRecord record;
      record.low_node = std::min(a, b);
      record.high_node = std::max(a, b);
      record.face_id = face_ids(face);
      record.normal = plane.normal;
      record.centre = centre;
      record.on_edge = 0.5 * (quad.corner[j] + quad.corner[(j + 1) % 4]);
      record.width = plane.area / norm(quad.corner[(j + 1) % 4] - quad.corner[j]);
      record.rank = rank, record.face = face, record.edge = j, record.unused = 0;
      records[(record.low_node + record.high_node) % num_ranks].push_back(record);
    }
  }
  return records;
}

// Appends the replies to the faces [first, last) of one edge.
void judgeEdge(const EdgeRecord* first, const EdgeRecord* last, double largest_cosine,
               std::vector<std::vector<EdgeReply>>& replies) {
  EdgeReply reply{0, 0, 0, 0, 1, 0, {0, 0}};
  if (last - first == 2) {
    const EdgeRecord &a = first[0], &b = first[1];
    reply.cosine = dot(a.normal, b.normal);
    if (reply.cosine > largest_cosine)
      return;
    reply.sine = norm(cross(a.normal, b.normal));
    reply.width[0] = a.width, reply.width[1] = b.width;
    const bool is_convex =
        dot(b.centre - a.on_edge, a.normal) < 0 && dot(a.centre - a.on_edge, b.normal) < 0;
    reply.is_convex = is_convex && reply.sine > 0;
  }
  for (const EdgeRecord* record = first; record != last; ++record) {
    reply.face = record->face;
    reply.edge = record->edge;
    replies[record->rank].push_back(reply);
    reply.is_convex = 0; // only the first lists it
  }
}

// One end of a convex edge.
struct EdgeEnd {
  global_id node, face_id; // of the edge: unique together with `edge`
  Vec3 direction; // unit, from the node along the edge
  int rank, index, edge, end;

  auto key() const { return std::tie(node, face_id, edge); }
};
struct EndReply {
  int index, end;
};

// Sets FeatureEdge::goes_on. The rank chosen by the id of a node decides for the edges that end
// there.
void findContinuations(MPI_Comm comm, const Surface& surface, std::vector<FeatureEdge>& edges) {
  const int num_ranks = sizeOf(comm);
  const auto face_to_nodes = toHost(surface.face_to_nodes);
  const auto x = toHost(surface.coordinates_new);
  const auto node_ids = toHost(surface.node_ids), face_ids = toHost(surface.face_ids);
  std::vector<std::vector<EdgeEnd>> ends(num_ranks);
  for (std::size_t i = 0; i < edges.size(); ++i)
    for (int end = 0; end < 2; ++end) {
      const FeatureEdge& edge = edges[i];
      const int node = face_to_nodes(edge.face, (edge.edge + end) % 4);
      const int other = face_to_nodes(edge.face, (edge.edge + 1 - end) % 4);
      const Vec3 way = rowOf(x, other) - rowOf(x, node);
      ends[node_ids(node) % num_ranks].push_back({node_ids(node), face_ids(edge.face),
                                                  (1 / norm(way)) * way, rankOf(comm),
                                                  static_cast<int>(i), edge.edge, end});
    }
  std::vector<EdgeEnd> all;
  for (const auto& some : exchangeByRank(comm, ends))
    all.insert(all.end(), some.begin(), some.end());
  std::sort(all.begin(), all.end(),
            [](const EdgeEnd& a, const EdgeEnd& b) { return a.key() < b.key(); });
  constexpr double head_on = -0.75; // cosine
  std::vector<std::vector<EndReply>> replies(num_ranks);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto meets = [&](std::size_t j) {
      return dot(all[i].direction, all[j].direction) < head_on;
    };
    bool goes_on = false;
    for (std::size_t j = i; !goes_on && j-- > 0 && all[j].node == all[i].node;)
      goes_on = meets(j);
    for (std::size_t j = i + 1; !goes_on && j < all.size() && all[j].node == all[i].node; ++j)
      goes_on = meets(j);
    if (goes_on)
      replies[all[i].rank].push_back({all[i].index, all[i].end});
  }
  for (const auto& some : exchangeByRank(comm, replies))
    for (const EndReply& reply : some)
      edges[reply.index].goes_on |= 1 << reply.end;
}

} // namespace

FeatureEdges findFeatureEdges(MPI_Comm comm, const Surface& surface, double cosine) {
  checkSurface(exec_space(), comm, "findFeatureEdges", surface);
  const int num_ranks = sizeOf(comm);
  const auto received = exchangeByRank(comm, recordsOf(num_ranks, rankOf(comm), surface));
  std::vector<EdgeRecord> records;
  for (const auto& some : received)
    records.insert(records.end(), some.begin(), some.end());
  std::sort(records.begin(), records.end(),
            [](const EdgeRecord& a, const EdgeRecord& b) { return a.key() < b.key(); });
  std::vector<std::vector<EdgeReply>> replies(num_ranks);
  for (std::size_t begin = 0; begin < records.size();) {
    std::size_t end = begin + 1;
    while (end < records.size() && records[end].sameEdge(records[begin]))
      ++end;
    judgeEdge(&records[begin], records.data() + end, cosine, replies);
    begin = end;
  }
  FeatureEdges edges;
  edges.true_edges.assign(surface.num_faces, 0);
  for (const auto& some : exchangeByRank(comm, replies))
    for (const EdgeReply& reply : some) {
      edges.true_edges[reply.face] |= static_cast<unsigned char>(1 << reply.edge);
      if (reply.is_convex)
        edges.convex.push_back(
            {reply.face, reply.edge, reply.cosine, reply.sine, {reply.width[0], reply.width[1]}});
    }
  std::sort(edges.convex.begin(), edges.convex.end(),
            [](const FeatureEdge& a, const FeatureEdge& b) {
              return std::tie(a.face, a.edge) < std::tie(b.face, b.edge);
            });
  findContinuations(comm, surface, edges.convex);
  return edges;
}

} // namespace brickwall::contact
