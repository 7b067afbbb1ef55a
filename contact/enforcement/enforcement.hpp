// Contact enforcement by penalty forces on nodes that penetrate faces. Options: energy-neutral
// first and last steps of a contact (energy_neutral.hpp), Coulomb friction, damping, and
// edge-to-edge contact (edge_contact.hpp). Every owned node is tested against every candidate face,
// so both sides of an interface are nodes and faces in turn (two passes). Equations and sources:
// contact/theory.md.
//
// A contact becomes active when a node penetrates a face. The part of the penetration that this
// step's motion did not cause is stored as the offset e; the spring acts on p = P - e. When the
// node moves to another face of the body, e is chosen so that p continues with the approach of this
// step; in the energy-neutral scheme e also follows the work done on the spring
// (contact_law.hpp). Otherwise e never grows while the face stays the same.
#pragma once

#include "contact/enforcement/node_face/face_records.hpp"
#include "contact/enforcement/node_face/joint_records.hpp"
#include "contact/enforcement/selection/interaction_set.hpp"
#include "contact/enforcement/selection/neutral_input.hpp"
#include "contact/enforcement/selection/touched_nodes.hpp"

#include <mpi.h>

#include <cstdint>
#include <functional>
#include <string>

namespace brickwall::contact {

class EdgeContact;
struct NodeFaceKinematics;

// This rank's sums, separately for node-to-face and edge-to-edge contact.
struct EnforcementSums {
  ContactSums nodes, edges;

  // See ContactSums.
  std::int64_t failures() const { return nodes.failures() + edges.failures(); }
  std::int64_t active() const { return nodes.active + edges.active; }
  std::int64_t lost() const { return nodes.lost + edges.lost; }
  double maxPenetration() const { return maxOf(nodes.max_penetration, edges.max_penetration); }
};

class Enforcement {
public:
  // Collective; `comm` is copied, so that no message meets one of the host's. `node_mass`
  // [surface node] is the lumped mass, HUGE_VAL where the motion is prescribed; the face
  // attributes of `surface` are FaceAttributes, with the same corner masses. `energy_scale` bounds
  // a stored energy. Throws InputError on all ranks for what checkEnforcementInput() refuses.
  Enforcement(const exec_space& space, MPI_Comm comm, const Surface& surface,
              const View<const double*>& node_mass, const EnforcementConfig& config,
              const Quantum& quantum, const LimbScale& energy_scale);

  // Launches what enforce() will read first of this surface, which stays so until then. May be left
  // out: the host then waits once more. Returns SurfaceMotion::stationaryNodes(), which saves work
  // in CandidateSearch::update() and EdgeContact::gatherCoordinates(); empty if they are not used.
  View<const unsigned char*> startMotion(const exec_space& space, const Surface& surface) {
    if (!_config.skip_stationary)
      return {};
    _motion.start(space, surface);
    return _motion.stationaryNodes();
  }

  // Computes the contact forces at coordinates_new. The motion of the step is coordinates_new -
  // coordinates_old, over the time `steps.dt`. Between calls only the coordinates of `surface` may
  // change. Overlaps that exist at the first call become offsets and give no force; then joints of
  // flush bodies are found, with `neutral`, which is needed for Scheme::energy_neutral only. If
  // `edges` is given, it must have found the candidates of this step; its forces are included in
  // forces(). Collective. Returns this rank's sums. Throws InputError on all ranks for a surface of
  // other counts, or candidates of another surface.
  EnforcementSums enforce(const exec_space& space, const Surface& surface, const GhostFaces& ghosts,
                          const CandidatePairs& pairs, const StepLengths& steps,
                          const NeutralInput* neutral = nullptr, EdgeContact* edges = nullptr);
  // Adds the failures of corrections to the sums of an enforce() with NeutralInput::completes_sums.
  // Waits for the device. Does nothing if they are complete.
  void completeSums(const exec_space& space, EdgeContact* edges, EnforcementSums& sums);

  // dt_ref must be >= every later time step. It sets the stiffness of contacts that become active
  // later; active contacts are never stiffened, so that no energy is created.
  void setReferenceStep(double dt) { _set.setReferenceStep(dt); }

