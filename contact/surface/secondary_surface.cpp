#include "contact/surface/secondary_surface.hpp"

#include "contact/base/region.hpp"
#include "contact/base/to_device.hpp"
#include "contact/surface/merge_runs.hpp"

#include <algorithm>
#include <unordered_map>

namespace brickwall::contact {
namespace {

struct NodeRecord {
  global_id id, body;
  std::int64_t may_be_shared; // 0: no other rank is to have it
};
struct FaceMessage {
  global_id id, body;
  int corners[4]; // places among the nodes that go to the same rank
};

// What this rank sends, [rank] to each rank.
struct Outgoing {
  std::vector<std::vector<NodeRecord>> nodes;
  std::vector<std::vector<int>> node_rows; // the same nodes as rows of the primary surface
  std::vector<std::vector<FaceMessage>> faces;
  std::vector<std::vector<int>> face_rows; // likewise
  std::vector<std::vector<AttributeWord>> attributes; // words of the faces, one after another
};

// A copy of a node for a further rank.
struct NodeCopy {
  int node, rank, place;
  bool operator<(const NodeCopy& b) const { return node != b.node ? node < b.node : rank < b.rank; }
  bool operator==(const NodeCopy& b) const { return node == b.node && rank == b.rank; }
};

// Where the nodes of the primary surface go. Most go to one rank, `first`; copies for other ranks
// are listed by nodes and ranks.
struct NodePlaces {
  std::vector<int> first; // [node] rank
  std::vector<int> place; // [node] among the nodes that go to that rank
  std::vector<NodeCopy> copies;

