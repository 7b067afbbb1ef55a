#include "mechanics/mesh/skin.hpp"

#include "contact/base/group_by_key.hpp"
#include "contact/base/mpi.hpp"
#include "contact/base/to_device.hpp"
#include "mechanics/mesh/element_failure.hpp"
#include "mechanics/mesh/host_mesh.hpp"

#include <algorithm>
#include <array>

namespace brickwall::mechanics {

namespace {

// The four global node ids of a face, ascending.
using FaceKey = std::array<global_id, 4>;

FaceKey keyOf(const HostMesh& host, int elem, int side) {
  FaceKey key;
  for (int c = 0; c < 4; ++c)
    key[c] = host.node_ids(host.elem_to_nodes(elem, hex8_sides[side][c]));
  std::sort(key.begin(), key.end());
  return key;
}

bool allShared(const HostMesh& host, int elem, int side, const std::vector<char>& is_shared) {
  bool all = true;
  for (const int c : hex8_sides[side])
    all = all && is_shared[host.elem_to_nodes(elem, c)];
  return all;
}

std::vector<char> sharedFlags(const HexMesh& mesh, const SharedNodeLists& shared) {
  std::vector<char> is_shared(mesh.num_nodes, 0);
  for (const auto& list : shared.nodes)
    for (const int node : list)
      is_shared[node] = 1;
  return is_shared;
}

struct LocalFace {
  int elem, side;
};

global_id idOf(const HostMesh& host, const LocalFace& face) {
  return 6 * host.elem_ids(face.elem) + face.side;
}

// `face`: the lowest id of a face of this rank that more than two elements share, or no_face.
// Collective.
constexpr global_id no_face = INT64_MAX;
void refuseThirdElement(MPI_Comm comm, global_id face) {
  const global_id first = allReduce(comm, face, MPI_MIN);
  if (first != no_face)
    throw BadElementError(first / 6, "has a side that belongs to more than two elements, side " +
                                         std::to_string(first % 6 + 1) + "; expected one or two");
}

// Local nodes of face 6 elem + side, ascending.
std::array<int, 4> nodesOf(const HostMesh& host, std::int64_t face) {
  std::array<int, 4> nodes;
  for (int c = 0; c < 4; ++c)
    nodes[c] = host.elem_to_nodes(face / 6, hex8_sides[face % 6][c]);
  const auto order = [&](int a, int b) {
    const auto [low, high] = std::minmax({nodes[a], nodes[b]});
    nodes[a] = low, nodes[b] = high;
  };
  order(0, 1), order(2, 3), order(0, 2), order(1, 3), order(1, 2);
  return nodes;
}

// Faces of this rank's elements that may be on the skin or on a cut between ranks, in the order of
// element, then side: faces that no other element of this rank shares, and faces with only shared
// corners, which may also belong to an element of another rank. `crowded` becomes the lowest id of
// a face that more than two elements share.
std::vector<LocalFace> outerFaces(const HexMesh& mesh, const HostMesh& host,
                                  const std::vector<char>& is_shared, global_id& crowded) {
  const int num_faces = checkedInt(6 * std::int64_t(mesh.num_elems), "findSkin: element sides");
  const Groups groups = groupByKey("mechanics::findSkin::groups", num_faces, mesh.num_nodes,
                                   [&](std::int64_t face) { return nodesOf(host, face)[0]; });
  std::vector<char> is_outer = hostArray<char>(num_faces);
  parallelOnHost("mechanics::findSkin::match", mesh.num_nodes, [&](std::int64_t node) {
    const int* const begin = groups.items.data() + groups.begin[node];
    const int* const end = groups.items.data() + groups.begin[node + 1];
    static thread_local std::vector<std::array<int, 4>> nodes; // of these faces
    nodes.clear();
    for (const int* face = begin; face < end; ++face)
      nodes.push_back(nodesOf(host, *face));
    for (const int* face = begin; face < end; ++face) {
      int before = 0, after = 0;
      for (const int* other = begin; other < end; ++other)
        if (other != face && nodes[other - begin] == nodes[face - begin])
          ++(*other < *face ? before : after);
      is_outer[*face] = before + after == 0 || allShared(host, *face / 6, *face % 6, is_shared);
      if (before + after > 1)
        Kokkos::atomic_fetch_min(&crowded, idOf(host, {*face / 6, *face % 6}));
    }
  });
  // by parts of the faces, in order
  constexpr int part = 1 << 16;
  std::vector<std::vector<LocalFace>> parts(num_faces / part + 1);
  parallelOnHost("mechanics::findSkin::outer", parts.size(), [&](std::int64_t p) {
    for (std::int64_t face = p * part; face < minOf<std::int64_t>((p + 1) * part, num_faces);
         ++face)
      if (is_outer[face])
        parts[p].push_back({static_cast<int>(face / 6), static_cast<int>(face % 6)});
  });
  std::vector<LocalFace> faces;
  for (const auto& some : parts)
    faces.insert(faces.end(), some.begin(), some.end());
  return faces;
}

// Removes the faces on a cut. Only faces whose corners are all shared can lie on a cut.
std::vector<LocalFace> withoutCuts(MPI_Comm comm, const HostMesh& host,
                                   const std::vector<char>& is_shared,
                                   std::vector<LocalFace> faces) {
  std::vector<std::size_t> suspects;
  std::vector<FaceKey> keys;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (allShared(host, faces[f].elem, faces[f].side, is_shared)) {
      suspects.push_back(f);
      keys.push_back(keyOf(host, faces[f].elem, faces[f].side));
    }
  }
  const std::vector<std::int64_t> uses =
      countOnAllRanks(comm, keys, [](const FaceKey& key) { return key[0]; });
  std::vector<char> is_cut(faces.size(), 0);
  for (std::size_t s = 0; s < suspects.size(); ++s)
    is_cut[suspects[s]] = uses[s] > 1;
  global_id crowded = no_face;
  for (std::size_t s = 0; s < suspects.size(); ++s)
    if (uses[s] > 2)
      crowded = minOf(crowded, idOf(host, faces[suspects[s]]));
  refuseThirdElement(comm, crowded);
  std::size_t next = 0;
  faces.erase(std::remove_if(faces.begin(), faces.end(),
                             [&](const LocalFace&) { return is_cut[next++] != 0; }),
              faces.end());
  return faces;
}

// flag[node] becomes nonzero if it is so on any rank that shares the node. Collective.
void spreadToSharers(MPI_Comm comm, const SharedNodeLists& shared, std::vector<char>& flag) {
  std::vector<std::vector<char>> messages(sizeOf(comm));
  for (std::size_t p = 0; p < shared.ranks.size(); ++p)
    for (const int node : shared.nodes[p])
      messages[shared.ranks[p]].push_back(flag[node]);
  const auto received = exchangeByRank(comm, messages);
  for (std::size_t p = 0; p < shared.ranks.size(); ++p)
    for (std::size_t i = 0; i < shared.nodes[p].size(); ++i)
      flag[shared.nodes[p][i]] |= received[shared.ranks[p]][i];
}

// Surface node of each mesh node, or -1. A node is on the surface if it is so on any rank that
// shares it.
std::vector<int> surfaceNodes(MPI_Comm comm, const HexMesh& mesh, const HostMesh& host,
                              const SharedNodeLists& shared, const std::vector<LocalFace>& faces,
                              std::vector<int>& surface_to_node) {
  std::vector<char> on_surface(mesh.num_nodes, 0);
  for (const LocalFace& face : faces)
    for (const int c : hex8_sides[face.side])
      on_surface[host.elem_to_nodes(face.elem, c)] = 1;
  spreadToSharers(comm, shared, on_surface);
  std::vector<int> surface_of(mesh.num_nodes, -1);
  for (int node = 0; node < mesh.num_nodes; ++node)
    if (on_surface[node]) {
      surface_of[node] = static_cast<int>(surface_to_node.size());
      surface_to_node.push_back(node);
    }
  return surface_of;
}

} // namespace

