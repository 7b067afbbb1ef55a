// What contact enforcement is told.
#pragma once

#include <cmath>

namespace brickwall::contact {

enum class Scheme {
  penalty, // F = k p, k of the birth
  energy_neutral, // first and last step of a contact weighted so that no energy is made
};

struct EnforcementConfig {
  Scheme scheme = Scheme::energy_neutral;
  // s: k = min(eps A, s m_red/dt_ref^2). It takes mult s/4 of the mass of surface nodes, mult 2.05, with crossing edges 2.55: the
  // step must be stable for what is left.
  double penalty = 0.9;
  double reference_step = 0; // dt_ref >= every dt, time; fixes k whatever dt does
  double lateral_tolerance = 0.05; // tol: |xi|, |eta| <= 1 + tol is on the face
  double edge_tolerance =
      0.1; // the same beyond true edges, where the force fades out (edge_fading.hpp)
  double friction = 0; // mu, Coulomb
  double friction_stiffness =
      1; // k_t/k; up to 1 it needs no smaller step: the spring acts across the normal one
  double damping =
      0; // zeta: F_d = 2 zeta sqrt(k m) times the closing speed, k = s m/dt_ref^2; F + F_d >= 0
  double least_depth = 0; // no contact is shallower, length: above the rounding of coordinates
  double deepest_birth =
      HUGE_VAL; // how deep a contact may be found, beyond the way of its first step, length
  double opposed_cosine = 0.35; // a face of the node opposes the candidate if n_k . n_F < -this
  double shared_cosine = 0.8; // interactions whose normals are closer than this cosine share A_i
  bool self_contact = false; // also faces of the node's own body (those that do not touch the node)
  bool skip_stationary =
      true; // what has not moved (stationary_nodes.hpp): the same bits either way
  int corrections = 3; // rounds of the energy-neutral correction
  // Of what a round after the first wants to change: contacts that share nodes answer each other, all at once, and overshoot.
  double relaxation = 0.7;
};

} // namespace brickwall::contact
