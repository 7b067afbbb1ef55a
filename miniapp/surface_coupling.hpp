// Joins the volume mesh and the contact surface: coordinates and masses go to the surface, contact forces come back.
#pragma once

#include "contact/global_search.hpp"
#include "contact/penalty.hpp"
#include "contact/surface.hpp"
#include "mechanics/boundary_conditions.hpp"
#include "mechanics/nodal_state.hpp"
#include "miniapp/scene.hpp"

namespace brickwall::miniapp {

class SurfaceCoupling {
public:
  // Nodes whose three components are all prescribed count as infinitely heavy in contact.
  SurfaceCoupling(const exec_space& space, const Scene& scene,
                  const mechanics::BoundaryConditions& boundary);

  // x^n := x^{n+1}, then x^{n+1} := X + u at the surface nodes.
  void gatherCoordinates(const exec_space& space, const View<const double* [3]>& displacement);
  // Both configurations at X + u: for the start.
  void resetCoordinates(const exec_space& space, const View<const double* [3]>& displacement);

  // Its coordinates change with gatherCoordinates(), the rest never.
  contact::Surface surface() const;
  const View<const double*>& nodeMass() const { return _node_mass; } // [surface node]

  // Adds this rank's contact forces, after those on ghosts have gone back to their owners, to the contact_force
  // columns. Collective.
  void addContactForces(const exec_space& space, const contact::ContactForces& forces,
                        contact::GlobalSearch& search, const mechanics::NodalForces& target);

  // Set-up, public only for their kernels: static data of nodes and faces.
  void fillNodes(const exec_space& space, const Scene& scene,
                 const mechanics::BoundaryConditions& boundary);
  void fillFaces(const exec_space& space, const Scene& scene);

private:
  int _num_nodes = 0, _num_faces = 0;
  View<const int*> _surface_to_node;
  View<const int* [4]> _face_to_nodes; // mesh-local nodes
  View<const int* [4]> _face_to_surface_nodes; // surface nodes
  View<const double* [3]> _reference; // X [mesh node][xyz]
  View<double*[3]> _old, _new;
  View<const global_id*> _face_ids;
  View<global_id*> _node_ids, _node_body, _face_body;
  View<unsigned char*> _node_is_owned;
  View<const double*> _node_mass;
  View<double**> _attributes; // [face] 4 corner masses, mu
  View<std::int64_t* [12]> _corner_forces; // [face] returned from ghosts, quanta
};

} // namespace brickwall::miniapp
