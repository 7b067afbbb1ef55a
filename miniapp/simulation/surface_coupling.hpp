// Joins the volume mesh and the contact surface: coordinates and masses go to the surface, contact forces come back.
#pragma once

#include "contact/enforcement/enforcement.hpp"
#include "contact/search/candidate_search.hpp"
#include "contact/surface/surface.hpp"
#include "mechanics/loads/boundary_conditions.hpp"
#include "mechanics/mesh/nodal_state.hpp"
#include "miniapp/scene/scene.hpp"

namespace brickwall::miniapp {

class SurfaceCoupling {
public:
  // Nodes whose three components are all prescribed count as infinitely heavy in contact.
  SurfaceCoupling(const exec_space& space, const Scene& scene,
                  const mechanics::BoundaryConditions& boundary);

  // x^n := x^{n+1}, then x^{n+1} := X + u at the surface nodes.
  void gatherCoordinates(const exec_space& space, const View<const double* [3]>& displacement);
  // x^{n+1} := X + u alone: the drift was made anew.
  void gatherAgain(const exec_space& space, const View<const double* [3]>& displacement);
  // Faces' edges without coplanar neighbours (contact::findFeatureEdges), by bits.
  void setTrueEdges(const exec_space& space, const std::vector<unsigned char>& true_edges);
  // Both configurations at X + u: for the start.
  void resetCoordinates(const exec_space& space, const View<const double* [3]>& displacement);

  // Its coordinates change with gatherCoordinates(), the rest never.
  contact::Surface surface() const;
  const View<const double*>& nodeMass() const { return _node_mass; } // [surface node]

  // Turns this rank's partial contact forces into totals, the same on every rank that has the node: those on ghosts go
  // back to their owners, then shared nodes are summed. Collective.
  void sumContactForces(const exec_space& space, const contact::ContactForces& forces,
                        contact::CandidateSearch& search, mechanics::SharedNodeSum& shared);
  // The totals that sumContactForces() made of them, as contact_force columns; of the listed surface nodes.
  void storeContactForces(const exec_space& space, const contact::NodeList& list,
                          const contact::ContactForces& forces,
                          const mechanics::NodalForces& target) const;

  // Accelerations of the listed surface nodes by all forces in `forces` (totals), gravity and damping in the kick over `dt` to
  // come; 0 where prescribed.
  const View<double* [3]>& accelerations(const exec_space& space, const contact::NodeList& list,
                                         const mechanics::NodalForces& forces,
                                         const mechanics::NodalState& state, double dt,
                                         const mechanics::BoundaryConditions& boundary);

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
  View<double**> _attributes; // [face] 4 corner masses, mu, true edges
  View<std::int64_t**> _contact_forces; // [mesh node][xyz] quanta
  View<double* [3]> _accelerations; // [surface node][xyz]
};

} // namespace brickwall::miniapp
