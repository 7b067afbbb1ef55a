#include "miniapp/simulation/surface_coupling.hpp"

#include "contact/base/to_device.hpp"
#include "mechanics/step/nodal_motion.hpp"

#include <utility>

namespace brickwall::miniapp {

namespace {

// Mass per area by which a face resists contact: rho h_n/2. The element's thickness h_n is the
// distance between the centres of the face and of the opposite side along the face's normal.
KOKKOS_INLINE_FUNCTION double surfaceMass(const Vec3 (&face)[4], const Vec3& element_centre,
                                          double density) {
  const Vec3 centre = 0.25 * (face[0] + face[1] + face[2] + face[3]);
  const Vec3 area = cross(face[2] - face[0], face[3] - face[1]);
  const double thickness = 2 * dot(centre - element_centre, area) / norm(area);
  return 0.5 * density * thickness;
}

// Lumped masses [surface node]; infinite where all components are prescribed.
View<double*> contactMass(const exec_space& space, const Scene& scene,
                          const mechanics::BoundaryConditions& boundary) {
  auto contact_mass =
      allocate<View<double*>>(space, "miniapp::SurfaceCoupling::node_mass", scene.skin.num_nodes);
  const auto surface_to_node = scene.skin.surface_to_node;
  const auto mass = scene.mass;
  const auto prescribed = boundary.motion();
  const bool any = boundary.any();
  Kokkos::parallel_for(
      "miniapp::SurfaceCoupling::contactMass", rangePolicy(space, scene.skin.num_nodes),
      KOKKOS_LAMBDA(const std::int64_t i) {
        const int node = surface_to_node(i);
        const bool held = any && prescribed(node, 0) && prescribed(node, 1) && prescribed(node, 2);
        contact_mass(i) = held ? HUGE_VAL : mass(node);
      });
  return contact_mass;
}

// The nodes of the surface that are so on other ranks too, by their numbers in it, [rank].
std::vector<std::vector<int>> sharedOnSurface(const Scene& scene, int num_ranks) {
  std::vector<std::vector<int>> shared(num_ranks);
  if (num_ranks == 1)
    return shared;
  std::vector<int> surface_of(scene.part.node_ids.size(), -1);
  const auto surface_to_node = toHost(scene.skin.surface_to_node);
  for (int i = 0; i < scene.skin.num_nodes; ++i)
    surface_of[surface_to_node(i)] = i;
  const mechanics::SharedNodeLists of_mesh = sharedNodes(scene.part);
  for (std::size_t p = 0; p < of_mesh.ranks.size(); ++p)
    for (const int node : of_mesh.nodes[p])
      if (surface_of[node] >= 0)
        shared[of_mesh.ranks[p]].push_back(surface_of[node]);
  return shared;
}

// [node] the body of each node of the mesh.
View<global_id*> bodiesOfNodes(const exec_space& space, const Scene& scene,
                               const View<const global_id*>& elem_body) {
  View<global_id*> bodies("miniapp::SurfaceCoupling::bodies_of_nodes", scene.mesh.num_nodes);
  const auto elem_to_nodes = scene.mesh.elem_to_nodes;
  Kokkos::parallel_for(
      "miniapp::SurfaceCoupling::bodiesOfNodes", rangePolicy(space, scene.mesh.num_elems),
      KOKKOS_LAMBDA(const std::int64_t elem) {
        for (int corner = 0; corner < 8; ++corner)
          storeShared(bodies(elem_to_nodes(elem, corner)), global_id(elem_body(elem)));
      });
  return bodies;
}

// Ids, ownership and bodies of surface nodes.
void fillNodes(const exec_space& space, const Scene& scene, const View<const global_id*>& elem_body,
               contact::Surface& surface) {
  const auto body_of_node = bodiesOfNodes(space, scene, elem_body);
  const int num_nodes = scene.skin.num_nodes;
  const auto ids =
      allocate<View<global_id*>>(space, "miniapp::SurfaceCoupling::node_ids", num_nodes);
  const auto body =
      allocate<View<global_id*>>(space, "miniapp::SurfaceCoupling::node_body", num_nodes);
  const auto is_owned =
      allocate<View<unsigned char*>>(space, "miniapp::SurfaceCoupling::node_is_owned", num_nodes);
  const auto surface_to_node = scene.skin.surface_to_node;
  const auto mesh_ids = scene.mesh.node_ids;
  const auto mesh_is_owned = scene.mesh.node_is_owned;
  Kokkos::parallel_for(
      "miniapp::SurfaceCoupling::fillNodes", rangePolicy(space, num_nodes),
      KOKKOS_LAMBDA(const std::int64_t i) {
        const int node = surface_to_node(i);
        ids(i) = mesh_ids(node);
        is_owned(i) = mesh_is_owned(node);
        body(i) = body_of_node(node);
      });
  space.fence();
  surface.num_nodes = num_nodes;
  surface.node_ids = ids;
  surface.node_body = body;
  surface.node_is_owned = is_owned;
}

// Ids, corners, bodies and attributes of faces; the attribute of true edges is set later.
void fillFaces(const exec_space& space, const Scene& scene, const View<const global_id*>& elem_body,
               const View<const double*>& node_mass, const contact::AttributeWords& attributes,
               contact::Surface& surface) {
  const auto body = allocate<View<global_id*>>(space, "miniapp::SurfaceCoupling::face_body",
                                               scene.skin.num_faces);
  const auto face_to_elem = scene.skin.face_to_elem;
  const auto face_to_nodes = scene.skin.face_to_nodes;
  const auto face_to_surface_nodes = scene.skin.face_to_surface_nodes;
  const auto elem_to_nodes = scene.mesh.elem_to_nodes;
  const auto elem_block = scene.mesh.elem_block;
  const auto materials = scene.mesh.materials;
  const auto X = scene.mesh.reference_coordinates;
  const auto shares = scene.mass_shares;
  Kokkos::parallel_for(
      "miniapp::SurfaceCoupling::fillFaces", rangePolicy(space, scene.skin.num_faces),
      KOKKOS_LAMBDA(const std::int64_t face) {
        const int elem = face_to_elem(face);
        Vec3 centre;
        for (int corner = 0; corner < 8; ++corner)
          centre += 0.125 * rowOf(X, elem_to_nodes(elem, corner));
        contact::FaceAttributes& values =
            contact::attributesAt<contact::FaceAttributes>(attributes, face);
        Vec3 corners[4];
        for (int corner = 0; corner < 4; ++corner) {
          corners[corner] = rowOf(X, face_to_nodes(face, corner));
          values.corner_mass[corner] = node_mass(face_to_surface_nodes(face, corner));
        }
        // With the least share of a body, the stiffness by area is below that by nodal masses on
        // all faces alike, so a uniform pressure stays uniform.
        values.surface_mass = (shares.size() > 0 ? shares(elem) : 1.0) *
                              surfaceMass(corners, centre, materials(elem_block(elem)).density);
        body(face) = elem_body(elem);
      });
  space.fence();
  surface.num_faces = scene.skin.num_faces;
  surface.face_ids = scene.skin.face_ids;
  surface.face_to_nodes = face_to_surface_nodes;
  surface.face_body = body;
  surface.face_attributes = attributes;
}

} // namespace

SurfaceCoupling::SurfaceCoupling(const exec_space& space, MPI_Comm comm, const Scene& scene,
                                 const mechanics::BoundaryConditions& boundary)
    : _surface_to_node(scene.skin.surface_to_node), _reference(scene.mesh.reference_coordinates),
      _old(allocate<View<double* [3]>>(space, "miniapp::SurfaceCoupling::x_old",
                                       scene.skin.num_nodes)),
      _new(allocate<View<double* [3]>>(space, "miniapp::SurfaceCoupling::x_new",
                                       scene.skin.num_nodes)),
      _node_mass(contactMass(space, scene, boundary)),
      _attributes(contact::allocateAttributes<contact::FaceAttributes>(
          space, "miniapp::SurfaceCoupling::face_attributes", scene.skin.num_faces)),
      _accelerations(allocate<View<double* [3]>>(space, "miniapp::SurfaceCoupling::accelerations",
                                                 scene.skin.num_nodes)),
      _is_listed("miniapp::SurfaceCoupling::is_listed", scene.skin.num_nodes) {
  const std::vector<std::vector<int>> shared = sharedOnSurface(scene, sizeOf(comm));
  _shared_nodes = contact::SurfaceTransfer(space, Communicator(comm), shared, shared);
  const auto elem_body = toDevice<View<global_id*>>(space, "miniapp::SurfaceCoupling::elem_body",
                                                    scene.part.elem_body);
  fillNodes(space, scene, elem_body, _primary);
  fillFaces(space, scene, elem_body, _node_mass, _attributes, _primary);
}

void SurfaceCoupling::setFeatureEdges(const exec_space& space, contact::FeatureEdges features) {
  _features = _primary_features = std::move(features);
  const auto masks = toDevice<View<unsigned char*>>(space, "miniapp::SurfaceCoupling::face_edges",
                                                    _features.face_edges);
  const auto sides =
      toDevice<View<int*>>(space, "miniapp::SurfaceCoupling::face_sides", _features.face_sides);
  const auto attributes = _attributes;
  const auto bodies = _primary.face_body;
  const auto bodies_and_sides =
      allocate<View<global_id*>>(space, "miniapp::SurfaceCoupling::face_body", _primary.num_faces);
  Kokkos::parallel_for(
      "miniapp::SurfaceCoupling::setFeatureEdges", rangePolicy(space, _primary.num_faces),
      KOKKOS_LAMBDA(const std::int64_t face) {
        contact::attributesAt<contact::FaceAttributes>(attributes, face).feature_edges =
            masks(face);
        bodies_and_sides(face) =
            contact::sideOfBody(contact::bodyOfSide(bodies(face)), sides(face));
      });
  _primary.face_body = bodies_and_sides;
}

void SurfaceCoupling::gatherCoordinates(const exec_space& space,
                                        const View<const double* [3]>& displacement) {
  std::swap(_old, _new);
  if (_secondary)
    std::swap(_secondary->x_old, _secondary->x_new);
  gatherAgain(space, displacement);
}

void SurfaceCoupling::gatherAgain(const exec_space& space,
                                  const View<const double* [3]>& displacement) {
  const auto surface_to_node = _surface_to_node;
  const auto X = _reference;
  const auto x = _new;
  Kokkos::parallel_for(
      "miniapp::SurfaceCoupling::gatherAgain", rangePolicy(space, _primary.num_nodes),
      KOKKOS_LAMBDA(const std::int64_t i) {
        const int node = surface_to_node(i);
        for (int d = 0; d < 3; ++d)
          x(i, d) = X(node, d) + displacement(node, d);
      });
  if (_secondary)
    _secondary->surface.forward(space, _new, _secondary->x_new);
}

void SurfaceCoupling::resetCoordinates(const exec_space& space,
                                       const View<const double* [3]>& displacement) {
  gatherCoordinates(space, displacement);
  Kokkos::deep_copy(space, _old, _new);
  if (_secondary)
    Kokkos::deep_copy(space, _secondary->x_old, _secondary->x_new);
}

contact::Surface SurfaceCoupling::surface() const {
  contact::Surface surface = _secondary ? _secondary->surface.surface() : _primary;
  surface.coordinates_old = _secondary ? _secondary->x_old : _old;
  surface.coordinates_new = _secondary ? _secondary->x_new : _new;
  return surface;
}

View<std::int64_t**> SurfaceCoupling::sumOnPrimary(const exec_space& space,
                                                   const View<std::int64_t**>& values) {
  shared().sumShared(space, values);
  return toPrimary(space, values);
}

void SurfaceCoupling::sumOnMesh(const exec_space& space, const View<std::int64_t**>& values,
                                mechanics::SharedNodeSum& shared,
                                const View<std::int64_t**>& of_mesh) {
  if (_secondary)
    _secondary->surface.sumShared(space, values);
  const View<std::int64_t**> of_primary = toPrimary(space, values);
  const auto surface_to_node = _surface_to_node;
  const auto width = static_cast<int>(values.extent(1));
  Kokkos::parallel_for(
      "miniapp::SurfaceCoupling::sumOnMesh", rangePolicy(space, _primary.num_nodes),
      KOKKOS_LAMBDA(const std::int64_t i) {
        for (int w = 0; w < width; ++w)
          of_mesh(surface_to_node(i), w) = of_primary(i, w);
      });
  if (!_secondary)
    shared.sum(space, of_mesh);
}

void SurfaceCoupling::takeFromMesh(const exec_space& space,
                                   const View<const std::int64_t**>& of_mesh,
                                   const View<std::int64_t**>& values) {
  View<std::int64_t**> of_primary = values;
  if (_secondary)
    of_primary = View<std::int64_t**>("miniapp::SurfaceCoupling::of_primary", _primary.num_nodes,
                                      values.extent(1));
  const auto surface_to_node = _surface_to_node;
  const auto width = static_cast<int>(values.extent(1));
  Kokkos::parallel_for(
      "miniapp::SurfaceCoupling::takeFromMesh", rangePolicy(space, _primary.num_nodes),
      KOKKOS_LAMBDA(const std::int64_t i) {
        for (int w = 0; w < width; ++w)
          of_primary(i, w) = of_mesh(surface_to_node(i), w);
      });
  if (_secondary)
    _secondary->surface.forward(space, of_primary, values);
}

void SurfaceCoupling::sumContactForces(const exec_space& space,
                                       const contact::ContactForces& forces,
                                       contact::CandidateSearch& search) {
  const auto corners = surface().face_to_nodes;
  if (_shares_listed) {
    search.reverseSumSelected(space, corners, forces.ghost_corners, forces.nodes);
    shared().sumSelected(space, forces.nodes);
  } else {
    search.reverseSum(space, corners, forces.ghost_corners, forces.nodes);
    shared().sumShared(space, forces.nodes);
  }
}

void SurfaceCoupling::shareWithGhosts(const exec_space& space, contact::CandidateSearch& search,
                                      const View<const double* [3]>& values,
                                      const View<double* [12]>& ghost_values) {
  if (_shares_listed)
    search.forwardSelected(space, surface(), values, ghost_values);
  else
    search.forward(space, surface(), values, ghost_values);
}

void SurfaceCoupling::shareListed(const exec_space& space, contact::CandidateSearch& search,
                                  const contact::GhostsInUse& ghosts_in_use,
                                  contact::TouchedNodes& list) {
  _shares_listed = fills_lanes || _secondary;
  if (!_shares_listed) {
    const contact::PartnerLists& sent = search.facesToSend();
    list.addCorners(space, sent.rows, sent.size(), surface().face_to_nodes);
    list.addNodes(space, shared().rows());
    return;
  }
  search.selectGhosts(space, ghosts_in_use());
  const contact::GhostSelection& selection = search.selection();
  list.addCorners(space, selection.faces(), selection.numFaces(), surface().face_to_nodes);
  contact::flagListed(space, list.list(), _is_listed);
  shared().selectShared(space, _is_listed);
  list.addNodes(space, shared().selectedRows());
  if (_secondary) // the list may have more nodes, which other copies of them do not know
    _secondary->surface.selectNodes(space, _is_listed, _secondary->is_listed);
}

void SurfaceCoupling::storeContactForces(const exec_space& space, const contact::NodeList& changed,
                                         const contact::ContactForces& forces,
                                         const mechanics::NodalForces& target) {
  View<const std::int64_t* [3]> totals = forces.nodes;
  contact::NodeList list = storesAllNext() ? contact::NodeList::allOf(_primary.num_nodes) : changed;
  _has_stored_all = !_secondary && changed.isAll();
  View<const unsigned char*> is_listed;
  if (_secondary) {
    _secondary->surface.giveBackSelected(space, totals, _secondary->forces);
    totals = _secondary->forces;
    list = contact::NodeList::allOf(_primary.num_nodes);
    is_listed = _secondary->is_listed;
  }
  const auto surface_to_node = _surface_to_node;
  const auto values = target.values;
  Kokkos::parallel_for(
      "miniapp::SurfaceCoupling::storeContactForces", rangePolicy(space, list.count),
      KOKKOS_LAMBDA(const std::int64_t i) {
        const int at = list(i);
        if (is_listed.extent(0) > 0 && !is_listed(at))
          return;
        for (int d = 0; d < 3; ++d)
          values(surface_to_node(at), 3 * mechanics::contact_force + d) = totals(at, d);
      });
}

const View<double* [3]>& SurfaceCoupling::accelerations(
    const exec_space& space, const contact::NodeList& needed, const mechanics::NodalForces& forces,
    const mechanics::NodalState& state, double dt, const mechanics::BoundaryConditions& boundary) {
  contact::NodeList list = needed;
  View<const unsigned char*> is_listed;
  if (_secondary) {
    list = contact::NodeList::allOf(_primary.num_nodes);
    is_listed = _secondary->is_listed;
  }
  const auto surface_to_node = _surface_to_node;
  const auto acceleration = _accelerations;
  const auto motion = nodalMotion(forces, forces.values, state.mass, boundary.motion(), boundary);
  const auto velocity = state.velocity;
  constexpr std::int64_t far = 24; // nodes ahead whose values are prefetched
  Kokkos::parallel_for(
      "miniapp::SurfaceCoupling::accelerations", rangePolicy(space, list.count),
      KOKKOS_LAMBDA(const std::int64_t i) {
        const int at = list(i), node = surface_to_node(at);
        if (is_listed.extent(0) > 0 && !is_listed(at))
          return;
        motion.prefetchOperands(surface_to_node(list(minOf(i + far, list.count - 1))));
        for (int d = 0; d < 3; ++d)
          acceleration(at, d) = motion.acceleration(node, d, velocity, dt);
      });
  if (!_secondary)
    return _accelerations;
  _secondary->surface.forwardSelected(space, _accelerations, _secondary->accelerations);
  return _secondary->accelerations;
}

} // namespace brickwall::miniapp
