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
struct FaceRecord {
  global_id id, body;
  int corners[4]; // places among the nodes that go to the same rank
};

// What this rank sends, [rank] to each rank.
struct Outgoing {
  std::vector<std::vector<NodeRecord>> nodes;
  std::vector<std::vector<int>> node_rows; // the same nodes as rows of the primary surface
  std::vector<std::vector<FaceRecord>> faces;
  std::vector<std::vector<int>> face_rows; // likewise
  std::vector<std::vector<AttributeWord>> attributes; // words of the faces, one after another
};

// Nodes without a face on this rank stay on it, so that they have their values back as well.
Outgoing listOutgoing(const SweptBoxes& primary, const std::vector<int>& rank_of_face,
                      const std::vector<char>& is_shared, int rank, int num_ranks) {
  const auto corners = toHost(primary.face_to_nodes);
  const auto node_ids = toHost(primary.node_ids), node_body = toHost(primary.node_body);
  const auto face_ids = toHost(primary.face_ids), face_body = toHost(primary.face_body);
  const auto attributes = toHost(primary.face_attributes);
  Outgoing out;
  out.nodes.resize(num_ranks);
  out.node_rows.resize(num_ranks);
  out.faces.resize(num_ranks);
  out.face_rows.resize(num_ranks);
  out.attributes.resize(num_ranks);
  for (int face = 0; face < primary.num_faces; ++face)
    out.face_rows[rank_of_face[face]].push_back(face);

  // Most nodes go to one rank, `first`; copies for other ranks are listed by nodes.
  struct Copy {
    int node, rank, place;
    bool operator<(const Copy& b) const { return node != b.node ? node < b.node : rank < b.rank; }
    bool operator==(const Copy& b) const { return node == b.node && rank == b.rank; }
  };
  std::vector<int> first(primary.num_nodes, -1), place(primary.num_nodes);
  std::vector<Copy> copies;
  for (int face = 0; face < primary.num_faces; ++face)
    for (int j = 0; j < 4; ++j) {
      int& rank_of_node = first[corners(face, j)];
      if (rank_of_node < 0)
        rank_of_node = rank_of_face[face];
      else if (rank_of_node != rank_of_face[face])
        copies.push_back({corners(face, j), rank_of_face[face], 0});
    }
  std::sort(copies.begin(), copies.end());
  copies.erase(std::unique(copies.begin(), copies.end()), copies.end());
  auto copy = copies.begin();
  for (int node = 0; node < primary.num_nodes; ++node) {
    const bool goes_to_several = copy != copies.end() && copy->node == node;
    const NodeRecord record{node_ids(node), node_body(node),
                            goes_to_several || is_shared.empty() || is_shared[node]};
    const auto add = [&](int q) {
      out.nodes[q].push_back(record);
      out.node_rows[q].push_back(node);
      return static_cast<int>(out.node_rows[q].size()) - 1;
    };
    place[node] = add(first[node] < 0 ? rank : first[node]);
    for (; copy != copies.end() && copy->node == node; ++copy)
      copy->place = add(copy->rank);
  }

  const std::size_t num_words = attributes.extent(1);
  for (int q = 0; q < num_ranks; ++q) {
    out.faces[q].reserve(out.face_rows[q].size());
    out.attributes[q].resize(num_words * out.face_rows[q].size());
    std::size_t next = 0;
    for (const int face : out.face_rows[q]) {
      FaceRecord record{face_ids(face), face_body(face), {}};
      for (int j = 0; j < 4; ++j) {
        const int node = corners(face, j);
        record.corners[j] =
            first[node] == q
                ? place[node]
                : std::lower_bound(copies.begin(), copies.end(), Copy{node, q, 0})->place;
      }
      out.faces[q].push_back(record);
      for (std::size_t w = 0; w < num_words; ++w)
        out.attributes[q][next++] = attributes(face, w);
    }
  }
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

} // namespace