Skin findSkin(const exec_space& space, MPI_Comm comm, const HexMesh& mesh,
              const SharedNodeLists& shared) {
  const HostMesh host = copyToHost(space, mesh);
  std::vector<LocalFace> faces;
  const std::vector<char> is_shared = sharedFlags(mesh, shared);
  global_id crowded = no_face;
  rethrowOnAllRanks(comm, [&] { faces = outerFaces(mesh, host, is_shared, crowded); });
  refuseThirdElement(comm, crowded);
  faces = withoutCuts(comm, host, is_shared, std::move(faces));
  std::vector<int> surface_to_node;
  const std::vector<int> surface_of =
      surfaceNodes(comm, mesh, host, shared, faces, surface_to_node);

  const auto num_faces = static_cast<std::int64_t>(faces.size());
  std::vector<int> elems(num_faces), sides(num_faces), nodes(4 * num_faces), surface(4 * num_faces);
  std::vector<global_id> ids(num_faces);
  parallelOnHost("mechanics::findSkin::faces", num_faces, [&](std::int64_t f) {
    const LocalFace face = faces[f];
    elems[f] = face.elem;
    sides[f] = face.side;
    ids[f] = idOf(host, face);
    for (int j = 0; j < 4; ++j) {
      nodes[4 * f + j] = host.elem_to_nodes(face.elem, hex8_sides[face.side][j]);
      surface[4 * f + j] = surface_of[nodes[4 * f + j]];
    }
  });
  Skin skin;
  skin.num_faces = static_cast<int>(faces.size());
  skin.num_nodes = static_cast<int>(surface_to_node.size());
  skin.face_to_elem = toDevice(space, "mechanics::Skin::face_to_elem", elems);
  skin.face_to_side = toDevice(space, "mechanics::Skin::face_to_side", sides);
  skin.face_ids = toDevice(space, "mechanics::Skin::face_ids", ids);
  skin.face_to_nodes = toDevice<View<int* [4]>>(space, "mechanics::Skin::face_to_nodes", nodes);
  skin.face_to_surface_nodes =
      toDevice<View<int* [4]>>(space, "mechanics::Skin::face_to_surface_nodes", surface);
  skin.surface_to_node = toDevice(space, "mechanics::Skin::surface_to_node", surface_to_node);
  return skin;
}

std::vector<int> sideNodes(const HexMesh& mesh, const std::vector<int>& elems,
                           const std::vector<int>& sides) {
  const auto elem_to_nodes = copyToHost(exec_space(), mesh).elem_to_nodes;
  std::vector<int> nodes;
  for (std::size_t f = 0; f < elems.size(); ++f)
    for (const int c : hex8_sides[sides[f]])
      nodes.push_back(elem_to_nodes(elems[f], c));
  return nodes;
}

} // namespace brickwall::mechanics
