#include "miniapp/simulation/surface_coupling.hpp"

#include "contact/base/to_device.hpp"
#include "mechanics/step/acceleration.hpp"

#include <utility>

namespace brickwall::miniapp {

namespace {

// Mass per area that a face sets against contact: rho h_n/2, with h_n the element's
// thickness along the face's normal, between the centres of the face and of the opposite side.
KOKKOS_INLINE_FUNCTION double surfaceMass(const Vec3 (&face)[4], const Vec3& element_centre,
                                          double density) {
  const Vec3 centre = 0.25 * (face[0] + face[1] + face[2] + face[3]);
  const Vec3 area = cross(face[2] - face[0], face[3] - face[1]);
  const double thickness = 2 * dot(centre - element_centre, area) / norm(area);
  return 0.5 * density * thickness;
}

} // namespace

SurfaceCoupling::SurfaceCoupling(const exec_space& space, const Scene& scene,
                                 const mechanics::BoundaryConditions& boundary)
    : _num_nodes(scene.skin.num_nodes), _num_faces(scene.skin.num_faces),
      _surface_to_node(scene.skin.surface_to_node), _face_to_nodes(scene.skin.face_to_nodes),
      _face_to_surface_nodes(scene.skin.face_to_surface_nodes),
      _reference(scene.mesh.reference_coordinates),
      _old(allocate<View<double* [3]>>(space, "coupling::x_old", _num_nodes)),
      _new(allocate<View<double* [3]>>(space, "coupling::x_new", _num_nodes)),
      _face_ids(scene.skin.face_ids),
      _node_ids(allocate<View<global_id*>>(space, "coupling::node_ids", _num_nodes)),
      _node_body(allocate<View<global_id*>>(space, "coupling::node_body", _num_nodes)),
      _face_body(allocate<View<global_id*>>(space, "coupling::face_body", _num_faces)),
      _node_is_owned(allocate<View<unsigned char*>>(space, "coupling::node_is_owned", _num_nodes)),
      _attributes(allocate<View<double**>>(space, "coupling::face_attributes", _num_faces,
                                           contact::NodeFaces::num_columns)),
      _contact_forces(allocate<View<std::int64_t**>>(space, "coupling::contact_forces",
                                                     scene.mesh.num_nodes, 3)),
      _accelerations(allocate<View<double* [3]>>(space, "coupling::accelerations", _num_nodes)) {
  fillNodes(space, scene, boundary);
  fillFaces(space, scene);
}

void SurfaceCoupling::fillNodes(const exec_space& space, const Scene& scene,
                                const mechanics::BoundaryConditions& boundary) {
  std::vector<global_id> bodies(scene.part.node_ids.size());
  for (int elem = 0; elem < scene.part.numElems(); ++elem)
    for (int corner = 0; corner < 8; ++corner)
      bodies[scene.part.elem_nodes[std::size_t(8) * elem + corner]] = scene.part.elem_body[elem];
  const auto body_of_node = toDevice<View<global_id*>>(space, "coupling::body_of_node", bodies);

  auto node_mass = allocate<View<double*>>(space, "coupling::node_mass", _num_nodes);
  const auto prescribed = boundary.motion();
  const bool any = boundary.any();
  const auto surface_to_node = _surface_to_node;
  const auto node_ids = _node_ids, node_body = _node_body;
  const auto node_is_owned = _node_is_owned;
  const auto mesh_ids = scene.mesh.node_ids;
  const auto mesh_is_owned = scene.mesh.node_is_owned;
  const auto mesh_mass = scene.mass;
  Kokkos::parallel_for(
      "coupling::fillNodes", rangePolicy(space, _num_nodes), KOKKOS_LAMBDA(const std::int64_t i) {
        const int node = surface_to_node(i);
        node_ids(i) = mesh_ids(node);
        node_is_owned(i) = mesh_is_owned(node);
        node_body(i) = body_of_node(node);
        const bool held = any && prescribed(node, 0) && prescribed(node, 1) && prescribed(node, 2);
        node_mass(i) = held ? HUGE_VAL : mesh_mass(node);
      });
  _node_mass = node_mass;
}

void SurfaceCoupling::fillFaces(const exec_space& space, const Scene& scene) {
  const auto elem_body =
      toDevice<View<global_id*>>(space, "coupling::elem_body", scene.part.elem_body);
  const auto face_to_elem = scene.skin.face_to_elem;
  const auto elem_to_nodes = scene.mesh.elem_to_nodes;
  const auto elem_block = scene.mesh.elem_block;
  const auto materials = scene.mesh.materials;
  const auto face_to_nodes = _face_to_nodes, face_to_surface_nodes = _face_to_surface_nodes;
  const auto X = _reference;
  const auto node_mass = _node_mass;
  const auto face_body = _face_body;
  const auto attributes = _attributes;
  Kokkos::parallel_for(
      "coupling::fillFaces", rangePolicy(space, _num_faces),
      KOKKOS_LAMBDA(const std::int64_t face) {
        const int elem = face_to_elem(face);
        Vec3 centre;
        for (int corner = 0; corner < 8; ++corner)
          centre += 0.125 * rowOf(X, elem_to_nodes(elem, corner));
        Vec3 corners[4];
        for (int corner = 0; corner < 4; ++corner) {
          corners[corner] = rowOf(X, face_to_nodes(face, corner));
          attributes(face, corner) = node_mass(face_to_surface_nodes(face, corner));
        }
        attributes(face, contact::NodeFaces::surface_mass_column) =
            surfaceMass(corners, centre, materials(elem_block(elem)).density);
        face_body(face) = elem_body(elem);
      });
  space.fence();
}

void SurfaceCoupling::setTrueEdges(const exec_space& space,
                                   const std::vector<unsigned char>& true_edges) {
  const auto masks = toDevice<View<unsigned char*>>(space, "coupling::true_edges", true_edges);
  const auto attributes = _attributes;
  Kokkos::parallel_for(
      "coupling::setTrueEdges", rangePolicy(space, _num_faces),
      KOKKOS_LAMBDA(const std::int64_t face) {
        attributes(face, contact::NodeFaces::true_edges_column) = masks(face);
      });
}

void SurfaceCoupling::gatherCoordinates(const exec_space& space,
                                        const View<const double* [3]>& displacement) {
  std::swap(_old, _new);
  gatherAgain(space, displacement);
}

void SurfaceCoupling::gatherAgain(const exec_space& space,
                                  const View<const double* [3]>& displacement) {
  const auto surface_to_node = _surface_to_node;
  const auto X = _reference;
  const auto x = _new;
  Kokkos::parallel_for(
      "coupling::gatherCoordinates", rangePolicy(space, _num_nodes),
      KOKKOS_LAMBDA(const std::int64_t i) {
        const int node = surface_to_node(i);
        for (int d = 0; d < 3; ++d)
          x(i, d) = X(node, d) + displacement(node, d);
      });
}

void SurfaceCoupling::resetCoordinates(const exec_space& space,
                                       const View<const double* [3]>& displacement) {
  gatherCoordinates(space, displacement);
  Kokkos::deep_copy(space, _old, _new);
}

contact::Surface SurfaceCoupling::surface() const {
  contact::Surface surface;
  surface.num_nodes = _num_nodes;
  surface.num_faces = _num_faces;
  surface.coordinates_old = _old;
  surface.coordinates_new = _new;
  surface.face_to_nodes = _face_to_surface_nodes;
  surface.node_ids = _node_ids;
  surface.face_ids = _face_ids;
  surface.node_is_owned = _node_is_owned;
  surface.node_body = _node_body;
  surface.face_body = _face_body;
  surface.face_attributes = _attributes;
  return surface;
}

void SurfaceCoupling::sumContactForces(const exec_space& space,
                                       const contact::ContactForces& forces,
                                       contact::CandidateSearch& search,
                                       mechanics::SharedNodeSum& shared) {
  const auto statistics = search.statistics();
  if (statistics.num_ghosts > 0 || statistics.faces_sent > 0)
    search.reverseSum(space, _face_to_surface_nodes, forces.ghost_corners, forces.nodes);
  if (shared.partners().empty())
    return;
  const auto surface_to_node = _surface_to_node;
  const auto nodes = forces.nodes;
  const auto totals = _contact_forces; // 0 inside the bodies for ever
  Kokkos::parallel_for(
      "coupling::toMesh", rangePolicy(space, _num_nodes), KOKKOS_LAMBDA(const std::int64_t i) {
        for (int d = 0; d < 3; ++d)
          totals(surface_to_node(i), d) = nodes(i, d);
      });
  shared.sum(space, totals);
  Kokkos::parallel_for(
      "coupling::toSurface", rangePolicy(space, _num_nodes), KOKKOS_LAMBDA(const std::int64_t i) {
        for (int d = 0; d < 3; ++d)
          nodes(i, d) = totals(surface_to_node(i), d);
      });
}

void SurfaceCoupling::storeContactForces(const exec_space& space, const contact::NodeList& list,
                                         const contact::ContactForces& forces,
                                         const mechanics::NodalForces& target) const {
  const auto surface_to_node = _surface_to_node;
  const auto totals = forces.nodes;
  const auto values = target.values;
  Kokkos::parallel_for(
      "coupling::storeContactForces", rangePolicy(space, list.count),
      KOKKOS_LAMBDA(const std::int64_t i) {
        const int at = list(i);
        for (int d = 0; d < 3; ++d)
          values(surface_to_node(at), 3 * mechanics::contact_force + d) = totals(at, d);
      });
}

const View<double* [3]>& SurfaceCoupling::accelerations(
    const exec_space& space, const contact::NodeList& list, const mechanics::NodalForces& forces,
    const mechanics::NodalState& state, double dt, const mechanics::BoundaryConditions& boundary) {
  const auto surface_to_node = _surface_to_node;
  const auto acceleration = _accelerations;
  const auto motion =
      nodalMotion(forces.values, state.mass, boundary.motion(), forces.quantum.value, boundary);
  const auto velocity = state.velocity;
  Kokkos::parallel_for(
      "coupling::accelerations", rangePolicy(space, list.count),
      KOKKOS_LAMBDA(const std::int64_t i) {
        const int at = list(i), node = surface_to_node(at);
        for (int d = 0; d < 3; ++d)
          acceleration(at, d) = motion.acceleration(node, d, velocity(node, d), dt);
      });
  return _accelerations;
}

} // namespace brickwall::miniapp
