// Persistent contacts: contacts whose face is still a candidate. Projections and relative motions
// are computed for many of them at once, in SIMD lanes; eqs. (5) to (7) of theory.md.
#pragma once

#include "contact/base/lane_arrays.hpp"
#include "contact/enforcement/law/contact_history.hpp"
#include "contact/surface/face_access.hpp"

namespace brickwall::contact {

// An interaction of the contact history whose face is still a candidate.
struct PersistentContact {
  int node; // node (or number of the edge) whose row this is
  int previous; // index of the interaction
  int face; // candidate index
  // motion of the pushing point with respect to the face point in this step, with the last
  // weights, length
  Vec3 last_motion;
  // Filled if Kinematics::projects_persistent_contacts:
  FacePoint point; // closest point at x^{n+1}
  Vec3 motion; // as last_motion, with the weights of `point`
  double inverse_mass; // 1/m_s + sum N_j^2/m_j with the weights of `point`
};

namespace persistent_contact {

// Input, filled one contact after the other.
template <class Real>
struct Gathered {
  LaneTriple<Real> corner[4], corner_motion[4], node, node_motion;
  LaneArray<Real> corner_mass[4], last_weight[4], node_mass;

  KOKKOS_INLINE_FUNCTION void gather(int lane, const FaceAccess& faces,
                                     const View<const double*>& mass, const Interaction& last,
                                     int at, int face) {
    const SweptBoxes& surface = faces.surface;
    Vec3 now[4], before[4];
    faces.corners(face, surface.coordinates_new, faces.ghosts.coordinates_new, now);
    faces.corners(face, surface.coordinates_old, faces.ghosts.coordinates_old, before);
    for (int j = 0; j < 4; ++j) {
      corner[j].set(lane, now[j]);
      corner_motion[j].set(lane, now[j] - before[j]);
      corner_mass[j][lane] = faces.cornerMass(face, j);
      last_weight[j][lane] = last.weight[j];
    }
    node.set(lane, rowOf(surface.coordinates_new, at));
    node_motion.set(lane, faces.nodeMotion(at));
    node_mass[lane] = mass(at);
  }
};

// Motion of the node with respect to the face point with these weights.
template <class Real>
KOKKOS_INLINE_FUNCTION Triple<Real> relativeMotion(const Triple<Real>& of_node,
                                                   const Triple<Real> (&of_corner)[4],
                                                   const Real (&weight)[4]) {
  Triple<Real> motion = of_node;
  for (int j = 0; j < 4; ++j)
    motion = motion - weight[j] * of_corner[j];
  return motion;
}

// Whether a corner repeats its successor.
template <class Real>
KOKKOS_INLINE_FUNCTION typename MaskOf<Real>::type isTriangle(const Triple<Real> (&q)[4]) {
  typename MaskOf<Real>::type any = false;
  for (int j = 0; j < 4; ++j) {
    const Triple<Real> edge = q[(j + 1) & 3] - q[j];
    any = any | ((edge.x == Real(0.0)) & (edge.y == Real(0.0)) & (edge.z == Real(0.0)));
  }
  return any;
}

// Whether the swept boxes of the node and the face overlap with tolerances that add up to twice the
// reach, from x^{n+1} alone: each bound then holds exactly, and rounding is monotone. False where
// that is not known.
template <class Real>
KOKKOS_INLINE_FUNCTION typename MaskOf<Real>::type isWithin(double reach,
                                                            const Gathered<Real>& gathered) {
  const Triple<Real> x = gathered.node;
  Triple<Real> low = Triple<Real>(gathered.corner[0]) - x, high = low;
  for (int j = 1; j < 4; ++j) {
    const Triple<Real> q = Triple<Real>(gathered.corner[j]) - x;
    low = {minOf(low.x, q.x), minOf(low.y, q.y), minOf(low.z, q.z)};
    high = {maxOf(high.x, q.x), maxOf(high.y, q.y), maxOf(high.z, q.z)};
  }
  const Real least = -reach, most = reach;
  return (low.x <= most) & (low.y <= most) & (low.z <= most) & (least <= high.x) &
         (least <= high.y) & (least <= high.z);
}

template <class Real>
struct Found {
  LaneArray<Real> weight[4], gap, excess, xi, eta, inverse_mass;
  LaneTriple<Real> normal, motion, last_motion;
  LaneArray<Real> is_found; // 1, otherwise projectOne() is needed

