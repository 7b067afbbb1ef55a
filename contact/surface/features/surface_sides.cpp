// See surface_sides.hpp. Patches are joined on their rank first. Those that meet parts on other
// ranks, directly or through others, are told to all ranks, which number them alike.
#include "contact/surface/features/surface_sides.hpp"

#include "contact/base/to_device.hpp"
#include "contact/surface/features/joined_parts.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace brickwall::contact {
namespace {

// An edge of a face, where its patch goes on to another face or meets another patch.
struct PatchEdge : Meeting {
  int face, edge; // own face
  int is_concave; // otherwise the patch goes on
  int unused;
};

// The bodies of all ranks that have concave edges.
std::vector<global_id> findConcaveBodies(MPI_Comm comm,
                                         const std::vector<unsigned char>& concave_edges,
                                         const View<const global_id*>& face_body) {
  const auto body = toHost(face_body);
  std::vector<global_id> bodies;
  for (std::size_t face = 0; face < concave_edges.size(); ++face)
    if (concave_edges[face] != 0)
      bodies.push_back(bodyOfSide(body(face)));
  return sortedDistinct(gatherFromAll(comm, sortedDistinct(std::move(bodies))));
}

// The edges of this rank's faces of the given bodies, sorted, with the face as the part.
std::vector<PatchEdge> findEdges(const Surface& surface, const std::vector<global_id>& bodies,
                                 const std::vector<unsigned char>& concave_edges,
                                 const std::vector<unsigned char>& face_edges) {
  const auto body = toHost(surface.face_body), face_ids = toHost(surface.face_ids),
             node_ids = toHost(surface.node_ids);
  const auto face_to_nodes = toHost(surface.face_to_nodes);
  std::vector<PatchEdge> edges;
  for (int face = 0; face < surface.num_faces; ++face) {
    if (!std::binary_search(bodies.begin(), bodies.end(), bodyOfSide(body(face))))
      continue;
    for (int j = 0; j < 4; ++j) {
      const int is_concave = concave_edges[face] >> j & 1;
      const bool is_feature = (face_edges[face] >> j & 1) != 0;
      const auto [low, high] = std::minmax(
          {node_ids(face_to_nodes(face, j)), node_ids(face_to_nodes(face, (j + 1) % 4))});
      if (low != high && (is_concave != 0 || !is_feature))
        edges.push_back({{low, high, face_ids(face)}, face, j, is_concave, 0});
    }
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

// [own face] the lowest id of the part of its patch on this rank.
std::vector<global_id> findParts(const Surface& surface, const std::vector<PatchEdge>& edges) {
  DisjointSets parts(surface.num_faces);
  forPairs(edges, [&](const PatchEdge& a, const PatchEdge& b) {
    if (a.is_concave == 0)
      parts.join(a.face, b.face);
  });
  const auto ids = toHost(surface.face_ids);
  return parts.lowestOfSets(std::vector<global_id>(ids.data(), ids.data() + surface.num_faces));
}

// The edges, sorted, at which parts meet: those of this rank, and those of other ranks that parts
// on them meet directly or through others. `parts` [own face].
std::vector<PatchEdge> findMeetings(MPI_Comm comm, const std::vector<PatchEdge>& own,
                                    const std::vector<global_id>& parts) {
  const auto num_faces = parts.size();
  DisjointSets groups(num_faces); // of patches that meet on this rank
  std::vector<char> is_matched(own.size(), 0), goes_on(num_faces, 0);
  for (std::size_t i = 0; i + 1 < own.size(); ++i)
    if (own[i].ids() == own[i + 1].ids()) {
      is_matched[i] = is_matched[i + 1] = 1;
      groups.join(own[i].face, own[i + 1].face);
    }
  for (std::size_t i = 0; i < own.size(); ++i)
    if (!is_matched[i])
      goes_on[groups.rootOf(own[i].face)] = 1;
  std::vector<PatchEdge> here, for_all;
  for (std::size_t i = 0; i < own.size(); ++i)
    if (own[i].is_concave != 0 || !is_matched[i]) {
      auto& list = goes_on[groups.rootOf(own[i].face)] ? for_all : here;
      list.push_back(own[i]);
      list.back().part = parts[own[i].face];
    }
  const std::vector<PatchEdge> all = gatherFromAll(comm, for_all);
  here.insert(here.end(), all.begin(), all.end());
  std::sort(here.begin(), here.end());
  return here;
}

// Pairs of patches, each in both orders and sorted, that concave edges with a common node connect:
// those on both sides of an edge, and all around the deepest point of a pit. `edges`, sorted, have
// patches as parts.
std::vector<std::pair<global_id, global_id>> findPairs(const std::vector<PatchEdge>& edges) {
  std::vector<std::array<global_id, 3>> at_nodes; // node, two patches that meet at an edge of it
  forPairs(edges, [&](const PatchEdge& a, const PatchEdge& b) {
    if (a.is_concave != 0 && a.part != b.part)
      for (const global_id node : {a.low, a.high})
        at_nodes.push_back({node, a.part, b.part});
  });
  std::sort(at_nodes.begin(), at_nodes.end());
  std::vector<std::pair<global_id, global_id>> pairs;
  for (auto first = at_nodes.begin(), last = first; first != at_nodes.end(); first = last) {
    last =
        std::find_if(first, at_nodes.end(), [&](const auto& at) { return at[0] != (*first)[0]; });
    std::vector<global_id> patches;
    for (auto at = first; at != last; ++at)
      patches.insert(patches.end(), {(*at)[1], (*at)[2]});
    patches = sortedDistinct(std::move(patches));
    const auto placeOf = [&](global_id patch) {
      return std::lower_bound(patches.begin(), patches.end(), patch) - patches.begin();
    };
    DisjointSets connected(patches.size());
    for (auto at = first; at != last; ++at)
      connected.join(placeOf((*at)[1]), placeOf((*at)[2]));
    for (std::size_t i = 0; i < patches.size(); ++i)
      for (std::size_t j = 0; j < patches.size(); ++j)
        if (i != j && connected.rootOf(i) == connected.rootOf(j))
          pairs.push_back({patches[i], patches[j]});
  }
  return sortedDistinct(std::move(pairs));
}

// The sides of patches; `meeting` as findPairs() gives them.
std::map<global_id, int> chooseSides(const std::vector<std::pair<global_id, global_id>>& meeting) {
  std::map<global_id, int> sides;
  for (auto first = meeting.begin(), last = first; first != meeting.end(); first = last) {
    std::vector<int> taken; // by patches of lower ids
    for (; last != meeting.end() && last->first == first->first; ++last)
      if (last->second < first->first)
        taken.push_back(sides.at(last->second));
    int side = 0;
    while (std::find(taken.begin(), taken.end(), side) != taken.end())
      ++side;
    sides[first->first] = side;
  }
  return sides;
}

} // namespace

std::vector<int> findSides(MPI_Comm comm, const Surface& surface,
                           const std::vector<unsigned char>& concave_edges,
                           std::vector<unsigned char>& face_edges) {
  std::vector<int> sides(surface.num_faces, 0);
  const std::vector<global_id> bodies = findConcaveBodies(comm, concave_edges, surface.face_body);
  if (bodies.empty())
    return sides;
  const std::vector<PatchEdge> own = findEdges(surface, bodies, concave_edges, face_edges);
  const std::vector<global_id> parts = findParts(surface, own);
  std::vector<PatchEdge> all = findMeetings(comm, own, parts);
  const auto patches = joinParts(all, [](const PatchEdge& edge) { return edge.is_concave == 0; });
  for (PatchEdge& edge : all)
    edge.part = patches.at(edge.part);
  const std::map<global_id, int> sides_of_patches = chooseSides(findPairs(all));
  for (int face = 0; face < surface.num_faces; ++face) {
    const auto patch = patches.find(parts[face]);
    if (patch == patches.end())
      continue; // it meets no other one
    const auto side = sides_of_patches.find(patch->second);
    if (side != sides_of_patches.end())
      sides[face] = side->second;
  }
  std::vector<PatchEdge> between; // sides
  forPairs(all, [&](const PatchEdge& a, const PatchEdge& b) {
    if (a.is_concave != 0 && a.part != b.part)
      between.push_back(a);
  });
  for (const PatchEdge& edge : own)
    if (std::binary_search(between.begin(), between.end(), edge))
      face_edges[edge.face] |= static_cast<unsigned char>(1 << edge.edge);
  return sides;
}

} // namespace brickwall::contact
