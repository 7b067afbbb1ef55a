#include "contact/enforcement/edge_edge/edge_surface.hpp"

#include "contact/base/to_device.hpp"
#include "contact/enforcement/edge_edge/edge_edge_kinematics.hpp"
#include "contact/enforcement/law/check_enforcement_input.hpp"

#include <string>
#include <vector>

namespace brickwall::contact {
namespace {

// A device View whose rows are filled on the host by setRow(host view, row).
template <class ViewType, class SetRow, class... Columns>
ViewType filled(const exec_space& space, const std::string& name, int rows, const SetRow& setRow,
                Columns... columns) {
  auto device = allocate<ViewType>(space, "contact::EdgeContact::" + name, rows, columns...);
  auto host = Kokkos::create_mirror_view(device);
  for (int row = 0; row < rows; ++row)
    setRow(host, row);
  Kokkos::deep_copy(space, device, host);
  space.fence();
  return device;
}

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

void setAttributes(const FeatureEdge& edge, const CornerMasses& face, EdgeAttributes& attributes) {
  for (int j = 0; j < 4; ++j)
    attributes.corner_mass[j] = face.corner_mass[(edge.edge + j) % 4];
  attributes.cosine = edge.cosine;
  attributes.sine = edge.sine;
  attributes.goes_on = edge.goes_on;
  for (int side = 0; side < 2; ++side)
    attributes.width[side] = edge.width[side];
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
  const auto masses = toHost(node_mass);
  const auto nodeOf = [&](int e, int j) {
    return face_to_nodes(edges.convex[e].face, (edges.convex[e].edge + j) % 4);
  };
  const auto idOf = [&](int e) {
    return 4 * face_ids(edges.convex[e].face) + edges.convex[e].edge;
  };
  const auto bodyOf = [&](int e) { return bodyOfSide(face_body(edges.convex[e].face)); };
  const auto lineOf = [&](int e) { return sideOfBody(bodyOf(e), edges.convex[e].line); };
  EdgeSurface made;
  made.num_corners = num_corners;
  SweptBoxes& s = made.surface;
  s.num_nodes = num_nodes;
  s.num_faces = num_edges;
  s.face_to_nodes = filled<View<int* [4]>>(space, "edge_to_nodes", num_edges, [&](auto& v, int e) {
    for (int j = 0; j < 4; ++j)
      v(e, j) = corner_of[nodeOf(e, j)];
  });
  made.edge_to_nodes =
      filled<View<int* [4]>>(space, "edge_to_host_nodes", num_edges, [&](auto& v, int e) {
        for (int j = 0; j < 4; ++j)
          v(e, j) = nodeOf(e, j);
      });
  s.node_ids = filled<View<global_id*>>(space, "node_ids", num_nodes, [&](auto& v, int i) {
    v(i) = i < num_corners ? node_ids(corners[i]) : first_edge_id + idOf(i - num_corners);
  });
  s.node_body = filled<View<global_id*>>(space, "node_body", num_nodes, [&](auto& v, int i) {
    v(i) = i < num_corners ? node_body(corners[i]) : bodyOf(i - num_corners);
  });
  s.node_is_owned =
      filled<View<unsigned char*>>(space, "node_is_owned", num_nodes, [&](auto& v, int i) {
        v(i) = i >= num_corners; // only rows of edges search
      });
  s.face_ids = filled<View<global_id*>>(space, "edge_ids", num_edges,
                                        [&](auto& v, int e) { v(e) = idOf(e); });
  s.face_body = filled<View<global_id*>>(space, "edge_body", num_edges,
                                         [&](auto& v, int e) { v(e) = lineOf(e); });
  s.face_attributes = filled<AttributeWords>(
      space, "attributes", num_edges,
      [&](auto& v, int e) {
        const FeatureEdge& edge = edges.convex[e];
        setAttributes(edge, attributesAt<CornerMasses>(attributes, edge.face),
                      attributesAt<EdgeAttributes>(v, e));
      },
      words_of<EdgeAttributes>);
  made.corner_to_node = filled<View<int*>>(space, "corner_to_node", num_corners,
                                           [&](auto& v, int i) { v(i) = corners[i]; });
  made.corner_mass = filled<View<double*>>(space, "corner_mass", num_corners,
                                           [&](auto& v, int i) { v(i) = masses(corners[i]); });
  made.records = filled<View<EdgeRecord*>>(space, "records", num_edges, [&](auto& v, int e) {
    v(e) = {{}, lineOf(e), idOf(e)};
  });
  return made;
}

} // namespace brickwall::contact
