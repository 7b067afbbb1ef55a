// Contact enforcement: penalty forces on nodes that penetrate faces and, as options, energy-neutral first and last steps of a
// contact (energy_neutral.hpp), Coulomb friction, damping, and edges that cross edges (edge_contact.hpp). Every owned node is
// tested against every candidate face, so both sides of a joint are nodes and faces in turn (two passes).
//
// An interaction is born when a node is found inside a face of another body, with the offset e of that penetration which the
// step's motion did not bring; the spring then feels p = P - e. When the node moves to another face of the body, e is chosen so
// that p goes on by what the last force closed; in the energy-neutral scheme e also follows the work done on the spring
// (interaction_forces.hpp). Otherwise e never grows while the face stays the same.
#pragma once

#include "contact/enforcement/node_face/face_records.hpp"
#include "contact/enforcement/selection/interaction_set.hpp"
#include "contact/enforcement/selection/touched_nodes.hpp"

#include <mpi.h>

#include <functional>
#include <string>

namespace brickwall::contact {

// What the energy-neutral scheme needs of the host code besides.
struct NeutralInput {
  // Accelerations by all other forces at x^{n+1}, gravity included, 0 where prescribed [surface node][xyz]; of the listed nodes,
  // others are not looked at. Asked for once in steps with contact forces on any rank, never in others.
  std::function<View<const double* [3]>(const NodeList&)> accelerations;
  // Collective. Turns partial sums into totals at every copy of a node: reverseSum, then the
  // shared-node sum.
  std::function<void(const ContactForces&)> sum_forces;
  // Collective. ghost_values(ghost, 3 * corner + xyz) = the owner's values(its surface node, xyz).
  std::function<void(const View<const double* [3]>& values, const View<double* [12]>& ghost_values)>
      share_with_ghosts;
};

class EdgeContact;

// This rank's sums, apart for nodes with faces and edges with edges.
struct EnforcementSums {
  ContactSums nodes, edges;

  // As ContactSums.
  std::int64_t failures() const { return nodes.failures() + edges.failures(); }
  std::int64_t active() const { return nodes.active + edges.active; }
  std::int64_t lost() const { return nodes.lost + edges.lost; }
};

class Enforcement {
public:
  // Collective; `comm` is copied, so that no message meets one of the host's. `node_mass`
  // [surface node] is the lumped mass, HUGE_VAL where the motion is prescribed; corner masses of
  // Surface::face_attributes [0..3] likewise, [4] is mu = rho h_n/2. `energy_scale` bounds a stored
  // energy. Throws InputError on all ranks for what checkEnforcementInput() refuses.
  Enforcement(const exec_space& space, MPI_Comm comm, const Surface& surface,
              const View<const double*>& node_mass, const EnforcementConfig& config,
              const Quantum& quantum, const LimbScale& energy_scale);

  // Contact forces at coordinates_new; motion of the step is coordinates_new - coordinates_old, of
  // length `steps.dt`. `surface` may change its coordinates between calls, nothing else. The first
  // call of a run sees overlaps as they are: they are taken into the offset and give no force.
  // Collective. `neutral` is needed for Scheme::energy_neutral only; `edges`, if there, has found
  // the candidates of this step, and its forces are among forces(). Returns this rank's sums.
  // Throws InputError on all ranks for a surface of other counts, or candidates of another surface.
  EnforcementSums enforce(const exec_space& space, const Surface& surface, const GhostFaces& ghosts,
                          const CandidatePairs& pairs, const StepLengths& steps,
                          const NeutralInput* neutral = nullptr, EdgeContact* edges = nullptr);

  // dt_ref >= every dt to come. Contacts that are born from now on have the stiffness that goes with it; others are never
  // made stiffer, so that no energy is made.
  void setReferenceStep(double dt) { _set.setReferenceStep(dt); }

  // Of the last enforce(). Partial sums: the caller returns ghost_corners to their owners (reverseSum) and sums over the
  // ranks that share a node.
  const ContactForces& forces() const { return _forces; }
  // Whether any rank had contact forces in the last enforce(): if not, forces() are zero on all ranks and need no sums.
  bool hasForces() const { return _has_forces; }
  // The nodes where forces() may be other than 0: on a rank alone those that its contacts act on, on several ranks all.
  const NodeList& touched() const { return _touched.list(); }
  // [surface node] bodies that the node is inside of, under load or not; 0 if not owned.
  const View<unsigned char*>& status() const { return _status; }
  // [surface node] least gap, length: minus the deepest penetration, or 0.
  const View<double*>& gap() const { return _gap; }

  // Rows of candidates that need not be looked at.
  const SleepingBlocks& sleeping() const { return _sleeping; }
  // The interactions, for the next call.
  const ContactHistory& history() const { return _set.history(); }

  // A step of enforce(), public only for its kernel.
  void collectForces(const exec_space& space, EdgeContact* edges);
  void forgetTotals(const exec_space& space);

private:
  void findTouched(const exec_space& space, const FaceAccess& faces, EdgeContact* edges);
  void forgetStatus(const exec_space& space);
  bool leavesOutAll() const;
  ContactSums selectInteractions(const exec_space& space, const FaceAccess& faces,
                                 const CandidatePairs& pairs, double dt);
  void makeNeutral(const exec_space& space, const FaceAccess& faces, const StepLengths& steps,
                   const NeutralInput* neutral, EdgeContact* edges, EnforcementSums& sums);

  // Collective.
  bool isOnAnyRank(bool here) const;
  void agreeOnForces(const EnforcementSums& sums, EdgeContact* edges,
                     const std::string& problem = {});
  std::string problemOf(const Surface& surface, const CandidatePairs& pairs) const;
  void throwWithAllRanks(const exec_space& space, const std::string& problem);

  Communicator _comm;
  int _num_nodes, _num_faces;
  EnforcementConfig _config;
  Quantum _quantum;
  LimbScale _energy_scale;
  View<const double*> _node_mass;
  NodeFaces _node_faces;
  FaceRecords _records;
  InteractionSet _set;
  SurfaceMotion _motion;
  StationaryNodes _still;
  SleepingBlocks _sleeping;
  TouchedNodes _touched;
  ContactForces _forces; // its nodes: _totals, or those of _set
  View<std::int64_t* [3]> _totals; // [surface node][xyz], quanta; 0 where not touched
  bool _has_forces = false; // on any rank; else _forces are zero
  double _previous_dt = 0;
  bool _has_status = false; // of any node
  View<unsigned char*> _status;
  View<double*> _gap;
  View<double* [3]> _accelerations;
  View<unsigned char*> _has_changed; // [surface node] its acceleration, since the last round
  View<double* [12]> _ghost_accelerations;
};

} // namespace brickwall::contact
