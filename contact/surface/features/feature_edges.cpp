// See feature_edges.hpp. Faces of an edge are matched on their rank, unless both nodes of the edge
// are on other ranks as well: then a rank chosen by these nodes receives a record from each face,
// decides, and replies.
#include "contact/surface/features/feature_edges.hpp"

#include "contact/base/group_by_key.hpp"
#include "contact/base/mpi.hpp"
#include "contact/base/to_device.hpp"
#include "contact/surface/check_surface.hpp"
#include "contact/surface/features/edge_lines.hpp"
#include "contact/surface/features/surface_sides.hpp"
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
  int is_feature; // otherwise it is bent
  int is_concave;
  int unused;
  double cosine, sine, width[2];
};
constexpr EdgeReply no_reply{0, 0, 0, 1, 0, 0, 1, 0, {0, 0}};

constexpr double flat_cosine = 1 - 5e-7; // of the angle 1e-3
constexpr double concave_cosine = 0.99875; // of the angle 0.05

template <class T>
using HostCopy = decltype(toHost(View<T>()));

// Host mirrors of a surface and, of each face, what its records have in common.
struct HostSurface {
  HostCopy<const int* [4]> face_to_nodes;
  HostCopy<const double* [3]> x;
  HostCopy<const global_id*> node_ids, face_ids;
  std::vector<Vec3> centres, normals; // [face]
  std::vector<double> areas; // [face]

  explicit HostSurface(const Surface& surface)
      : face_to_nodes(toHost(surface.face_to_nodes)), x(toHost(surface.coordinates_new)),
        node_ids(toHost(surface.node_ids)), face_ids(toHost(surface.face_ids)),
        centres(surface.num_faces), normals(surface.num_faces), areas(surface.num_faces) {
    parallelOnHost("contact::findFeatureEdges::faces", surface.num_faces, [&](std::int64_t face) {
      Quad quad;
      for (int j = 0; j < 4; ++j) {
        quad.corner[j] = rowOf(x, face_to_nodes(face, j));
        centres[face] += 0.25 * quad.corner[j];
      }
      const MeanPlane plane = planeOfArea(areaVector(quad));
      normals[face] = plane.normal;
      areas[face] = plane.area;
    });
  }

  // Local node of an end of edge 4 face + j.
  int node(std::int64_t edge, int end) const { return face_to_nodes(edge / 4, (edge + end) % 4); }
  int lowNode(std::int64_t edge) const { return std::min(node(edge, 0), node(edge, 1)); }
  int highNode(std::int64_t edge) const { return std::max(node(edge, 0), node(edge, 1)); }

  EdgeRecord record(std::int64_t edge, int rank) const {
    const auto face = static_cast<int>(edge / 4);
    const Vec3 a = rowOf(x, node(edge, 0)), b = rowOf(x, node(edge, 1));
    const auto ids = std::minmax({node_ids(node(edge, 0)), node_ids(node(edge, 1))});
    return {ids.first,
            ids.second,
            face_ids(face),
            normals[face],
            centres[face],
            0.5 * (a + b),
            areas[face] / norm(b - a),
            rank,
            face,
            static_cast<int>(edge % 4),
            0};
  }
};

// Whether each node is also on another rank.
std::vector<char> sharedNodes(MPI_Comm comm, const HostSurface& surface) {
  const std::size_t num_nodes = surface.node_ids.extent(0);
  std::vector<char> is_shared(num_nodes, 0);
  if (sizeOf(comm) == 1)
    return is_shared;
  const std::vector<global_id> ids(surface.node_ids.data(), surface.node_ids.data() + num_nodes);
  const auto uses = countOnAllRanks(comm, ids, [](global_id id) { return id; });
  for (std::size_t node = 0; node < num_nodes; ++node)
    is_shared[node] = uses[node] > 1;
  return is_shared;
}

// Whether the edge of two faces is a feature edge or bent, and its reply if so.
bool judgePair(const EdgeRecord& a, const EdgeRecord& b, double largest_cosine, EdgeReply& reply) {
  reply.cosine = dot(a.normal, b.normal);
  const double height_of_b = dot(b.centre - a.on_edge, a.normal);
  const double height_of_a = dot(a.centre - a.on_edge, b.normal);
  reply.is_concave = height_of_a > 0 && height_of_b > 0 && reply.cosine <= concave_cosine;
  reply.is_feature = reply.cosine <= largest_cosine;
  if (!reply.is_feature)
    return reply.cosine < flat_cosine;
  reply.sine = norm(cross(a.normal, b.normal));
  reply.width[0] = a.width, reply.width[1] = b.width;
  reply.is_convex = height_of_b < 0 && height_of_a < 0 && reply.sine > 0;
  return true;
}