  // Forces of the last enforce(). Unless they are totals at every copy of a node, by
  // NeutralInput::sum_forces, they are partial sums: the caller returns ghost_corners to their
  // owners (reverseSum) and sums over the ranks that share a node.
  const ContactForces& forces() const { return _forces; }
  bool hasTotals() const { return _has_totals; }
  // Whether any rank had contact forces in the last enforce(). If not, forces() are zero on all
  // ranks and need no sums.
  bool hasForces() const { return _has_forces; }
  // The nodes where forces() may differ from 0, also after sums over ranks.
  const NodeList& touched() const { return _touched.list(); }
  // [surface node] number of sides of bodies that the node penetrates, loaded or not; 0 if not
  // owned.
  const View<int*>& status() const { return _status; }
  // [surface node] least gap, length: minus the largest penetration, or 0.
  const View<double*>& gap() const { return _gap; }

  // Dormant rows of candidates.
  const SleepingBlocks& sleeping() const { return _idle.sleeping(); }
  // The contact history, for the next call.
  const ContactHistory& history() const { return _set.history(); }

  // Adds to work [surface node][1], WorkUnits, the work of the nodes that this rank owns in the
  // last step, in which `pairs` were its candidates.
  void addWork(const exec_space& space, const CandidatePairs& pairs,
               const View<std::int64_t**>& work) const;

  // What enforce() carries to the next step, for restart files; restore() takes the records of the
  // nodes that this rank owns, in any order, before the next enforce(). Not collective.
  ContactCarry carry(const exec_space& space, const Surface& surface) const {
    ContactCarry carry = _set.carry(space, surface.node_ids, _has_forces);
    carry.joints = recordsOf(space, surface.node_ids, _joints);
    return carry;
  }
  void restore(const exec_space& space, const Surface& surface, const ContactCarry& carry);

private:
  void collectForces(const exec_space& space, EdgeContact* edges);
  void findTouched(const exec_space& space, const FaceAccess& faces, const NeutralInput* neutral,
                   EdgeContact* edges);
  bool canSkipAll() const;
  NodeFaceKinematics kinematicsOf(const FaceAccess& faces) const;
  EnforcementSums select(const exec_space& space, const FaceAccess& faces,
                         const CandidatePairs& pairs, double dt, EdgeContact* edges);
  // The function returned waits for the device and completes the selection.
  std::function<ContactSums()> selectNodes(const exec_space& space, const FaceAccess& faces,
                                           const CandidatePairs& pairs, double dt);
  void correctEnergy(const exec_space& space, const FaceAccess& faces, const StepLengths& steps,
                     const NeutralInput* neutral, EdgeContact* edges, EnforcementSums& sums);

  // Collective.
  bool isOnAnyRank(bool here) const;
  bool mayHaveProposals(const exec_space& space, EdgeContact* edges);
  void agreeOnForces(const EnforcementSums& sums, EdgeContact* edges,
                     const std::string& problem = {});
  std::string problemOf(const Surface& surface, const CandidatePairs& pairs,
                        const NeutralInput* neutral) const;
  void throwWithAllRanks(const exec_space& space, const std::string& problem);

  Communicator _comm;
  int _num_nodes, _num_faces;
  EnforcementConfig _config;
  Quantum _quantum;
  View<const double*> _node_mass;
  NodeFaces _node_faces;
  FaceRecords _records;
  bool _has_sought_joints;
  JointAreas _joints;
  InteractionSet _set;
  SurfaceMotion _motion;
  IdleRows _idle;
  TouchedNodes _touched;
  ContactForces _forces; // the nodal forces are _totals or those of _set
  View<std::int64_t* [3]> _totals; // [surface node][xyz], quanta; 0 at nodes that are not listed
  bool _has_forces = false; // on any rank; otherwise _forces are zero
  bool _has_totals = false; // _forces are
  bool _has_status = false; // whether _status of any node differs from 0
  View<int*> _status;
  View<double*> _gap;
  View<double* [3]> _accelerations;
  // [surface node] its acceleration has changed since the last round
  View<unsigned char*> _has_changed;
  View<unsigned char*> _is_proposed; // [surface node] a change of its force is proposed
  View<unsigned char*> _ghost_in_use; // [ghost] it has an interaction in this step
  View<double* [12]> _ghost_accelerations;
  View<double* [3]> _responses; // to the proposed changes (correct_pair.hpp)
  View<double* [12]> _ghost_responses;
};

} // namespace brickwall::contact
