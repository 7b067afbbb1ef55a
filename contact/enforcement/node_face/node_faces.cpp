#include "contact/enforcement/node_face/node_faces.hpp"

#include "contact/base/group_by_key.hpp"
#include "contact/base/tags.hpp"
#include "contact/base/to_device.hpp"
#include "contact/surface/id_holders.hpp"
#include "contact/surface/row_of_id.hpp"

#include <algorithm>
#include <functional>
#include <numeric>
#include <utility>
#include <vector>

namespace brickwall::contact {
namespace {

template <class ViewType>
using HostCopy = decltype(toHost(std::declval<ViewType>()));

// Host copy of the surface, for set-up.
struct HostSurface {
  explicit HostSurface(const Surface& s)
      : num_nodes(s.num_nodes), num_faces(s.num_faces), face_to_nodes(toHost(s.face_to_nodes)),
        node_ids(toHost(s.node_ids)), face_ids(toHost(s.face_ids)), owned(toHost(s.node_is_owned)),
        attributes(toHost(s.face_attributes)) {}

  // Calls visit(corner node) for each distinct corner of a face.
  template <class Visit>
  void forCorners(int face, const Visit& visit) const {
    for (int j = 0; j < 4; ++j) {
      bool seen = false;
      for (int i = 0; i < j; ++i)
        seen = seen || face_to_nodes(face, i) == face_to_nodes(face, j);
      if (!seen)
        visit(face_to_nodes(face, j));
    }
  }
  double cornerShare(int face) const {
    int corners = 0;
    forCorners(face, [&](int) { ++corners; });
    return 1.0 / corners;
  }
  double surfaceMass(int face) const {
    return attributesAt<FaceAttributes>(attributes, face).surface_mass;
  }

  int num_nodes, num_faces;
  HostCopy<decltype(Surface::face_to_nodes)> face_to_nodes;
  HostCopy<decltype(Surface::node_ids)> node_ids, face_ids;
  HostCopy<decltype(Surface::node_is_owned)> owned;
  HostCopy<decltype(Surface::face_attributes)> attributes;
};

// Collective. [node] the rank of its owner.
std::vector<int> findOwners(const Communicator& comm, const HostSurface& surface) {
  std::vector<global_id> owned, others;
  for (int node = 0; node < surface.num_nodes; ++node)
    (surface.owned(node) ? owned : others).push_back(surface.node_ids(node));
  const IdHolders owner_of(comm, owned);
  const auto answer = [&](const std::vector<std::vector<global_id>>& asked) {
    std::vector<std::vector<int>> owners(asked.size());
    rethrowOnAllRanks(comm, [&] {
      for (std::size_t q = 0; q < asked.size(); ++q)
        for (const global_id id : asked[q]) {
          owners[q].push_back(owner_of(id));
          if (owners[q].back() == IdHolders::none)
            throw Error(ExitCode::internal,
                        "NodeFaces: surface node with id " + std::to_string(id) + " of rank " +
                            std::to_string(q) + " is on the surface of no rank that owns it; " +
                            "the owner's surface must list it, even without a face there");
        }
    });
    return owners;
  };
  const std::vector<int> of_others = answersByKey(
      comm, others, [](global_id id) { return id; }, answer);
  std::vector<int> owners(surface.num_nodes, rankOf(comm));
  auto next = of_others.begin();
  for (int node = 0; node < surface.num_nodes; ++node)
    if (!surface.owned(node))
      owners[node] = *next++;
  return owners;
}

// A face of another rank at one of this rank's nodes: one record per (node, face).
struct RemoteCorner {
  global_id node_id, face_id;
  double surface_mass, corner_share;
  int index; // of the face among those that its rank sends here
  int unused;
};

struct Adjacent {
  int node;
  global_id face_id;
  int row;
  bool operator<(const Adjacent& b) const { return face_id < b.face_id; }
};

// The faces around nodes, for set-up.
struct Adjacency {
  // Adds own faces around own nodes. Returns what the owners of the other nodes need, [rank].
  std::vector<std::vector<RemoteCorner>> addOwn(const HostSurface& host,
                                                const std::vector<int>& owners, int num_ranks) {
    std::vector<std::vector<RemoteCorner>> records(num_ranks);
    sent_faces.resize(num_ranks);
    around.reserve(4 * static_cast<std::size_t>(host.num_faces));
    for (int face = 0; face < host.num_faces; ++face) {
      surface_mass.push_back(host.surfaceMass(face));
      corner_share.push_back(host.cornerShare(face));
      host.forCorners(face, [&](int node) {
        if (host.owned(node)) {
          around.push_back({node, host.face_ids(face), face});
          return;
        }
        std::vector<int>& sent = sent_faces[owners[node]];
        if (sent.empty() || sent.back() != face)
          sent.push_back(face);
        const int index = static_cast<int>(sent.size()) - 1;
        records[owners[node]].push_back({host.node_ids(node), host.face_ids(face),
                                         surface_mass.back(), corner_share.back(), index, 0});
      });
    }
    return records;
  }
  // Adds the faces of another rank. Returns their rows, in the order of that rank's list.
  std::vector<int> addRemote(const std::vector<RemoteCorner>& corners, const RowOfId& node_of) {
    std::vector<int> rows;
    for (const RemoteCorner& corner : corners) {
      // Indices first appear in ascending order.
      if (corner.index == static_cast<int>(rows.size())) {
        rows.push_back(static_cast<int>(surface_mass.size()));
        surface_mass.push_back(corner.surface_mass);
        corner_share.push_back(corner.corner_share);
      }
      around.push_back({node_of.find(corner.node_id), corner.face_id, rows[corner.index]});
    }
    return rows;
  }
  NodeFaceLists lists(const exec_space& space, int num_nodes) const {
    const int num_adjacent = checkedInt(static_cast<std::int64_t>(around.size()), "NodeFaces");
    Groups groups = groupByKey("contact::NodeFaces::groups", num_adjacent, num_nodes,
                               [of = around.data()](std::int64_t i) { return of[i].node; });
    std::vector<int> rows(groups.items.size());
    parallelOnHost("contact::NodeFaces::rows", num_nodes, [&](std::int64_t node) {
      const auto begin = groups.items.begin() + groups.begin[node];
      const auto end = groups.items.begin() + groups.begin[node + 1];
      std::sort(begin, end, [&](int a, int b) { return around[a] < around[b]; });
      std::transform(begin, end, rows.begin() + groups.begin[node],
                     [&](int i) { return around[i].row; });
    });
    return {toDevice(space, "contact::NodeFaces::offsets", groups.begin),
            toDevice(space, "contact::NodeFaces::rows", rows),
            toDevice(space, "contact::NodeFaces::surface_mass", surface_mass),
            toDevice(space, "contact::NodeFaces::corner_share", corner_share)};
  }

