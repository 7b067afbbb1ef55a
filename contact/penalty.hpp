// Contact enforcement: penalty forces on nodes that penetrate faces (shared/physics.md, section 4)
// and, as an option, their energy-neutral first and last steps (shared/contact_energy.md, steps 1
// to 8). Every owned node is tested against every candidate face, so both sides of a joint are
// nodes and faces in turn (two passes).
#pragma once

#include "contact/contact_history.hpp"
#include "contact/face_access.hpp"
#include "contact/node_faces.hpp"

#include <functional>
#include <string>

namespace brickwall::contact {

enum class Scheme {
  penalty, // F = k p, k of the birth
  energy_neutral, // first and last step of a contact weighted so that no energy is made
};

struct EnforcementConfig {
  Scheme scheme = Scheme::penalty;
  double penalty = 0.5; // s: k = min(eps A, s m_red/dt_ref^2); stable if s <= 1.95 (1 - chi^2)
  double reference_step = 0; // dt_ref >= every dt, time; fixes k whatever dt does
  double lateral_tolerance = 0.05; // tol: |xi|, |eta| <= 1 + tol is on the face
  double opposed_cosine = 0.35; // a face of the node opposes the candidate if n_k . n_F < -this
  double shared_cosine = 0.8; // interactions whose normals are closer than this cosine share A_i
  bool self_contact = false; // also faces of the node's own body (those that do not touch the node)
  int corrections = 2; // rounds of the energy-neutral correction
};

// Contact forces in quanta. Partial sums: the caller returns ghost_corners to their owners
// (returnToOwners) and sums over the ranks that share a node.
struct ContactForces {
  View<std::int64_t* [3]> nodes; // [surface node][xyz]
  View<std::int64_t* [12]> ghost_corners; // [ghost face][3 * corner + xyz]; rows [0, ghosts.count)
};

// This rank's sums over its interactions; sumOverRanks adds those of all ranks.
struct ContactSums {
  LimbSums<1> stored; // sum of k p^n p^{n+1}/2: the contact term of the half-step energy gauge
  std::int64_t interactions = 0; // nodes in touch with a body, with or without a force
  std::int64_t active = 0; // interactions with a force
  // Loaded interactions whose face is no longer a candidate: deeper than the search reaches.
  std::int64_t lost = 0;
  std::int64_t overflow = 0; // interactions beyond max_interactions of a node
  std::int64_t invalid = 0; // forces that are not finite or too large for the quantum
  double max_penetration = 0; // largest penetration / sqrt(face area)

  KOKKOS_INLINE_FUNCTION ContactSums& operator+=(const ContactSums& b) {
    stored += b.stored;
    interactions += b.interactions;
    active += b.active;
    lost += b.lost;
    overflow += b.overflow;
    invalid += b.invalid;
    max_penetration = maxOf(max_penetration, b.max_penetration);
    return *this;
  }
  // What a run must not go on with, in words; empty if nothing.
  std::string problem() const;
  // Of these, those that make the step's forces wrong; lost contacts are not among them, a run may go on with a warning.
  std::int64_t failures() const { return overflow + invalid + stored.invalid; }
};
// Collective.
void sumOverRanks(MPI_Comm comm, ContactSums& sums);

// What the energy-neutral scheme needs of the host code besides.
struct NeutralInput {
  // Acceleration by all other forces at x^{n+1}, gravity included, 0 where prescribed [surface node][xyz].
  View<const double* [3]> acceleration;
  // Collective. Turns partial sums into totals at every copy of a node: returnToOwners, then the
  // shared-node sum.
  std::function<void(const ContactForces&)> sum_forces;
  // Collective. ghost_values(ghost, 3 * corner + xyz) = the owner's values(its surface node, xyz).
  std::function<void(const View<const double* [3]>& values, const View<double* [12]>& ghost_values)>
      share_with_ghosts;
};

class Enforcement {
public:
  // Collective. `node_mass` [surface node] is the lumped mass, HUGE_VAL where the motion is
  // prescribed; corner masses of Surface::face_attributes [0..3] likewise, [4] is mu = rho h_n/2.
  // `energy_scale` bounds a stored energy.
  Enforcement(const exec_space& space, MPI_Comm comm, const Surface& surface,
              const View<const double*>& node_mass, const EnforcementConfig& config,
              const Quantum& quantum, const LimbScale& energy_scale);

  // Contact forces at coordinates_new; motion of the step is coordinates_new - coordinates_old, of
  // length dt. `surface` may change its coordinates between calls, nothing else. The first call of
  // a run sees overlaps as they are: they are taken into the offset and give no force. Collective.
  // `neutral` is needed for Scheme::energy_neutral only. Returns this rank's sums.
  ContactSums enforce(const exec_space& space, const Surface& surface, const GhostFaces& ghosts,
                      const CandidatePairs& pairs, double dt,
                      const NeutralInput* neutral = nullptr);

  // Of the last enforce().
  const ContactForces& forces() const { return _forces; }
  // [surface node] interactions of the node; 0 if not owned.
  const View<unsigned char*>& status() const { return _status; }
  // [surface node] least gap, length: minus the deepest penetration, or 0.
  const View<double*>& gap() const { return _gap; }

  // The interactions, for the next call.
  const ContactHistory& history() const { return _history; }

private:
  void updatePlanes(const exec_space& space, const FaceAccess& faces);
  ContactSums selectInteractions(const exec_space& space, const FaceAccess& faces,
                                 const CandidatePairs& pairs, double dt);
  std::int64_t makeNeutral(const exec_space& space, const FaceAccess& faces, double dt,
                           const NeutralInput* neutral);

  EnforcementConfig _config;
  Quantum _quantum;
  LimbScale _energy_scale;
  View<const double*> _node_mass;
  NodeFaces _node_faces;
  View<MeanPlane*> _planes; // own, remote, ghost faces
  ContactHistory _history, _next; // of the last step and of the present one, in turn
  View<std::int64_t> _next_count;
  double _previous_dt = 0;
  ContactForces _forces;
  View<unsigned char*> _status;
  View<double*> _gap;
  View<double* [3]> _accelerations;
  View<double* [12]> _ghost_accelerations;
};

// Adds what returnToOwners brought, [own face][3 * corner + xyz] in quanta, to the nodes.
void addFaceForces(const exec_space& space, const Surface& surface,
                   const View<const std::int64_t* [12]>& own_face_forces,
                   const View<std::int64_t* [3]>& node_forces);

} // namespace brickwall::contact
