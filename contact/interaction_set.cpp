// See interaction_set.hpp.
#include "contact/interaction_set.hpp"

#include "contact/coulomb_friction.hpp"
#include "contact/energy_neutral.hpp"

namespace brickwall::contact {
namespace {

template <class ViewType>
void zeroRows(const exec_space& space, const std::string& label, const ViewType& values,
              std::int64_t rows) {
  const auto width = static_cast<std::int64_t>(values.extent(1));
  Kokkos::parallel_for(
      label, over(space, rows), KOKKOS_LAMBDA(const std::int64_t i) {
        for (std::int64_t w = 0; w < width; ++w)
          values(i, w) = 0;
      });
}

// The fading force times accelerations of the pair: `relative`, of the pushing point against the face point, and of single nodes.
template <class NodeView, class GhostView>
KOKKOS_INLINE_FUNCTION double powerOf(const FadingForce& fading, const Interaction& pair,
                                      const FaceAccess& faces, const Vec3& relative,
                                      const NodeView& of_nodes, const GhostView& of_ghosts) {
  double power = dot(fading.on_node, relative);
  for (int j = 0; j < 4; ++j)
    power += fading.normal.on_corner[j] *
             dot(pair.normal, faces.corner(pair.face_index, j, of_nodes, of_ghosts));
  if (fading.normal.on_end != 0)
    power += fading.normal.on_end * dot(pair.normal, rowOf(of_nodes, pair.point.node[1]) -
                                                         rowOf(of_nodes, pair.point.node[0]));
  return power;
}

ContactHistory emptyHistory(const exec_space& space, const std::string& label, int num_nodes) {
  ContactHistory history;
  history.interactions = View<Interaction*>(label + "::interactions", 0);
  history.friction = View<FrictionSpring*>(label + "::friction", 0);
  history.fading = View<FadingForce*>(label + "::fading", 0);
  history.row_begin = allocate<View<int*>>(space, label + "::row_begin", num_nodes);
  history.row_count = View<unsigned char*>(label + "::row_count", num_nodes);
  return history;
}

} // namespace

InteractionSet::InteractionSet(const exec_space& space, const std::string& label,
                               const Surface& surface, int face_corners,
                               const EnforcementConfig& config, const Quantum& quantum)
    : _config(config), _quantum(quantum), _face_corners(face_corners),
      _history(emptyHistory(space, label + "::history", surface.num_nodes)),
      _next(emptyHistory(space, label + "::next", surface.num_nodes)),
      _next_count(label + "::next_count") {
  _forces.nodes = View<std::int64_t* [3]>(label + "::node_forces", surface.num_nodes);
  _forces.ghost_corners = View<std::int64_t* [12]>(label + "::ghost_corners", 0);
}

void InteractionSet::growInteractions(const exec_space& space, std::int64_t count) {
  growTo(space, _next.interactions, count);
  const auto room = static_cast<std::int64_t>(_next.interactions.extent(0));
  if (_config.friction > 0)
    growTo(space, _next.friction, room);
  growTo(space, _next.fading, room);
}

std::int64_t InteractionSet::addForces(const exec_space& space, const FaceAccess& faces) {
  growTo(space, _forces.ghost_corners, faces.ghosts.count);
  zeroRows(space, "contact::addForces::zeroNodes", _forces.nodes, faces.surface.num_nodes);
  zeroRows(space, "contact::addForces::zeroGhosts", _forces.ghost_corners, faces.ghosts.count);
  std::int64_t invalid = 0;
  const ContactHistory pairs = _next;
  const ContactForces forces = _forces;
  const Quantum quantum = _quantum;
  const int face_corners = _face_corners;
  const bool has_friction = _config.friction > 0;
  Kokkos::parallel_reduce(
      "contact::addForces", over(space, pairs.count),
      KOKKOS_LAMBDA(const std::int64_t i, std::int64_t& bad) {
        const Interaction& pair = pairs.interactions(i);
        if (pair.first_force == 0)
          return;
        Vec3 force = (pair.force + pair.damping) * pair.normal;
        double largest = pair.force + pair.damping;
        NormalForces besides;
        if (has_friction) {
          const FrictionSpring& friction = pairs.friction(i);
          force += friction.force;
          largest += norm(friction.force);
          addCouple(friction, pair, face_corners, besides);
        }
        if (pair.taper < 1) {
          const FadingForce& fading = pairs.fading(i);
          force += fading.on_node;
          largest += norm(fading.on_node);
          besides.add(fading.normal);
        }
        if (!fitsFixedPoint(4 * quantum.inverse * largest)) {
          ++bad;
          return;
        }
        const bool own = faces.isOwn(pair.face_index);
        for (int d = 0; d < 3; ++d) {
          const double quanta = quantum.inverse * force[d];
          const std::int64_t whole = roundToFixed(quanta);
          const double per_normal = quantum.inverse * pair.normal[d];
          const double on_second = pair.point.share * quanta + per_normal * besides.on_end;
          const std::int64_t second = pair.point.isNode() ? 0 : roundToFixed(on_second);
          Kokkos::atomic_add(&forces.nodes(pair.point.node[0], d), whole - second);
          if (second != 0)
            Kokkos::atomic_add(&forces.nodes(pair.point.node[1], d), second);
          std::int64_t rest = -whole;
          for (int j = 0; j < face_corners; ++j) {
            const double share = -pair.weight[j] * quanta + per_normal * besides.on_corner[j];
            const std::int64_t part = j < face_corners - 1 ? roundToFixed(share) : rest;
            rest -= part;
            std::int64_t* target =
                own ? &forces.nodes(faces.surface.face_to_nodes(pair.face_index, j), d)
                    : &forces.ghost_corners(faces.ghostOf(pair.face_index), 3 * j + d);
            Kokkos::atomic_add(target, part);
          }
        }
      },
      invalid);
  return invalid;
}

void InteractionSet::correctForces(const exec_space& space, const FaceAccess& faces,
                                   const StepLengths& steps, const View<double* [3]>& accelerations,
                                   const View<double* [12]>& ghost_accelerations) {
  const ContactHistory pairs = _next;
  const double dt = steps.dt, next_dt = steps.next_dt, kick = 0.5 * (dt + next_dt);
  const double limit = _config.friction;
  Kokkos::parallel_for(
      "contact::correctForces", over(space, pairs.count), KOKKOS_LAMBDA(const std::int64_t i) {
        Interaction& pair = pairs.interactions(i);
        const double share = pair.point.share;
        Vec3 relative = rowOf(accelerations, pair.point.node[0]);
        if (!pair.point.isNode())
          relative = (1 - share) * relative + share * rowOf(accelerations, pair.point.node[1]);
        for (int j = 0; j < 4; ++j)
          relative -=
              pair.weight[j] * faces.corner(pair.face_index, j, accelerations, ghost_accelerations);
        KickedPair motion;
        motion.closing = kick / dt * pair.closing;
        motion.next_closing = motion.closing - kick * kick * dot(pair.normal, relative);
        motion.next_drift = next_dt / kick;
        motion.mobility = kick * kick * pair.inverse_mass;
        const double before = pair.force;
        pair.force = neutralForce(pair, motion);
        if (pair.taper < 1) {
          motion.next_closing += (before - pair.force) * motion.mobility;
          FadingForce& fading = pairs.fading(i);
          KickedFading kicked;
          kicked.before = kick / dt * fading.work;
          kicked.after = kicked.before + kick * kick *
                                             powerOf(fading, pair, faces, relative, accelerations,
                                                     ghost_accelerations);
          kicked.gain = motion.mobility * dot(fading.on_node, fading.on_node);
          kicked.next_drift = motion.next_drift;
          fading.multiply(neutralFading(pair, motion, kicked, fading.work_to_end));
        }
        pair.damping = maxOf(pair.first_damping, -pair.force);
        if (limit > 0)
          pairs.friction(i).force =
              slipped(pairs.friction(i).trial, limit * (pair.force + pair.damping));
      });
}

void addFaceForces(const exec_space& space, const Surface& surface,
                   const View<const std::int64_t* [12]>& own_face_forces,
                   const View<std::int64_t* [3]>& node_forces) {
  const auto face_to_nodes = surface.face_to_nodes;
  Kokkos::parallel_for(
      "contact::addFaceForces", over(space, surface.num_faces),
      KOKKOS_LAMBDA(const std::int64_t face) {
        for (int j = 0; j < 4; ++j)
          for (int d = 0; d < 3; ++d)
            if (own_face_forces(face, 3 * j + d) != 0)
              Kokkos::atomic_add(&node_forces(face_to_nodes(face, j), d),
                                 own_face_forces(face, 3 * j + d));
      });
}

} // namespace brickwall::contact
