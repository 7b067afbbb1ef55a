#include "contact/enforcement/reports/contact_fields.hpp"

#include "contact/enforcement/law/coulomb_friction.hpp"

namespace brickwall::contact {

namespace {

// The interaction of a node with the largest normal force, or -1 if none presses.
KOKKOS_INLINE_FUNCTION int hardestPressed(const ContactHistory& history, std::int64_t node) {
  const int begin = history.row_begin(node), end = begin + history.row_count(node);
  double largest = 0;
  int hardest = -1;
  for (int i = begin; i < end; ++i) {
    const Interaction& pair = history.interactions(i);
    if (pair.force + pair.damping <= largest)
      continue;
    largest = pair.force + pair.damping;
    hardest = i;
  }
  return hardest;
}

KOKKOS_INLINE_FUNCTION Vec3 tangentialMotion(const FaceAccess& faces, const Interaction& pair) {
  return tangentialPart(faces.relativeMotion(pair.point, pair.face_index, pair.weight),
                        pair.normal);
}

} // namespace

ContactForces normalForces(const exec_space& space, const FaceAccess& faces,
                           const ContactHistory& history, const Quantum& quantum) {
  ContactForces forces{
      View<std::int64_t* [3]>("contact::normalForces::nodes", faces.surface.num_nodes),
      View<std::int64_t* [12]>("contact::normalForces::ghost_corners", faces.ghosts.count)};
  PairForces add;
  add.faces = faces;
  add.target = forces;
  add.inverse_quantum = quantum.inverse;
  const auto interactions = history.interactions;
  Kokkos::parallel_for(
      "contact::normalForces", rangePolicy(space, history.count),
      KOKKOS_LAMBDA(const std::int64_t i) {
        const Interaction& pair = interactions(i);
        PairQuanta<double> quanta;
        add.round(pair.force + pair.damping, triple(pair.normal), pair.point.share, pair.weight,
                  quanta);
        add.add(pair, quanta, 1);
      });
  return forces;
}

View<double* [3]> slipMotion(const exec_space& space, const FaceAccess& faces,
                             const ContactHistory& history) {
  View<double* [3]> slip("contact::slipMotion", faces.surface.num_nodes);
  if (history.count == 0)
    return slip;
  Kokkos::parallel_for(
      "contact::slipMotion", rangePolicy(space, faces.surface.num_nodes),
      KOKKOS_LAMBDA(const std::int64_t node) {
        const int hardest = hardestPressed(history, node);
        if (hardest < 0)
          return;
        const Vec3 tangential = tangentialMotion(faces, history.interactions(hardest));
        for (int d = 0; d < 3; ++d)
          slip(node, d) = tangential[d];
      });
  return slip;
}

// Over the interactions, whose memory is read in order; the first one of a row adds the node's
// slip.
void addSlip(const exec_space& space, const FaceAccess& faces, const ContactHistory& history,
             const View<double*>& distance) {
  const bool has_friction = history.friction.size() > 0;
  Kokkos::parallel_for(
      "contact::addSlip", rangePolicy(space, history.count), KOKKOS_LAMBDA(const std::int64_t i) {
        const int node = history.interactions(i).node;
        if (history.row_begin(node) != i)
          return;
        const int hardest = hardestPressed(history, node);
        if (hardest < 0)
          return;
        if (!has_friction) {
          distance(node) += norm(tangentialMotion(faces, history.interactions(hardest)));
          return;
        }
        const FrictionSpring& spring = history.friction(hardest);
        if (spring.stiffness > 0)
          distance(node) += norm(spring.trial - spring.force) / spring.stiffness;
      });
}

CandidateCounts countCandidates(const exec_space& space, const FaceAccess& faces,
                                const CandidatePairs& pairs) {
  CandidateCounts counts{
      View<std::int64_t* [3]>("contact::countCandidates::own", faces.surface.num_faces),
      View<std::int64_t* [12]>("contact::countCandidates::of_ghosts", faces.ghosts.count)};
  Kokkos::parallel_for(
      "contact::countCandidates", rangePolicy(space, pairs.num_rows),
      KOKKOS_LAMBDA(const std::int64_t row) {
        for (std::int64_t i = pairs.begin(row); i < pairs.end(row); ++i) {
          const int face = pairs.faces(i);
          if (faces.isOwn(face))
            Kokkos::atomic_add(&counts.own(face, 0), std::int64_t(1));
          else
            Kokkos::atomic_add(&counts.of_ghosts(faces.ghostOf(face), 0), std::int64_t(1));
        }
      });
  return counts;
}

} // namespace brickwall::contact
