#include "contact/surface/secondary_surface.hpp"

#include "contact/base/tags.hpp"
#include "contact/base/to_device.hpp"

#include <algorithm>
#include <unordered_map>

namespace brickwall::contact {
namespace {

struct NodeRecord {
  global_id id, body;
};
struct FaceRecord {
  global_id id, body, corners[4];
};

// What this rank sends to one rank.
struct Outgoing {
  std::vector<std::vector<NodeRecord>> nodes; // [rank]
  std::vector<std::vector<int>> node_rows; // [rank] the same nodes as rows of the primary surface
  std::vector<std::vector<FaceRecord>> faces; // [rank]
  std::vector<std::vector<AttributeWord>>
      attributes; // [rank] words of the faces, one after another
};

// Nodes without a face on this rank stay on it, so that they have their values back as well.
Outgoing listOutgoing(const SweptBoxes& primary, const std::vector<int>& rank_of_face, int rank,
                      int num_ranks) {
  const auto corners = toHost(primary.face_to_nodes);
  const auto node_ids = toHost(primary.node_ids), node_body = toHost(primary.node_body);
  const auto face_ids = toHost(primary.face_ids), face_body = toHost(primary.face_body);
  const auto attributes = toHost(primary.face_attributes);
  Outgoing out;
  out.nodes.resize(num_ranks);
  out.node_rows.resize(num_ranks);
  out.faces.resize(num_ranks);
  out.attributes.resize(num_ranks);
  std::vector<char> has_face(primary.num_nodes, 0);
  for (int face = 0; face < primary.num_faces; ++face) {
    const int to = rank_of_face[face];
    FaceRecord record{face_ids(face), face_body(face), {}};
    for (int j = 0; j < 4; ++j) {
      record.corners[j] = node_ids(corners(face, j));
      out.node_rows[to].push_back(corners(face, j));
      has_face[corners(face, j)] = 1;
    }
    out.faces[to].push_back(record);
    for (std::size_t w = 0; w < attributes.extent(1); ++w)
      out.attributes[to].push_back(attributes(face, w));
  }
  for (int node = 0; node < primary.num_nodes; ++node)
    if (!has_face[node])
      out.node_rows[rank].push_back(node);
  for (int q = 0; q < num_ranks; ++q) {
    std::vector<int>& rows = out.node_rows[q];
    std::sort(rows.begin(), rows.end());
    rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
    for (const int row : rows)
      out.nodes[q].push_back({node_ids(row), node_body(row)});
  }
  return out;
}

// The ranks that have each of this rank's nodes, ascending, of nodes that several have; `is_owned`
// [node] tells whether this rank owns it. The rank chosen by an id knows which ranks have the node,
// and spreads ownership over them by the id.
std::vector<std::vector<int>> findSharers(MPI_Comm comm, const std::vector<global_id>& ids,
                                          std::vector<unsigned char>& is_owned) {
  const int num_ranks = sizeOf(comm);
  std::vector<std::vector<global_id>> questions(num_ranks);
  for (const global_id id : ids)
    questions[id % num_ranks].push_back(id);
  const auto received = exchangeByRank(comm, questions);
  std::unordered_map<global_id, std::vector<int>> sharers;
  for (int q = 0; q < num_ranks; ++q)
    for (const global_id id : received[q])
      sharers[id].push_back(q);
  // In the order of the questions: the owner, the number of sharers if it is not 1, and these.
  std::vector<std::vector<int>> replies(num_ranks);
  for (int q = 0; q < num_ranks; ++q)
    for (const global_id id : received[q]) {
      const std::vector<int>& ranks = sharers[id];
      replies[q].push_back(ranks[static_cast<std::size_t>(id / num_ranks) % ranks.size()]);
      replies[q].push_back(ranks.size() > 1 ? static_cast<int>(ranks.size()) : 0);
      if (ranks.size() > 1)
        replies[q].insert(replies[q].end(), ranks.begin(), ranks.end());
    }
  const auto answers = exchangeByRank(comm, replies);
  std::vector<std::size_t> next(num_ranks, 0);
  std::vector<std::vector<int>> sharers_of_node;
  for (const global_id id : ids) {
    const int* answer = &answers[id % num_ranks][next[id % num_ranks]];
    is_owned.push_back(answer[0] == rankOf(comm));
    sharers_of_node.emplace_back(answer + 2, answer + 2 + answer[1]);
    next[id % num_ranks] += 2 + static_cast<std::size_t>(answer[1]);
  }
  return sharers_of_node;
}

// The rows that each rank sends and receives, [rank], as a plan between those that have any.
ExchangePlan planOf(const exec_space& space, MPI_Comm comm, int tag,
                    const std::vector<std::vector<int>>& send_rows,
                    const std::vector<std::vector<int>>& receive_rows) {
  std::vector<int> partners;
  std::vector<std::vector<int>> sent, received;
  for (int q = 0; q < sizeOf(comm); ++q)
    if (!send_rows[q].empty() || !receive_rows[q].empty()) {
      partners.push_back(q);
      sent.push_back(send_rows[q]);
      received.push_back(receive_rows[q]);
    }
  return ExchangePlan(space, Communicator(comm), tag, partners, sent, received);
}

} // namespace

SecondarySurface::SecondarySurface(const exec_space& space, MPI_Comm comm,
                                   const SweptBoxes& primary,
                                   const std::vector<int>& rank_of_face) {
  const int num_ranks = sizeOf(comm), rank = rankOf(comm);
  const Outgoing out = listOutgoing(primary, rank_of_face, rank, num_ranks);

  // Nodes: the first rank that sends one is the source of its values.
  const auto node_records = exchangeByRank(comm, out.nodes);
  std::unordered_map<global_id, int> node_of_id;
  std::vector<global_id> node_ids, node_body;
  std::vector<std::vector<int>> received_rows(num_ranks), wanted_rows(num_ranks), taken(num_ranks);
  for (int q = 0; q < num_ranks; ++q)
    for (std::size_t i = 0; i < node_records[q].size(); ++i) {
      const NodeRecord& record = node_records[q][i];
      const auto found = node_of_id.emplace(record.id, static_cast<int>(node_ids.size()));
      received_rows[q].push_back(found.first->second);
      if (!found.second)
        continue;
      node_ids.push_back(record.id);
      node_body.push_back(record.body);
      wanted_rows[q].push_back(found.first->second);
      taken[q].push_back(static_cast<int>(i));
    }
  // `taken` and `asked` number the nodes that a rank has sent.
  auto rows_sent = exchangeByRank(comm, taken);
  for (int q = 0; q < num_ranks; ++q)
    for (int& row : rows_sent[q])
      row = out.node_rows[q][row];
  _to_secondary = planOf(space, comm, tags::secondary_surface, rows_sent, wanted_rows);

  // Each primary copy has its values back from the first rank to which it sent the node.
  std::vector<char> has_source(primary.num_nodes, 0);
  std::vector<std::vector<int>> returned_rows(num_ranks), asked(num_ranks);
  for (int q = 0; q < num_ranks; ++q)
    for (std::size_t i = 0; i < out.node_rows[q].size(); ++i) {
      const int row = out.node_rows[q][i];
      if (has_source[row])
        continue;
      has_source[row] = 1;
      returned_rows[q].push_back(row);
      asked[q].push_back(static_cast<int>(i));
    }
  auto rows_given = exchangeByRank(comm, asked);
  for (int q = 0; q < num_ranks; ++q)
    for (int& row : rows_given[q])
      row = received_rows[q][row];
  _to_primary = planOf(space, comm, tags::secondary_surface, rows_given, returned_rows);

  // Shared nodes, in the order of their ids on both sides.
  std::vector<unsigned char> is_owned;
  const auto sharers = findSharers(comm, node_ids, is_owned);
  std::vector<std::vector<int>> rows_shared(num_ranks);
  for (std::size_t node = 0; node < sharers.size(); ++node)
    for (const int q : sharers[node])
      if (q != rank)
        rows_shared[q].push_back(static_cast<int>(node));
  for (auto& rows : rows_shared)
    std::sort(rows.begin(), rows.end(), [&](int a, int b) { return node_ids[a] < node_ids[b]; });
  _shared = planOf(space, comm, tags::secondary_surface, rows_shared, rows_shared);

  // Faces, by sender and in its order.
  const auto face_records = exchangeByRank(comm, out.faces);
  const auto attributes = exchangeByRank(comm, out.attributes);
  std::vector<global_id> face_ids, face_body;
  std::vector<int> face_to_nodes;
  std::vector<AttributeWord> words;
  for (int q = 0; q < num_ranks; ++q) {
    for (const FaceRecord& record : face_records[q]) {
      face_ids.push_back(record.id);
      face_body.push_back(record.body);
      for (const global_id id : record.corners)
        face_to_nodes.push_back(node_of_id.at(id));
    }
    words.insert(words.end(), attributes[q].begin(), attributes[q].end());
  }

  _surface.num_nodes = checkedInt(static_cast<std::int64_t>(node_ids.size()), "surface nodes");
  _surface.num_faces = checkedInt(static_cast<std::int64_t>(face_ids.size()), "faces");
  _surface.node_ids = toDevice(space, "contact::SecondarySurface::node_ids", node_ids);
  _surface.node_body = toDevice(space, "contact::SecondarySurface::node_body", node_body);
  _surface.node_is_owned = toDevice(space, "contact::SecondarySurface::node_is_owned", is_owned);
  _surface.face_ids = toDevice(space, "contact::SecondarySurface::face_ids", face_ids);
  _surface.face_body = toDevice(space, "contact::SecondarySurface::face_body", face_body);
  _surface.face_to_nodes =
      toDevice<View<int* [4]>>(space, "contact::SecondarySurface::face_to_nodes", face_to_nodes);
  const std::size_t num_words = primary.face_attributes.extent(1);
  _attributes = allocate<AttributeWords>(space, "contact::SecondarySurface::attributes",
                                         face_ids.size(), num_words);
  const auto host = Kokkos::create_mirror_view(_attributes);
  for (std::size_t i = 0; i < words.size(); ++i)
    host(i / num_words, i % num_words) = words[i];
  Kokkos::deep_copy(space, _attributes, host);
  space.fence();
  _surface.face_attributes = _attributes;
}

} // namespace brickwall::contact
