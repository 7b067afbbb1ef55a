// Connects the volume mesh and the contact surface: coordinates and masses go to the surface,
// contact forces come back. The surface is that of this rank's elements (primary), or one whose
// faces are on other ranks (contact::SecondarySurface).
#pragma once

#include "contact/enforcement/enforcement.hpp"
#include "contact/search/candidate_search.hpp"
#include "contact/surface/features/feature_edges.hpp"
#include "contact/surface/secondary_surface.hpp"
#include "mechanics/loads/boundary_conditions.hpp"
#include "mechanics/mesh/nodal_state.hpp"
#include "miniapp/scene/scene.hpp"

#include <memory>
#include <string>
#include <vector>

namespace brickwall::miniapp {

class SurfaceCoupling {
public:
  // Nodes whose three components are all prescribed have infinite mass in contact.
  SurfaceCoupling(const exec_space& space, MPI_Comm comm, const Scene& scene,
                  const mechanics::BoundaryConditions& boundary);

  // From now on primary face f is on rank_of_face[f]; empty on all ranks: on the rank of its
  // element. Coordinates are undefined until resetCoordinates(). Returns the rank that then owns
  // each node, [node of the former surface]. Collective.
  std::vector<int> distribute(const exec_space& space, const Communicator& comm,
                              const std::vector<int>& rank_of_face);
  // That of this rank's elements.
  const contact::Surface& primary() const { return _primary; } // without coordinates
  View<const double* [3]> primaryCoordinates() const { return _new; } // x^{n+1}

  // x^n := x^{n+1}, then x^{n+1} := X + u at the surface nodes.
  void gatherCoordinates(const exec_space& space, const View<const double* [3]>& displacement);
  // x^{n+1} := X + u only, after a drift that was repeated.
  void gatherAgain(const exec_space& space, const View<const double* [3]>& displacement);
  // Those of the primary surface, before any distribution.
  void setFeatureEdges(const exec_space& space, contact::FeatureEdges features);
  const contact::FeatureEdges& featureEdges() const { return _features; } // of surface()
  // Both configurations at X + u, at the start.
  void resetCoordinates(const exec_space& space, const View<const double* [3]>& displacement);

  // Only its coordinates change, with gatherCoordinates().
  contact::Surface surface() const;
  // [surface node]
  View<const double*> nodeMass() const { return _secondary ? _secondary->node_mass : _node_mass; }

  // Adds up `values` [surface node][W] over the ranks that share a node: the totals [primary
  // node][W]. `values` are overwritten. Collective.
  View<std::int64_t**> sumOnPrimary(const exec_space& space, const View<std::int64_t**>& values);
  // Values [surface node][W], equal on all ranks that share a node, at primary nodes, and the way
  // back. They may be the same View. Collective.
  template <class ViewType>
  ViewType toPrimary(const exec_space& space, const ViewType& values) {
    if (!_secondary)
      return values;
    const auto of_primary =
        rowsLike(values, "miniapp::SurfaceCoupling::of_primary", _primary.num_nodes);
    _secondary->surface.giveBack(space, values, of_primary);
    return of_primary;
  }
  template <class ViewType>
  ViewType fromPrimary(const exec_space& space, const ViewType& of_primary) {
    return fromPrimary(space, of_primary, _secondary.get());
  }
  // Adds up `values` [surface node][W] over the ranks that share a node: the totals [mesh node][W].
  // `values` are overwritten. Collective.
  void sumOnMesh(const exec_space& space, const View<std::int64_t**>& values,
                 mechanics::SharedNodeSum& shared, const View<std::int64_t**>& of_mesh);
  // The way back: values [mesh node][W], equal on all ranks that share a node, to [surface
  // node][W]. Collective.
  void takeFromMesh(const exec_space& space, const View<const std::int64_t**>& of_mesh,
                    const View<std::int64_t**>& values);