  int of(int node, int rank) const {
    return first[node] == rank
               ? place[node]
               : std::lower_bound(copies.begin(), copies.end(), NodeCopy{node, rank, 0})->place;
  }
};

// All but the places. Nodes without a face on this rank stay on it, so that they have their values
// back as well.
template <class Corners>
NodePlaces ranksOfNodes(const SweptBoxes& primary, const Corners& corners,
                        const std::vector<int>& rank_of_face, int rank) {
  NodePlaces places;
  places.first.assign(primary.num_nodes, -1);
  places.place.resize(primary.num_nodes);
  for (int face = 0; face < primary.num_faces; ++face)
    for (int j = 0; j < 4; ++j) {
      int& first = places.first[corners(face, j)];
      if (first < 0)
        first = rank_of_face[face];
      else if (first != rank_of_face[face])
        places.copies.push_back({corners(face, j), rank_of_face[face], 0});
    }
  std::replace(places.first.begin(), places.first.end(), -1, rank);
  std::sort(places.copies.begin(), places.copies.end());
  places.copies.erase(std::unique(places.copies.begin(), places.copies.end()), places.copies.end());
  return places;
}

// Appends the nodes and sets their places.
void addNodes(const SweptBoxes& primary, const std::vector<char>& is_shared, NodePlaces& places,
              Outgoing& out) {
  const auto ids = toHost(primary.node_ids), body = toHost(primary.node_body);
  auto copy = places.copies.begin();
  for (int node = 0; node < primary.num_nodes; ++node) {
    const bool goes_to_several = copy != places.copies.end() && copy->node == node;
    const NodeRecord record{ids(node), body(node),
                            goes_to_several || is_shared.empty() || is_shared[node]};
    const auto add = [&](int q) {
      out.nodes[q].push_back(record);
      out.node_rows[q].push_back(node);
      return static_cast<int>(out.node_rows[q].size()) - 1;
    };
    places.place[node] = add(places.first[node]);
    for (; copy != places.copies.end() && copy->node == node; ++copy)
      copy->place = add(copy->rank);
  }
}

// Appends the faces of out.face_rows.
template <class Corners>
void addFaces(const SweptBoxes& primary, const Corners& corners, const NodePlaces& places,
              Outgoing& out) {
  const auto ids = toHost(primary.face_ids), body = toHost(primary.face_body);
  const auto attributes = toHost(primary.face_attributes);
  const std::size_t num_words = attributes.extent(1);
  for (std::size_t q = 0; q < out.faces.size(); ++q) {
    out.faces[q].reserve(out.face_rows[q].size());
    out.attributes[q].reserve(num_words * out.face_rows[q].size());
    for (const int face : out.face_rows[q]) {
      FaceMessage record{ids(face), body(face), {}};
      for (int j = 0; j < 4; ++j)
        record.corners[j] = places.of(corners(face, j), static_cast<int>(q));
      out.faces[q].push_back(record);
      for (std::size_t w = 0; w < num_words; ++w)
        out.attributes[q].push_back(attributes(face, w));
    }
  }
}

Outgoing listOutgoing(const SweptBoxes& primary, const std::vector<int>& rank_of_face,
                      const std::vector<char>& is_shared, int rank, int num_ranks) {
  const auto corners = toHost(primary.face_to_nodes);
  Outgoing out;
  out.nodes.resize(num_ranks);
  out.node_rows.resize(num_ranks);
  out.faces.resize(num_ranks);
  out.face_rows.resize(num_ranks);
  out.attributes.resize(num_ranks);
  for (int face = 0; face < primary.num_faces; ++face)
    out.face_rows[rank_of_face[face]].push_back(face);
  NodePlaces places = ranksOfNodes(primary, corners, rank_of_face, rank);
  addNodes(primary, is_shared, places, out);
  addFaces(primary, corners, places, out);
  return out;
}

// Entry `index` of what rank `rank` has sent.
template <class Key>
struct Received {
  Key key;
  int rank, index;
};
// All entries by keys and ranks. Each rank has sent its own in order, or nearly.
template <class Key, class Record, class KeyOf>
std::vector<Received<Key>> mergeReceived(const std::vector<std::vector<Record>>& records,
                                         const KeyOf& keyOf) {
  std::vector<Received<Key>> merged;
  std::vector<std::size_t> ends;
  for (std::size_t q = 0; q < records.size(); ++q) {
    for (std::size_t i = 0; i < records[q].size(); ++i)
      merged.push_back({keyOf(records[q][i]), static_cast<int>(q), static_cast<int>(i)});
    ends.push_back(merged.size());
  }
  checkedInt(static_cast<std::int64_t>(merged.size()), "nodes or faces of a distribution");
  sortRuns(merged, std::move(ends),
           [](const Received<Key>& a, const Received<Key>& b) { return a.key < b.key; });
  return merged;
}

// The ranks that have each of the nodes with these ids, ascending, of nodes that several have;
// `is_owned` [id] tells whether this rank owns it. The rank chosen by an id knows which ranks have
// the node, and spreads ownership over them by the id.
std::vector<std::vector<int>> findSharers(const Communicator& comm,
                                          const std::vector<global_id>& ids,
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

// Nodes of this rank, by ids.
struct MergedNodes {
  std::vector<global_id> ids, bodies;
  std::vector<std::vector<int>> node_of; // [rank][record that it has sent]
  // [rank] The nodes of which the rank is the source of values, and their places among those that
  // it has sent. Of the ranks that send a node, that is this rank or else the first.
  std::vector<std::vector<int>> nodes_from, places;
  // Those that other ranks may have.
  std::vector<global_id> shared_ids;
  std::vector<int> shared_nodes;
};
MergedNodes mergeNodes(const std::vector<std::vector<NodeRecord>>& records, int rank) {
  const auto entries =
      mergeReceived<global_id>(records, [](const NodeRecord& node) { return node.id; });
  MergedNodes nodes;
  nodes.ids.reserve(entries.size());
  nodes.bodies.reserve(entries.size());
  nodes.nodes_from.resize(records.size());
  nodes.places.resize(records.size());
  for (const auto& some : records)
    nodes.node_of.emplace_back(some.size());
  for (std::size_t i = 0; i < entries.size();) {
    const NodeRecord& record = records[entries[i].rank][entries[i].index];
    const int node = static_cast<int>(nodes.ids.size());
    nodes.ids.push_back(record.id);
    nodes.bodies.push_back(record.body);
    if (record.may_be_shared) {
      nodes.shared_ids.push_back(record.id);
      nodes.shared_nodes.push_back(node);
    }
    auto source = entries[i];
    for (; i < entries.size() && entries[i].key == record.id; ++i) {
      nodes.node_of[entries[i].rank][entries[i].index] = node;
      if (entries[i].rank == rank)
        source = entries[i];
    }
    nodes.nodes_from[source.rank].push_back(node);
    nodes.places[source.rank].push_back(source.index);
  }
  return nodes;
}

// Rows of the primary surface and, of each, the place among the nodes sent to the rank from which it
// has its values back, [rank]: this rank if it has a copy, or else the first one.
struct ReturnedRows {
  std::vector<std::vector<int>> rows, places;
};
ReturnedRows listReturned(const std::vector<std::vector<int>>& node_rows, int num_nodes, int rank) {
  ReturnedRows returned;
  returned.rows.resize(node_rows.size());
  returned.places.resize(node_rows.size());
  std::vector<char> has_source(num_nodes, 0);
  const auto ask = [&](std::size_t q) {
    for (std::size_t i = 0; i < node_rows[q].size(); ++i) {
      const int row = node_rows[q][i];
      if (has_source[row])
        continue;
      has_source[row] = 1;
      returned.rows[q].push_back(row);
      returned.places[q].push_back(static_cast<int>(i));
    }
  };
  ask(static_cast<std::size_t>(rank));
  for (std::size_t q = 0; q < node_rows.size(); ++q)
    ask(q);
  return returned;
}

// What other ranks ask of this one by `places` [rank][place among records], as the rows of these
// records. Collective.
std::vector<std::vector<int>> rowsAskedFor(const Communicator& comm,
                                           std::vector<std::vector<int>> places,
                                           const std::vector<std::vector<int>>& row_of_record) {
  auto asked = exchangeByRank(comm, std::move(places));
  for (std::size_t q = 0; q < asked.size(); ++q)
    for (int& row : asked[q])
      row = row_of_record[q][row];
  return asked;
}

// The nodes that each other rank has as well, [rank], in the order of their ids on both sides;
// `is_owned` [node] becomes whether this rank owns the node. Collective.
std::vector<std::vector<int>> findSharedRows(const Communicator& comm, const MergedNodes& nodes,
                                             std::vector<unsigned char>& is_owned) {
  std::vector<unsigned char> is_owned_of_shared;
  const auto sharers = findSharers(comm, nodes.shared_ids, is_owned_of_shared);
  std::vector<std::vector<int>> rows(sizeOf(comm));
  is_owned.assign(nodes.ids.size(), 1);
  for (std::size_t i = 0; i < sharers.size(); ++i) {
    is_owned[nodes.shared_nodes[i]] = is_owned_of_shared[i];
    for (const int q : sharers[i])
      if (q != rankOf(comm))
        rows[q].push_back(nodes.shared_nodes[i]);
  }
  return rows;
}

// Faces of this rank by sides and ids, as candidates.
struct MergedFaces {
  std::vector<global_id> ids, bodies;
  std::vector<int> corners; // [face][corner]
  std::vector<AttributeWord> attributes; // [face][word]
  std::vector<std::vector<int>> face_of; // [rank][record that it has sent]
};
MergedFaces mergeFaces(const std::vector<std::vector<FaceMessage>>& records,
                       const std::vector<std::vector<AttributeWord>>& attributes,
                       std::size_t num_words, const std::vector<std::vector<int>>& node_of) {
  using BodyAndId = std::pair<global_id, global_id>;
  const auto entries = mergeReceived<BodyAndId>(
      records, [](const FaceMessage& face) { return BodyAndId(face.body, face.id); });
  MergedFaces faces;
  faces.ids.reserve(entries.size());
  faces.bodies.reserve(entries.size());
  faces.corners.reserve(4 * entries.size());
  faces.attributes.reserve(num_words * entries.size());
  for (const auto& some : records)
    faces.face_of.emplace_back(some.size());
  for (const auto& entry : entries) {
    const FaceMessage& record = records[entry.rank][entry.index];
    faces.face_of[entry.rank][entry.index] = static_cast<int>(faces.ids.size());
    faces.ids.push_back(record.id);
    faces.bodies.push_back(record.body);
    for (const int place : record.corners)
      faces.corners.push_back(node_of[entry.rank][place]);
    const auto first = attributes[entry.rank].begin() + entry.index * num_words;
    faces.attributes.insert(faces.attributes.end(), first, first + num_words);
  }
  return faces;
}

AttributeWords attributesOf(const exec_space& space, const MergedFaces& faces,
                            std::size_t num_words) {
  auto words = allocate<AttributeWords>(space, "contact::SecondarySurface::attributes",
                                        faces.ids.size(), num_words);
  const auto host = Kokkos::create_mirror_view(words);
  std::copy(faces.attributes.begin(), faces.attributes.end(), host.data());
  Kokkos::deep_copy(space, words, host);
  space.fence();
  return words;
}

} // namespace

SecondarySurface::SecondarySurface(const exec_space& space, MPI_Comm of_host,
                                   const SweptBoxes& primary, const std::vector<int>& rank_of_face,
                                   const std::vector<char>& is_shared) {
  const Region region("contact::SecondarySurface");
  const Communicator comm(of_host);
  const int rank = rankOf(comm);
  Outgoing out = listOutgoing(primary, rank_of_face, is_shared, rank, sizeOf(comm));
  MergedNodes nodes = mergeNodes(exchangeByRank(comm, std::move(out.nodes)), rank);
  _to_secondary = SurfaceTransfer(
      space, comm, rowsAskedFor(comm, std::move(nodes.places), out.node_rows), nodes.nodes_from);
  ReturnedRows returned = listReturned(out.node_rows, primary.num_nodes, rank);
  _to_primary = SurfaceTransfer(
      space, comm, rowsAskedFor(comm, std::move(returned.places), nodes.node_of), returned.rows);
  std::vector<unsigned char> is_owned;
  const auto shared_rows = findSharedRows(comm, nodes, is_owned);
  _shared = SurfaceTransfer(space, comm, shared_rows, shared_rows);
  // Ranks without faces may have no attributes.
  const auto num_words = static_cast<std::size_t>(
      allReduce(comm, static_cast<std::int64_t>(primary.face_attributes.extent(1)), MPI_MAX));
  const auto face_records = exchangeByRank(comm, std::move(out.faces));
  const auto attributes = exchangeByRank(comm, std::move(out.attributes));
  MergedFaces faces = mergeFaces(face_records, attributes, num_words, nodes.node_of);
  _face_of = std::move(faces.face_of);
  _sent_faces = std::move(out.face_rows);

  _surface.num_nodes = checkedInt(static_cast<std::int64_t>(nodes.ids.size()), "surface nodes");
  _surface.num_faces = checkedInt(static_cast<std::int64_t>(faces.ids.size()), "faces");
  _surface.node_ids = toDevice(space, "contact::SecondarySurface::node_ids", nodes.ids);
  _surface.node_body = toDevice(space, "contact::SecondarySurface::node_body", nodes.bodies);
  _surface.node_is_owned = toDevice(space, "contact::SecondarySurface::node_is_owned", is_owned);
  _surface.face_ids = toDevice(space, "contact::SecondarySurface::face_ids", faces.ids);
  _surface.face_body = toDevice(space, "contact::SecondarySurface::face_body", faces.bodies);
  _surface.face_to_nodes =
      toDevice<View<int* [4]>>(space, "contact::SecondarySurface::face_to_nodes", faces.corners);
  _surface.face_attributes = attributesOf(space, faces, num_words);
}

} // namespace brickwall::contact