// Appends the replies to the faces [first, last) of one edge.
void judgeEdge(const EdgeRecord* first, const EdgeRecord* last, double largest_cosine,
               std::vector<std::vector<EdgeReply>>& replies) {
  EdgeReply reply = no_reply;
  if (last - first == 2 && !judgePair(first[0], first[1], largest_cosine, reply))
    return;
  for (const EdgeRecord* record = first; record != last; ++record) {
    reply.face = record->face;
    reply.edge = record->edge;
    replies[record->rank].push_back(reply);
    reply.is_convex = 0; // only the first lists it
  }
}

// Replies to this rank's faces whose edges have a node on this rank alone.
std::vector<EdgeReply> judgeOwnEdges(const HostSurface& surface, const std::vector<char>& is_shared,
                                     int rank, double largest_cosine) {
  const auto num_faces = static_cast<int>(surface.face_ids.extent(0));
  const auto num_edges = checkedInt(4 * std::int64_t(num_faces), "findFeatureEdges: edges");
  const Groups groups = groupByKey("contact::findFeatureEdges::groups", num_edges,
                                   static_cast<int>(surface.node_ids.extent(0)),
                                   [&](std::int64_t edge) { return surface.lowNode(edge); });
  const auto judge = [&](std::int64_t edge, EdgeReply& reply) {
    const int low = surface.lowNode(edge), high = surface.highNode(edge);
    if (low == high || (is_shared[low] && is_shared[high])) // a triangle, or judged by messages
      return false;
    int others = 0, other = 0;
    for (int i = groups.begin[low]; i < groups.begin[low + 1]; ++i)
      if (groups.items[i] != edge && surface.highNode(groups.items[i]) == high) {
        other = groups.items[i];
        ++others;
      }
    reply.face = static_cast<int>(edge / 4);
    reply.edge = static_cast<int>(edge % 4);
    if (others != 1)
      return true;
    if (!(dot(surface.normals[edge / 4], surface.normals[other / 4]) < flat_cosine))
      return false; // as most, without records
    const bool is_first = surface.face_ids(edge / 4) < surface.face_ids(other / 4);
    const EdgeRecord mine = surface.record(edge, rank), its = surface.record(other, rank);
    const bool has_reply = is_first ? judgePair(mine, its, largest_cosine, reply)
                                    : judgePair(its, mine, largest_cosine, reply);
    reply.is_convex = reply.is_convex && is_first;
    return has_reply;
  };
  std::vector<char> has_reply(num_edges);
  parallelOnHost("contact::findFeatureEdges::judge", num_edges, [&](std::int64_t edge) {
    EdgeReply reply = no_reply;
    has_reply[edge] = judge(edge, reply);
  });
  std::vector<EdgeReply> replies;
  for (int edge = 0; edge < num_edges; ++edge)
    if (has_reply[edge]) {
      replies.push_back(no_reply);
      judge(edge, replies.back());
    }
  return replies;
}

} // namespace

FeatureEdges findFeatureEdges(MPI_Comm comm, const Surface& surface, double cosine) {
  checkSurface(exec_space(), comm, "findFeatureEdges", surface);
  const int num_ranks = sizeOf(comm), rank = rankOf(comm);
  const HostSurface host(surface);
  const std::vector<char> is_shared = sharedNodes(comm, host);
  std::vector<std::vector<EdgeRecord>> to_judges(num_ranks);
  for (std::int64_t edge = 0; num_ranks > 1 && edge < 4 * std::int64_t(surface.num_faces); ++edge) {
    const int a = host.node(edge, 0), b = host.node(edge, 1);
    if (a != b && is_shared[a] && is_shared[b])
      to_judges[(host.node_ids(a) + host.node_ids(b)) % num_ranks].push_back(
          host.record(edge, rank));
  }
  std::vector<EdgeRecord> records = joined(exchangeByRank(comm, to_judges));
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
  auto answers = exchangeByRank(comm, replies);
  answers.push_back(judgeOwnEdges(host, is_shared, rank, cosine));
  FeatureEdges edges;
  edges.face_edges.assign(surface.num_faces, 0);
  std::vector<unsigned char> concave_edges(surface.num_faces, 0);
  for (const auto& some : answers)
    for (const EdgeReply& reply : some) {
      edges.face_edges[reply.face] |= static_cast<unsigned char>(
          (reply.is_feature | (!reply.is_feature || reply.is_concave) << 4) << reply.edge);
      concave_edges[reply.face] |= static_cast<unsigned char>(reply.is_concave << reply.edge);
      if (reply.is_convex)
        edges.convex.push_back(
            {reply.face, reply.edge, reply.cosine, reply.sine, {reply.width[0], reply.width[1]}});
    }
  std::sort(edges.convex.begin(), edges.convex.end());
  findLines(comm, surface, edges.convex);
  edges.face_sides = findSides(comm, surface, concave_edges, edges.face_edges);
  return edges;
}

} // namespace brickwall::contact
