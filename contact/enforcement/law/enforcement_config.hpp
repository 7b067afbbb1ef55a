// Parameters of contact enforcement.
#pragma once

#include <cmath>

namespace brickwall::contact {

enum class Scheme {
  penalty, // F = k p
  energy_neutral, // first and last step of a contact corrected so that no energy is created
};

// Times of the drifts before and after the forces; the kick between them has their mean length.
struct StepLengths {
  double dt; // of the motion coordinates_new - coordinates_old
  double next_dt;
  StepLengths(double dt_before, double dt_after) : dt(dt_before), next_dt(dt_after) {}
  StepLengths(double both) : StepLengths(both, both) {} // steps of equal length
};

struct EnforcementConfig {
  Scheme scheme = Scheme::energy_neutral;
  // s: k = min(eps A, s m_red/dt_ref^2), eqs. (11) and (12) of theory.md. Contact takes up to s/4
  // of the mass of surface nodes, times 2.05, or 2.55 with edge-to-edge contact: the step must be
  // stable for the rest.
  double penalty = 0.9;
  // dt_ref >= every dt, time; sets k independently of dt
  double reference_step = 0;
  // |xi|, |eta| <= 1 + this is on the face, in half-lengths
  double lateral_tolerance = 0.05;
  // the same beyond true edges, where the force fades out (edge_fading.hpp)
  double edge_tolerance = 0.1;
  // mu, Coulomb
  double friction = 0;
  // k_t/k; up to 1 it needs no smaller step, since the spring is perpendicular to the normal one
  double friction_stiffness = 1;
  // zeta: F_d = 2 zeta sqrt(k m) times the closing velocity, eq. (14); F + F_d >= 0
  double damping = 0;
  // smallest penetration of a contact, length; above the rounding of coordinates
  double least_depth = 0;
  // largest penetration of a node at activation beyond the approach of that step, length
  double max_activation_depth = HUGE_VAL;
  // a face of the node opposes the candidate if n_k . n_F < -this; eq. (8)
  double opposed_cosine = 0.35;
  // contacts of a node whose normals are closer than this cosine share A_i
  double shared_cosine = 0.8;
  // also faces of the node's own body, except those that contain the node
  bool self_contact = false;
  // skip pairs that have not moved (stationary_nodes.hpp); the bits do not depend on it
  bool skip_stationary = true;
  // rounds of the energy-neutral correction
  int corrections = 3;
};

} // namespace brickwall::contact