  std::vector<Adjacent> around;
  std::vector<double> surface_mass, corner_share; // [row]
  std::vector<std::vector<int>> sent_faces; // [rank] own faces, ascending
};

} // namespace

// Remote rows are in the order of (rank, index), as both sides of the plan list them.
NodeFaces::NodeFaces(const exec_space& space, const Communicator& comm, const Surface& surface)
    : _num_faces(surface.num_faces) {
  const HostSurface host(surface);
  Adjacency all;
  const auto received =
      exchangeByRank(comm, all.addOwn(host, findOwners(comm, host), sizeOf(comm)));
  const RowOfId node_of(surface.node_ids);
  std::vector<int> partners, border_faces;
  std::vector<std::vector<int>> send_rows, receive_rows;
  for (int q = 0; q < sizeOf(comm); ++q) {
    if (all.sent_faces[q].empty() && received[q].empty())
      continue;
    partners.push_back(q);
    std::vector<int> sent(all.sent_faces[q].size());
    std::iota(sent.begin(), sent.end(), static_cast<int>(border_faces.size()));
    send_rows.push_back(sent);
    border_faces.insert(border_faces.end(), all.sent_faces[q].begin(), all.sent_faces[q].end());
    std::vector<int> rows = all.addRemote(received[q], node_of);
    for (int& row : rows)
      row -= _num_faces;
    receive_rows.push_back(rows);
  }
  _num_remote = static_cast<int>(all.surface_mass.size()) - _num_faces;
  _lists = all.lists(space, host.num_nodes);
  _border_faces = toDevice(space, "contact::NodeFaces::border_faces", border_faces);
  _border_areas =
      allocate<View<double* [3]>>(space, "contact::NodeFaces::border_areas", border_faces.size());
  _remote_areas =
      allocate<View<double* [3]>>(space, "contact::NodeFaces::remote_areas", _num_remote);
  _plan = ExchangePlan(space, comm, tags::node_faces, partners, send_rows, receive_rows);
}

namespace {

// Corners of an own face at x^{n+1}.
KOKKOS_INLINE_FUNCTION Quad ownQuad(const SweptBoxes& surface, int face) {
  Quad quad;
  for (int j = 0; j < 4; ++j)
    quad.corner[j] = rowOf(surface.coordinates_new, surface.face_to_nodes(face, j));
  return quad;
}

// Fills the records of own faces. On devices teams write whole runs of records, since one thread
// for each record would write a few bytes of many cache lines at once.
struct MakeRecords {
  static constexpr int num_threads = 128, team_size = host_accessible ? 1 : num_threads;
  using Policy =
      Kokkos::TeamPolicy<exec_space, Kokkos::LaunchBounds<team_size>, launch_by_argument>;
  using Member = Policy::member_type;