  // Turns this rank's partial contact forces into totals, which are equal on all ranks that share a
  // node: forces on ghosts are summed at their owners, then shared nodes are summed. Collective.
  void sumContactForces(const exec_space& space, const contact::ContactForces& forces,
                        contact::CandidateSearch& search);
  // Values of nodes at the corners of ghosts. Collective.
  void shareWithGhosts(const exec_space& space, contact::CandidateSearch& search,
                       const View<const double* [3]>& values,
                       const View<double* [12]>& ghost_values);
  // From now on sumContactForces() and shareWithGhosts() exchange what the contacts of this step
  // need: the ghosts in use and the shared nodes that any rank lists. On a device they exchange all
  // ghosts and shared nodes, which takes less time than selecting them, unless faces are on other
  // ranks than their elements. Adds to the list, which has the nodes of this rank's contacts, those
  // to which sumContactForces() adds forces of other ranks, and corners of ghosts. Collective.
  void shareListed(const exec_space& space, contact::CandidateSearch& search,
                   const contact::GhostsInUse& ghosts_in_use, contact::TouchedNodes& list);
  // Stores the totals of sumContactForces(), which are zero at nodes that are not listed, in the
  // columns contact_force: at the listed surface nodes, or at all if storesAllNext(). Collective.
  void storeContactForces(const exec_space& space, const contact::NodeList& list,
                          const contact::ContactForces& forces,
                          const mechanics::NodalForces& target);
  // Whether the next storeContactForces() will be for all nodes, as the last one was: it then
  // replaces the columns, which need not be zeroed between them.
  bool storesAllNext() const { return _has_stored_all && !_secondary; }

  // Accelerations of the listed surface nodes in the next kick, of length `dt`, by all forces in
  // `forces` (totals), gravity and damping; 0 where prescribed.
  const View<double* [3]>& accelerations(const exec_space& space, const contact::NodeList& list,
                                         const mechanics::NodalForces& forces,
                                         const mechanics::NodalState& state, double dt,
                                         const mechanics::BoundaryConditions& boundary);

private:
  std::vector<char> sharedNodes(const exec_space& space);
  contact::SurfaceTransfer& shared() {
    return _secondary ? _secondary->surface.shared() : _shared_nodes;
  }
  template <class ViewType>
  static auto rowsLike(const ViewType& view, const std::string& label, int num_rows) {
    if constexpr (ViewType::rank_dynamic == 2)
      return typename ViewType::non_const_type(label, num_rows, view.extent(1));
    else
      return typename ViewType::non_const_type(label, num_rows);
  }

  // The surface in another decomposition, with its own nodes.
  struct Secondary {
    contact::SecondarySurface surface;
    View<double*[3]> x_old, x_new, accelerations; // [node][xyz]
    View<double*> node_mass; // [node]
    View<std::int64_t* [3]> forces; // [primary surface node][xyz], quanta
    View<unsigned char*> is_listed; // [primary surface node]
  };
  // Of a given decomposition, or (null) of the primary one.
  template <class ViewType>
  static ViewType fromPrimary(const exec_space& space, const ViewType& of_primary,
                              Secondary* secondary) {
    if (secondary == nullptr)
      return of_primary;
    const auto values = rowsLike(of_primary, "miniapp::SurfaceCoupling::of_secondary",
                                 secondary->surface.surface().num_nodes);
    secondary->surface.forward(space, of_primary, values);
    return values;
  }

  contact::Surface _primary; // all but the coordinates
  bool _has_stored_all = false; // see storesAllNext()
  View<const int*> _surface_to_node; // of the primary surface, as all below
  View<const double* [3]> _reference; // X [mesh node][xyz], length
  View<double*[3]> _old, _new; // x^n and x^{n+1} [surface node][xyz], length
  View<const double*> _node_mass; // [surface node]
  contact::AttributeWords _attributes; // contact::FaceAttributes of each face
  View<double* [3]> _accelerations; // [surface node][xyz]
  contact::FeatureEdges _primary_features, _features;
  std::vector<char> _is_shared; // [primary node] other ranks have it; empty before a distribution
  contact::SurfaceTransfer _shared_nodes; // of the surface
  View<unsigned char*> _is_listed; // [node of surface()]
  bool _shares_listed = false; // shareListed() has selected since the last distribution
  std::unique_ptr<Secondary> _secondary; // null: the surface is the primary one
};

} // namespace brickwall::miniapp
