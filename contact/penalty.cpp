// See penalty.hpp.
#include "contact/penalty.hpp"

#include "contact/base/region.hpp"
#include "contact/energy_neutral.hpp"
#include "contact/face_access.hpp"
#include "contact/select_interactions.hpp"

#include <utility>

namespace brickwall::contact {

std::string ContactSums::problem() const {
  if (invalid + stored.invalid > 0)
    return std::to_string(invalid + stored.invalid) +
           " contact forces or energies are not finite or beyond the fixed-point range";
  if (overflow > 0)
    return std::to_string(overflow) + " contacts of nodes that touch more than " +
           std::to_string(max_interactions) + " bodies at once";
  if (lost > 0)
    return std::to_string(lost) + " loaded contacts went deeper than the search reaches (deepest " +
           std::to_string(max_penetration) +
           " of a face's size among the rest): raise contact.tolerance or contact.penalty";
  return "";
}

void sumOverRanks(MPI_Comm comm, ContactSums& sums) {
  constexpr int num_limbs = LimbSums<1>::size();
  std::int64_t counts[num_limbs + 5];
  for (int i = 0; i < num_limbs; ++i)
    counts[i] = sums.stored.data()[i];
  std::int64_t* rest = counts + num_limbs;
  rest[0] = sums.interactions, rest[1] = sums.active, rest[2] = sums.lost;
  rest[3] = sums.overflow, rest[4] = sums.invalid;
  allReduce(comm, counts, num_limbs + 5, MPI_SUM);
  for (int i = 0; i < num_limbs; ++i)
    sums.stored.data()[i] = counts[i];
  sums.interactions = rest[0], sums.active = rest[1], sums.lost = rest[2];
  sums.overflow = rest[3], sums.invalid = rest[4];
  sums.max_penetration = allReduce(comm, sums.max_penetration, MPI_MAX);
}

namespace {

void ghostPlanes(const exec_space& space, const FaceAccess& faces, int first_row,
                 const View<MeanPlane*>& planes) {
  Kokkos::parallel_for(
      "contact::enforce::ghostPlanes", over(space, faces.ghosts.count),
      KOKKOS_LAMBDA(const std::int64_t ghost) {
        const int face = faces.surface.num_faces + static_cast<int>(ghost);
        planes(first_row + ghost) = meanPlane(faces.quad(face));
      });
}

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

// The forces of all interactions as integers: rounded once per pair, plus on the node, minus shared by the corners, of
// which the last takes the remainder, so that the sum is zero exactly. Returns the number of forces that do not fit.
std::int64_t addForces(const exec_space& space, const FaceAccess& faces,
                       const ContactHistory& history, const Quantum& quantum,
                       const ContactForces& forces) {
  zeroRows(space, "contact::addForces::zeroNodes", forces.nodes, faces.surface.num_nodes);
  zeroRows(space, "contact::addForces::zeroGhosts", forces.ghost_corners, faces.ghosts.count);
  std::int64_t invalid = 0;
  const auto interactions = history.interactions;
  Kokkos::parallel_reduce(
      "contact::addForces", over(space, history.count),
      KOKKOS_LAMBDA(const std::int64_t i, std::int64_t& bad) {
        const Interaction& pair = interactions(i);
        if (pair.force == 0)
          return;
        const double quanta = pair.force * quantum.inverse;
        if (!fitsFixedPoint(4 * quanta)) {
          ++bad;
          return;
        }
        const bool own = faces.isOwn(pair.face_index);
        for (int d = 0; d < 3; ++d) {
          const double along = quanta * pair.normal[d];
          const std::int64_t whole = roundToFixed(along);
          Kokkos::atomic_add(&forces.nodes(pair.node, d), whole);
          std::int64_t rest = -whole;
          for (int j = 0; j < 4; ++j) {
            const std::int64_t part = j < 3 ? roundToFixed(-pair.weight[j] * along) : rest;
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

// Accelerations by all forces: those given, and the contact totals.
void accelerate(const exec_space& space, int num_nodes, const View<const double* [3]>& by_others,
                const View<std::int64_t* [3]>& contact_totals, const Quantum& quantum,
                const View<const double*>& node_mass, const View<double* [3]>& accelerations) {
  Kokkos::parallel_for(
      "contact::accelerate", over(space, num_nodes), KOKKOS_LAMBDA(const std::int64_t node) {
        const double per_quantum = quantum.value / node_mass(node);
        for (int d = 0; d < 3; ++d)
          accelerations(node, d) =
              by_others(node, d) + static_cast<double>(contact_totals(node, d)) * per_quantum;
      });
}

// Step 4 of shared/contact_energy.md for all pairs, and the force that follows.
void correctForces(const exec_space& space, const FaceAccess& faces, double dt,
                   const View<double* [3]>& accelerations,
                   const View<double* [12]>& ghost_accelerations, const ContactHistory& history) {
  const auto interactions = history.interactions;
  Kokkos::parallel_for(
      "contact::correctForces", over(space, history.count), KOKKOS_LAMBDA(const std::int64_t i) {
        Interaction& pair = interactions(i);
        Vec3 relative = rowOf(accelerations, pair.node);
        for (int j = 0; j < 4; ++j)
          relative -=
              pair.weight[j] * faces.corner(pair.face_index, j, accelerations, ghost_accelerations);
        const double next_closing = pair.closing - dt * dt * dot(pair.normal, relative);
        pair.force = neutralForce(pair, next_closing);
      });
}

ContactHistory emptyHistory(const exec_space& space, const std::string& label, int num_nodes) {
  ContactHistory history;
  history.interactions = View<Interaction*>(label + "::interactions", 0);
  history.row_begin = allocate<View<int*>>(space, label + "::row_begin", num_nodes);
  history.row_count = View<unsigned char*>(label + "::row_count", num_nodes);
  return history;
}

} // namespace

Enforcement::Enforcement(const exec_space& space, MPI_Comm comm, const Surface& surface,
                         const View<const double*>& node_mass, const EnforcementConfig& config,
                         const Quantum& quantum, const LimbScale& energy_scale)
    : _config(config), _quantum(quantum), _energy_scale(energy_scale), _node_mass(node_mass),
      _node_faces(space, comm, surface),
      _planes(allocate<View<MeanPlane*>>(space, "contact::Enforcement::planes",
                                         surface.num_faces + _node_faces.numRemote())),
      _history(emptyHistory(space, "contact::Enforcement::history", surface.num_nodes)),
      _next(emptyHistory(space, "contact::Enforcement::next", surface.num_nodes)),
      _next_count("contact::Enforcement::next_count") {
  if (!(config.reference_step > 0) || !(config.penalty > 0))
    throw Error(ExitCode::internal, "Enforcement: reference_step is " +
                                        std::to_string(config.reference_step) + ", penalty " +
                                        std::to_string(config.penalty) + "; both must be > 0");
  _forces.nodes = View<std::int64_t* [3]>("contact::Enforcement::node_forces", surface.num_nodes);
  _forces.ghost_corners = View<std::int64_t* [12]>("contact::Enforcement::ghost_corners", 0);
  _status = View<unsigned char*>("contact::Enforcement::status", surface.num_nodes);
  _gap = View<double*>("contact::Enforcement::gap", surface.num_nodes);
  _accelerations =
      View<double* [3]>("contact::Enforcement::accelerations",
                        config.scheme == Scheme::energy_neutral ? surface.num_nodes : 0);
  _ghost_accelerations = View<double* [12]>("contact::Enforcement::ghost_accelerations", 0);
}

ContactSums Enforcement::enforce(const exec_space& space, const Surface& surface,
                                 const GhostFaces& ghosts, const CandidatePairs& pairs, double dt,
                                 const NeutralInput* neutral) {
  Region region("contact::enforce");
  const FaceAccess faces{surface, ghosts};
  updatePlanes(space, faces);
  ContactSums sums = selectInteractions(space, faces, pairs, dt);
  growTo(space, _forces.ghost_corners, ghosts.count);
  sums.invalid += addForces(space, faces, _next, _quantum, _forces);
  if (_config.scheme == Scheme::energy_neutral)
    sums.invalid += makeNeutral(space, faces, dt, neutral);
  std::swap(_history, _next);
  _previous_dt = dt;
  return sums;
}

void Enforcement::updatePlanes(const exec_space& space, const FaceAccess& faces) {
  const int first_ghost = faces.surface.num_faces + _node_faces.numRemote();
  growTo(space, _planes, first_ghost + faces.ghosts.count);
  _node_faces.updatePlanes(space, faces.surface, _planes);
  ghostPlanes(space, faces, first_ghost, _planes);
}

ContactSums Enforcement::selectInteractions(const exec_space& space, const FaceAccess& faces,
                                            const CandidatePairs& pairs, double dt) {
  while (true) {
    Kokkos::deep_copy(space, _next_count, std::int64_t(0));
    const double previous_dt = _previous_dt > 0 ? _previous_dt : dt;
    const SelectInteractions select{_config,
                                    _energy_scale,
                                    dt,
                                    previous_dt,
                                    faces,
                                    pairs,
                                    _node_faces.lists(),
                                    _planes,
                                    _node_faces.numRemote(),
                                    _node_mass,
                                    _history,
                                    _next,
                                    _next_count,
                                    _status,
                                    _gap};
    ContactSums sums;
    Kokkos::parallel_reduce("contact::selectInteractions", over(space, pairs.num_rows), select,
                            Combine<ContactSums>(sums));
    _next.count = sums.interactions;
    if (sums.interactions <= static_cast<std::int64_t>(_next.interactions.extent(0)))
      return sums;
    // Of the last step nothing has changed: again.
    growTo(space, _next.interactions, sums.interactions);
  }
}

std::int64_t Enforcement::makeNeutral(const exec_space& space, const FaceAccess& faces, double dt,
                                      const NeutralInput* neutral) {
  if (neutral == nullptr)
    throw Error(ExitCode::internal,
                "Enforcement: Scheme::energy_neutral needs the accelerations by the other forces");
  growTo(space, _ghost_accelerations, faces.ghosts.count);
  std::int64_t invalid = 0;
  for (int round = 0; round < _config.corrections; ++round) {
    neutral->sum_forces(_forces);
    accelerate(space, faces.surface.num_nodes, neutral->acceleration, _forces.nodes, _quantum,
               _node_mass, _accelerations);
    neutral->share_with_ghosts(_accelerations, _ghost_accelerations);
    correctForces(space, faces, dt, _accelerations, _ghost_accelerations, _next);
    invalid += addForces(space, faces, _next, _quantum, _forces);
  }
  return invalid;
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