  KOKKOS_INLINE_FUNCTION void scatter(int lane, PersistentContact& contact) const {
    FacePoint& point = contact.point;
    for (int j = 0; j < 4; ++j)
      point.weight[j] = weight[j][lane];
    point.normal = normal.of(lane);
    point.gap = gap[lane];
    point.excess = excess[lane];
    point.xi = xi[lane];
    point.eta = eta[lane];
    point.has_parameters = point.valid = true;
    contact.motion = motion.of(lane);
    contact.inverse_mass = inverse_mass[lane];
  }
};

template <class Real>
KOKKOS_INLINE_FUNCTION void evaluate(const Gathered<Real>& gathered, Found<Real>& found) {
  const Triple<Real> x = gathered.node, of_node = gathered.node_motion;
  Triple<Real> q[4], of_corner[4];
  Real last_weight[4];
  for (int j = 0; j < 4; ++j) {
    q[j] = Triple<Real>(gathered.corner[j]) - x;
    of_corner[j] = gathered.corner_motion[j];
    last_weight[j] = gathered.last_weight[j];
  }
  found.last_motion = relativeMotion(of_node, of_corner, last_weight);
  const NewtonPoint<Real> point = ontoBilinear(q, !isTriangle(q));
  found.motion = relativeMotion(of_node, of_corner, point.weight);
  Real inverse_mass = Real(1.0) / Real(gathered.node_mass);
  for (int j = 0; j < 4; ++j) {
    const Real share = point.weight[j] * point.weight[j] / Real(gathered.corner_mass[j]);
    inverse_mass = where(point.weight[j] == Real(0.0), inverse_mass, inverse_mass + share);
    found.weight[j] = point.weight[j];
  }
  found.inverse_mass = inverse_mass;
  found.normal = point.normal;
  found.gap = point.gap;
  found.excess = point.excess;
  found.xi = point.xi;
  found.eta = point.eta;
  found.is_found = where(point.found, Real(1.0), Real(0.0));
}

} // namespace persistent_contact

// The same for one contact: on triangles, and where Newton's method finds no point of the quad.
KOKKOS_INLINE_FUNCTION void projectOne(const FaceAccess& faces,
                                       const View<const double*>& node_mass,
                                       PersistentContact& contact) {
  contact.point =
      project(faces.quad(contact.face), rowOf(faces.surface.coordinates_new, contact.node));
  contact.motion = faces.relativeMotion(atNode(contact.node), contact.face, contact.point.weight);
  contact.inverse_mass = 1.0 / node_mass(contact.node);
  for (int j = 0; j < 4; ++j) {
    const double weight = contact.point.weight[j];
    if (weight != 0)
      contact.inverse_mass += weight * weight / faces.cornerMass(contact.face, j);
  }
}

// Fills the data of persistent node-to-face contacts, with the same bits for each as project() and
// relativeMotion() give.
KOKKOS_INLINE_FUNCTION void projectPersistentContacts(const FaceAccess& faces,
                                                      const View<const double*>& node_mass,
                                                      const ContactHistory& previous, int count,
                                                      PersistentContact* contacts) {
  using namespace persistent_contact;
  using Real = Lanes;
  constexpr int width = NumLanes<Real>::value;
  Gathered<Real> gathered;
  Found<Real> found;
  for (int first = 0; first < count; first += width) {
    const int last = minOf(first + width, count) - 1;
    for (int lane = 0; lane < width; ++lane) {
      const PersistentContact& contact = contacts[minOf(first + lane, last)];
      gathered.gather(lane, faces, node_mass, previous.interactions(contact.previous), contact.node,
                      contact.face);
    }
    evaluate(gathered, found);
    for (int lane = 0; first + lane <= last; ++lane) {
      PersistentContact& contact = contacts[first + lane];
      contact.last_motion = found.last_motion.of(lane);
      found.scatter(lane, contact);
      if (found.is_found[lane] == 0)
        projectOne(faces, node_mass, contact);
    }
  }
}

} // namespace brickwall::contact