  SweptBoxes surface;
  RecordSelection selection;
  View<FaceRecord*> records;

  struct alignas(16) Chunk {
    unsigned char bytes[16];
  };
  static constexpr int chunks = sizeof(FaceRecord) / sizeof(Chunk);
  static_assert(sizeof(FaceRecord) % sizeof(Chunk) == 0, "records consist of chunks");
  struct alignas(16) Padded { // so that threads write to different banks
    FaceRecord record;
    Chunk unused;
  };
  struct Scratch {
    Padded made[num_threads];
    bool is_made[num_threads];
  };

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t face) const {
    constexpr std::int64_t ahead = 16; // faces
    if (face + ahead < surface.num_faces)
      for (int j = 0; j < 4; j += 2) // neighbours have the others
        prefetchRow(surface.coordinates_new, surface.face_to_nodes(face + ahead, j));
    if (selection.select(face))
      records(face) = recordOf(static_cast<int>(face));
  }
  KOKKOS_INLINE_FUNCTION void operator()(const Member& team) const {
    Scratch& scratch = *static_cast<Scratch*>(
        team.team_scratch(0).get_shmem_aligned(sizeof(Scratch), alignof(Scratch)));
    const int first = team.league_rank() * num_threads;
    const int count = minOf(num_threads, surface.num_faces - first);
    Kokkos::parallel_for(Kokkos::TeamThreadRange(team, count), [&](const int i) {
      scratch.is_made[i] = selection.select(first + i);
      if (scratch.is_made[i])
        scratch.made[i].record = recordOf(first + i);
    });
    team.team_barrier();
    auto* const to = reinterpret_cast<Chunk*>(&records(first));
    Kokkos::parallel_for(Kokkos::TeamThreadRange(team, count * chunks), [&](const int i) {
      if (scratch.is_made[i / chunks])
        to[i] = reinterpret_cast<const Chunk*>(&scratch.made[i / chunks])[i % chunks];
    });
  }

private:
  KOKKOS_INLINE_FUNCTION FaceRecord recordOf(int face) const {
    return {meanPlane(ownQuad(surface, face)), surface.face_body(face), surface.face_ids(face)};
  }
};

template <bool by_teams, class Make>
void makeRecords(const exec_space& space, const Make& make) {
  const int num_faces = make.surface.num_faces;
  if (num_faces == 0)
    return;
  if constexpr (by_teams) {
    using Scratch = typename Make::Scratch;
    typename Make::Policy policy(space, dividedUp(num_faces, Make::num_threads), Make::team_size);
    policy.set_scratch_size(0,
                            Kokkos::PerTeam(static_cast<int>(sizeof(Scratch) + alignof(Scratch))));
    Kokkos::parallel_for("contact::NodeFaces::ownRecords", policy, make);
  } else {
    Kokkos::parallel_for("contact::NodeFaces::ownRecords", rangePolicy(space, num_faces), make);
  }
}

} // namespace

void NodeFaces::updateRecords(const exec_space& space, const SweptBoxes& surface,
                              const RecordSelection& selection, const View<FaceRecord*>& records) {
  makeRecords<!fills_lanes>(space, MakeRecords{surface, selection, records});
  const auto border_faces = _border_faces;
  const auto border_areas = _border_areas;
  Kokkos::parallel_for(
      "contact::NodeFaces::borderAreas",
      rangePolicy(space, static_cast<std::int64_t>(border_faces.extent(0))),
      KOKKOS_LAMBDA(const std::int64_t i) {
        const Vec3 area = areaVector(ownQuad(surface, border_faces(i)));
        for (int d = 0; d < 3; ++d)
          border_areas(i, d) = area[d];
      });
  _plan.forward(space, _border_areas, _remote_areas);
  const auto remote_areas = _remote_areas;
  const int first = _num_faces;
  Kokkos::parallel_for(
      "contact::NodeFaces::remoteRecords", rangePolicy(space, _num_remote),
      KOKKOS_LAMBDA(const std::int64_t i) {
        records(first + i) = {planeOfArea(rowOf(remote_areas, i)), -1, -1};
      });
}

} // namespace brickwall::contact
