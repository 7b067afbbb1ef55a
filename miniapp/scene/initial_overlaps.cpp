#include "miniapp/scene/initial_overlaps.hpp"

#include "contact/base/mpi.hpp"
#include "contact/base/to_device.hpp"
#include "contact/overlap/box_pairs.hpp"
#include "contact/overlap/initial_overlap.hpp"
#include "miniapp/scene/entity_names.hpp"

#include <algorithm>
#include <sstream>

namespace brickwall::miniapp {

namespace {

std::string advice(double reach) {
  std::ostringstream message;
  message << "; expected no more than " << reach
          << ", 2 contact.tolerance times the shortest edge, the depth that contact can resolve. "
             "Move the bodies apart, or raise contact.tolerance: contact then acts on further "
             "penetration only";
  return message.str();
}

std::string describe(const EntityNames& names, const Config& config,
                     const contact::InitialOverlap& overlap) {
  std::ostringstream message;
  message << "bodies overlap at the start: " << names.node(overlap.node) << " of "
          << bodyName(config, overlap.node_body) << " is " << overlap.depth << " deep in "
          << bodyName(config, overlap.face_body) << ", behind " << names.face(overlap.face);
  return message.str();
}

std::string describe(const EntityNames& names, const Config& config,
                     const contact::ElementOverlap& overlap) {
  std::ostringstream message;
  message << "bodies overlap at the start: " << names.element(overlap.element) << " of "
          << bodyName(config, overlap.body) << ", centre (" << overlap.centre.x << ", "
          << overlap.centre.y << ", " << overlap.centre.z << "), and "
          << names.element(overlap.other) << " of " << bodyName(config, overlap.other_body)
          << " overlap by " << overlap.depth;
  return message.str();
}

// This rank's elements of the bodies in `bodies`, ascending.
contact::BodyElements elementsOf(const exec_space& space, const mechanics::HexMesh& mesh,
                                 const View<const double* [3]>& displacement,
                                 const std::vector<global_id>& bodies) {
  std::vector<int> elems;
  std::vector<global_id> elem_bodies;
  for (const mechanics::ElementRange& range : mesh.bodies)
    if (std::binary_search(bodies.begin(), bodies.end(), range.body))
      for (int elem = range.first; elem < range.first + range.count; ++elem) {
        elems.push_back(elem);
        elem_bodies.push_back(range.body);
      }
  const auto chosen = toDevice<View<int*>>(space, "miniapp::refuseDeepOverlaps::elements", elems);
  const auto hexahedra = allocate<View<contact::Hexahedron*>>(
      space, "miniapp::refuseDeepOverlaps::hexahedra", elems.size());
  const auto ids =
      allocate<View<global_id*>>(space, "miniapp::refuseDeepOverlaps::ids", elems.size());
  const mechanics::MeshViews views = mechanics::viewsOf(mesh);
  Kokkos::parallel_for(
      "miniapp::refuseDeepOverlaps::elements",
      rangePolicy(space, static_cast<std::int64_t>(elems.size())),
      KOKKOS_LAMBDA(const std::int64_t i) {
        const int elem = chosen(i);
        ids(i) = views.elem_ids(elem);
        for (int corner = 0; corner < 8; ++corner) {
          const int node = views.elem_to_nodes(elem, corner);
          hexahedra(i).corner[corner] =
              rowOf(views.reference_coordinates, node) + rowOf(displacement, node);
        }
      });
  contact::BodyElements elements;
  elements.count = static_cast<int>(elems.size());
  elements.hexahedra = hexahedra;
  elements.ids = ids;
  elements.bodies =
      toDevice<View<global_id*>>(space, "miniapp::refuseDeepOverlaps::bodies", elem_bodies);
  return elements;
}

} // namespace

void refuseDeepOverlaps(const exec_space& space, MPI_Comm comm, const Config& config,
                        const Scene& scene, const contact::Surface& surface,
                        const View<const double* [3]>& displacement) {
  const double reach = deepestActivation(config.contact, scene.shortest_edge);
  const auto bodies = contact::bodiesThatMeet(space, comm, surface, reach);
  if (!allReduce(comm, static_cast<int>(!bodies.empty()), MPI_MAX))
    return;
  const contact::InitialOverlap of_nodes =
      contact::deepestOverlap(space, comm, surface, 0.5 * scene.longest_edge);
  if (of_nodes.depth > reach)
    throw InputError(describe(EntityNames(comm, scene.part), config, of_nodes) + advice(reach));
  const contact::ElementOverlap of_elements = contact::deepestElementOverlap(
      space, comm, elementsOf(space, scene.mesh, displacement, bodies), reach);
  if (of_elements.depth > 0)
    throw InputError(describe(EntityNames(comm, scene.part), config, of_elements) + advice(reach));
}

} // namespace brickwall::miniapp
