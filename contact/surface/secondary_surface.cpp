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

Outgoing listOutgoing(const SweptBoxes& primary, const std::vector<int>& rank_of_face,
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
  for (int face = 0; face < primary.num_faces; ++face) {
    const int to = rank_of_face[face];
    FaceRecord record{face_ids(face), face_body(face), {}};
    for (int j = 0; j < 4; ++j) {
      record.corners[j] = node_ids(corners(face, j));
      out.node_rows[to].push_back(corners(face, j));
    }
    out.faces[to].push_back(record);
    for (std::size_t w = 0; w < attributes.extent(1); ++w)
      out.attributes[to].push_back(attributes(face, w));
  }
  for (int q = 0; q < num_ranks; ++q) {
    std::vector<int>& rows = out.node_rows[q];
    std::sort(rows.begin(), rows.end());
    rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
    for (const int row : rows)
      out.nodes[q].push_back({node_ids(row), node_body(row)});
  }
  return out;
}

// Whether this rank owns each of its nodes. The rank chosen by an id knows which ranks have the
// node, and spreads ownership over them by the id.
std::vector<unsigned char> chooseOwners(MPI_Comm comm, const std::vector<global_id>& ids) {
  const int num_ranks = sizeOf(comm);
  std::vector<std::vector<global_id>> questions(num_ranks);
  for (const global_id id : ids)
    questions[id % num_ranks].push_back(id);
  const auto received = exchangeByRank(comm, questions);
  std::unordered_map<global_id, std::vector<int>> sharers;
  for (int q = 0; q < num_ranks; ++q)
    for (const global_id id : received[q])
      sharers[id].push_back(q);
  std::vector<std::vector<unsigned char>> replies(num_ranks);
  for (int q = 0; q < num_ranks; ++q)
    for (const global_id id : received[q]) {
      const std::vector<int>& ranks = sharers[id];
      replies[q].push_back(ranks[static_cast<std::size_t>(id / num_ranks) % ranks.size()] == q);
    }
  const auto answers = exchangeByRank(comm, replies); // in the order of the questions
  std::vector<std::size_t> next(num_ranks, 0);
  std::vector<unsigned char> is_owned;
  for (const global_id id : ids)
    is_owned.push_back(answers[id % num_ranks][next[id % num_ranks]++]);
  return is_owned;
}

std::vector<std::vector<int>> ofPartners(std::vector<std::vector<int>>& rows,
                                         const std::vector<int>& partners) {
  std::vector<std::vector<int>> chosen;
  for (const int q : partners)
    chosen.push_back(std::move(rows[q]));
  return chosen;
}

} // namespace

SecondarySurface::SecondarySurface(const exec_space& space, MPI_Comm comm,
                                   const SweptBoxes& primary,
                                   const std::vector<int>& rank_of_face) {
  const int num_ranks = sizeOf(comm);
  const Outgoing out = listOutgoing(primary, rank_of_face, num_ranks);

  // Nodes: the first rank that sends one is the source of its values.
  const auto node_records = exchangeByRank(comm, out.nodes);
  std::unordered_map<global_id, int> node_of_id;
  std::vector<global_id> node_ids, node_body;
  std::vector<std::vector<int>> receive_rows(num_ranks), taken(num_ranks);
  for (int q = 0; q < num_ranks; ++q)
    for (std::size_t i = 0; i < node_records[q].size(); ++i) {
      const NodeRecord& record = node_records[q][i];
      const auto row = static_cast<int>(node_ids.size());
      if (!node_of_id.emplace(record.id, row).second)
        continue;
      node_ids.push_back(record.id);
      node_body.push_back(record.body);
      receive_rows[q].push_back(row);
      taken[q].push_back(static_cast<int>(i));
    }
  std::vector<std::vector<int>> send_rows = exchangeByRank(comm, taken);
  std::vector<int> partners;
  for (int q = 0; q < num_ranks; ++q) {
    for (int& row : send_rows[q])
      row = out.node_rows[q][row];
    if (!send_rows[q].empty() || !receive_rows[q].empty())
      partners.push_back(q);
  }
  _plan = ExchangePlan(space, Communicator(comm), tags::secondary_surface, partners,
                       ofPartners(send_rows, partners), ofPartners(receive_rows, partners));

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
  _surface.node_is_owned =
      toDevice(space, "contact::SecondarySurface::node_is_owned", chooseOwners(comm, node_ids));
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