SecondarySurface::SecondarySurface(const exec_space& space, MPI_Comm of_host,
                                   const SweptBoxes& primary, const std::vector<int>& rank_of_face,
                                   const std::vector<char>& is_shared) {
  const Region region("contact::SecondarySurface");
  const Communicator comm(of_host);
  const int num_ranks = sizeOf(comm), rank = rankOf(comm);
  Outgoing out = listOutgoing(primary, rank_of_face, is_shared, rank, num_ranks);

  // Nodes by ids. Of the ranks that send one, this rank or else the first is the source of its
  // values.
  const auto node_records = exchangeByRank(comm, std::move(out.nodes));
  const auto nodes =
      mergeReceived<global_id>(node_records, [](const NodeRecord& node) { return node.id; });
  std::vector<global_id> node_ids, node_body, shared_ids;
  std::vector<int> shared_nodes;
  std::vector<std::vector<int>> node_of(num_ranks), wanted_rows(num_ranks), taken(num_ranks);
  for (int q = 0; q < num_ranks; ++q)
    node_of[q].resize(node_records[q].size());
  node_ids.reserve(nodes.size());
  node_body.reserve(nodes.size());
  for (std::size_t i = 0; i < nodes.size();) {
    const NodeRecord& record = node_records[nodes[i].rank][nodes[i].index];
    const int node = static_cast<int>(node_ids.size());
    node_ids.push_back(record.id);
    node_body.push_back(record.body);
    if (record.may_be_shared) {
      shared_ids.push_back(record.id);
      shared_nodes.push_back(node);
    }
    auto source = nodes[i];
    for (; i < nodes.size() && nodes[i].key == node_ids.back(); ++i) {
      node_of[nodes[i].rank][nodes[i].index] = node;
      if (nodes[i].rank == rank)
        source = nodes[i];
    }
    wanted_rows[source.rank].push_back(node);
    taken[source.rank].push_back(source.index);
  }
  // `taken` and `asked` number the nodes that a rank has sent.
  auto rows_sent = exchangeByRank(comm, std::move(taken));
  for (int q = 0; q < num_ranks; ++q)
    for (int& row : rows_sent[q])
      row = out.node_rows[q][row];
  _to_secondary = SurfaceTransfer(space, comm, rows_sent, wanted_rows);

  // Each primary copy has its values back from this rank if it has a copy, or else from the first
  // rank to which it sent the node.
  std::vector<char> has_source(primary.num_nodes, 0);
  std::vector<std::vector<int>> returned_rows(num_ranks), asked(num_ranks);
  const auto ask = [&](int q) {
    for (std::size_t i = 0; i < out.node_rows[q].size(); ++i) {
      const int row = out.node_rows[q][i];
      if (has_source[row])
        continue;
      has_source[row] = 1;
      returned_rows[q].push_back(row);
      asked[q].push_back(static_cast<int>(i));
    }
  };
  ask(rank);
  for (int q = 0; q < num_ranks; ++q)
    ask(q);
  auto rows_given = exchangeByRank(comm, std::move(asked));
  for (int q = 0; q < num_ranks; ++q)
    for (int& row : rows_given[q])
      row = node_of[q][row];
  _to_primary = SurfaceTransfer(space, comm, rows_given, returned_rows);

  // Shared nodes, in the order of their ids on both sides.
  std::vector<unsigned char> is_owned_of_shared, is_owned(node_ids.size(), 1);
  const auto sharers = findSharers(comm, shared_ids, is_owned_of_shared);
  std::vector<std::vector<int>> rows_shared(num_ranks);
  for (std::size_t i = 0; i < sharers.size(); ++i) {
    is_owned[shared_nodes[i]] = is_owned_of_shared[i];
    for (const int q : sharers[i])
      if (q != rank)
        rows_shared[q].push_back(shared_nodes[i]);
  }
  _shared = SurfaceTransfer(space, comm, rows_shared, rows_shared);

  // Faces by bodies and ids, as candidates.
  const auto face_records = exchangeByRank(comm, std::move(out.faces));
  const auto attributes = exchangeByRank(comm, std::move(out.attributes));
  using BodyAndId = std::pair<global_id, global_id>;
  const auto faces = mergeReceived<BodyAndId>(
      face_records, [](const FaceRecord& face) { return BodyAndId(face.body, face.id); });
  const std::size_t num_words = primary.face_attributes.extent(1);
  std::vector<global_id> face_ids, face_body;
  std::vector<int> face_to_nodes;
  face_ids.reserve(faces.size());
  face_body.reserve(faces.size());
  face_to_nodes.reserve(4 * faces.size());
  const auto words = allocate<AttributeWords>(space, "contact::SecondarySurface::attributes",
                                              faces.size(), num_words);
  const auto host = Kokkos::create_mirror_view(words);
  _face_of.resize(num_ranks);
  for (int q = 0; q < num_ranks; ++q)
    _face_of[q].resize(face_records[q].size());
  for (const auto& from : faces) {
    const FaceRecord& record = face_records[from.rank][from.index];
    const std::size_t face = face_ids.size();
    _face_of[from.rank][from.index] = static_cast<int>(face);
    for (std::size_t w = 0; w < num_words; ++w)
      host(face, w) = attributes[from.rank][from.index * num_words + w];
    face_ids.push_back(record.id);
    face_body.push_back(record.body);
    for (const int place : record.corners)
      face_to_nodes.push_back(node_of[from.rank][place]);
  }
  Kokkos::deep_copy(space, words, host);
  space.fence();
  _sent_faces = std::move(out.face_rows);

  _surface.num_nodes = checkedInt(static_cast<std::int64_t>(node_ids.size()), "surface nodes");
  _surface.num_faces = checkedInt(static_cast<std::int64_t>(face_ids.size()), "faces");
  _surface.node_ids = toDevice(space, "contact::SecondarySurface::node_ids", node_ids);
  _surface.node_body = toDevice(space, "contact::SecondarySurface::node_body", node_body);
  _surface.node_is_owned = toDevice(space, "contact::SecondarySurface::node_is_owned", is_owned);
  _surface.face_ids = toDevice(space, "contact::SecondarySurface::face_ids", face_ids);
  _surface.face_body = toDevice(space, "contact::SecondarySurface::face_body", face_body);
  _surface.face_to_nodes =
      toDevice<View<int* [4]>>(space, "contact::SecondarySurface::face_to_nodes", face_to_nodes);
  _surface.face_attributes = words;
}

} // namespace brickwall::contact
