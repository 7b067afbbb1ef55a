#include "contact/enforcement/edge_edge/edge_surface.hpp"

#include "contact/base/to_device.hpp"
#include "contact/enforcement/edge_edge/edge_edge_kinematics.hpp"

#include <algorithm>
#include <vector>

namespace brickwall::contact {
namespace {

// A device View filled on the host by set(host view).
template <class ViewType, class Set, class... Extents>
ViewType filled(const exec_space& space, const std::string& label, const Set& set,
                Extents... extents) {
  auto device = allocate<ViewType>(space, label, extents...);
  auto host = Kokkos::create_mirror_view(device);
  set(host);
  Kokkos::deep_copy(space, device, host);
  space.fence();
  return device;
}

// Ids from here on belong to no node of a mesh.
constexpr global_id first_edge_node_id = global_id(1) << 60;

// Nodes of the host's surface at the corners of the listed faces, ascending. Sets corner_of [node],
// their places in the list.
std::vector<int> cornersOf(const Surface& surface, const FeatureEdges& edges,
                           std::vector<int>& corner_of) {
  const auto face_to_nodes = toHost(surface.face_to_nodes);
  corner_of.assign(surface.num_nodes, -1);
  for (const FeatureEdge& edge : edges.convex)
    for (int j = 0; j < 4; ++j)
      corner_of[face_to_nodes(edge.face, j)] = 0;
  std::vector<int> corners;
  for (int node = 0; node < surface.num_nodes; ++node)
    if (corner_of[node] == 0) {
      corner_of[node] = static_cast<int>(corners.size());
      corners.push_back(node);
    }
  return corners;
}

} // namespace

EdgeSurface edgeSurface(const exec_space& space, const Surface& surface, const FeatureEdges& edges,
                        const View<const double*>& node_mass) {
  std::vector<int> corner_of;
  const std::vector<int> corners = cornersOf(surface, edges, corner_of);
  const int num_corners = static_cast<int>(corners.size());
  const int num_edges = static_cast<int>(edges.convex.size());
  const int num_nodes = num_corners + num_edges;
  const auto face_to_nodes = toHost(surface.face_to_nodes);
  const auto node_ids = toHost(surface.node_ids), face_ids = toHost(surface.face_ids);
  const auto node_body = toHost(surface.node_body), face_body = toHost(surface.face_body);
  const auto attributes = toHost(surface.face_attributes);
  const auto idOf = [&](int e) {
    return 4 * face_ids(edges.convex[e].face) + edges.convex[e].edge;
  };
  EdgeSurface made;
  made.num_corners = num_corners;
  SweptBoxes& s = made.surface;
  s.num_nodes = num_nodes;
  s.num_faces = num_edges;
  s.face_to_nodes = filled<View<int* [4]>>(
      space, "contact::EdgeContact::edge_to_nodes",
      [&](auto& v) {
        for (int e = 0; e < num_edges; ++e)
          for (int j = 0; j < 4; ++j)
            v(e, j) =
                corner_of[face_to_nodes(edges.convex[e].face, (edges.convex[e].edge + j) % 4)];
      },
      num_edges);
  made.edge_to_nodes = filled<View<int* [4]>>(
      space, "contact::EdgeContact::edge_to_host_nodes",
      [&](auto& v) {
        for (int e = 0; e < num_edges; ++e)
          for (int j = 0; j < 4; ++j)
            v(e, j) = face_to_nodes(edges.convex[e].face, (edges.convex[e].edge + j) % 4);
      },
      num_edges);
  s.node_ids = filled<View<global_id*>>(
      space, "contact::EdgeContact::node_ids",
      [&](auto& v) {
        for (int i = 0; i < num_nodes; ++i)
          v(i) =
              i < num_corners ? node_ids(corners[i]) : first_edge_node_id + idOf(i - num_corners);
      },
      num_nodes);
  s.node_body = filled<View<global_id*>>(
      space, "contact::EdgeContact::node_body",
      [&](auto& v) {
        for (int i = 0; i < num_nodes; ++i)
          v(i) = i < num_corners ? node_body(corners[i])
                                 : face_body(edges.convex[i - num_corners].face);
      },
      num_nodes);
  s.node_is_owned = filled<View<unsigned char*>>( // only rows of edges search
      space, "contact::EdgeContact::node_is_owned",
      [&](auto& v) {
        for (int i = 0; i < num_nodes; ++i)
          v(i) = i >= num_corners;
      },
      num_nodes);
  s.face_ids = filled<View<global_id*>>(
      space, "contact::EdgeContact::edge_ids",
      [&](auto& v) {
        for (int e = 0; e < num_edges; ++e)
          v(e) = idOf(e);
      },
      num_edges);
  s.face_body = filled<View<global_id*>>(
      space, "contact::EdgeContact::edge_body",
      [&](auto& v) {
        for (int e = 0; e < num_edges; ++e)
          v(e) = face_body(edges.convex[e].face);
      },
      num_edges);
  s.face_attributes = filled<AttributeWords>(
      space, "contact::EdgeContact::attributes",
      [&](auto& v) {
        for (int e = 0; e < num_edges; ++e) {
          const FeatureEdge& edge = edges.convex[e];
          const CornerMasses& face = attributesAt<CornerMasses>(attributes, edge.face);
          EdgeAttributes& attributes_of_edge = attributesAt<EdgeAttributes>(v, e);
          for (int j = 0; j < 4; ++j)
            attributes_of_edge.corner_mass[j] = face.corner_mass[(edge.edge + j) % 4];
          attributes_of_edge.cosine = edge.cosine;
          attributes_of_edge.sine = edge.sine;
          attributes_of_edge.goes_on = edge.goes_on;
          for (int side = 0; side < 2; ++side)
            attributes_of_edge.width[side] = edge.width[side];
        }
      },
      num_edges, words_of<EdgeAttributes>);
  made.corner_to_node = filled<View<int*>>(
      space, "contact::EdgeContact::corner_to_node",
      [&](auto& v) { std::copy(corners.begin(), corners.end(), v.data()); }, num_corners);
  const auto masses = toHost(node_mass);
  made.corner_mass = filled<View<double*>>(
      space, "contact::EdgeContact::corner_mass",
      [&](auto& v) {
        for (int i = 0; i < num_corners; ++i)
          v(i) = masses(corners[i]);
      },
      num_corners);
  made.records = filled<View<EdgeRecord*>>(
      space, "contact::EdgeContact::records",
      [&](auto& v) {
        for (int e = 0; e < num_edges; ++e)
          v(e) = {{}, face_body(edges.convex[e].face), idOf(e)};
      },
      num_edges);
  return made;
}

} // namespace brickwall::contact
