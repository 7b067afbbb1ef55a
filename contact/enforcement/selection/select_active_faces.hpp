// Selection of the active faces of a node (or edge): one face of each opposing side, by the rules
// of theory.md, section 6. Kernel part of SelectInteractions.
#pragma once

#include "contact/enforcement/selection/enforcement_step.hpp"

namespace brickwall::contact {

template <class Kinematics>
struct SelectActiveFaces {
  const EnforcementStep<Kinematics>& step;

  // The persistent contacts of a row, in the order of its history.
  struct Persistents {
    const PersistentContact* contacts;
    int count;
  };
  // The place in the history of a row and in its persistent contacts. Sides ascend in both, as
  // those of the candidates do, so all are read side by side.
  struct History {
    int next, end; // indices of interactions
    const PersistentContact* persistent;
    const PersistentContact* persistent_end;
  };
  KOKKOS_FORCEINLINE_FUNCTION History historyOf(int node, const Persistents& persistent) const {
    const int count = step.previous.row_count(node);
    const int first = count == 0 ? 0 : step.previous.row_begin(node);
    return {first, first + count, persistent.contacts, persistent.contacts + persistent.count};
  }

  // One contact per opposing side, written to `contacts`, which has room for all sides of the row.
  // Returns their number.
  KOKKOS_INLINE_FUNCTION int selectActiveFaces(std::int64_t row, int node,
                                               const Persistents& persistent, FaceContact* contacts,
                                               ContactSums& sums) const {
    History history = historyOf(node, persistent);
    const std::int64_t end = step.pairs.end(row);
    const global_id own_body = step.faces.surface.node_body(node);
    int num_contacts = 0;
    for (std::int64_t pair = step.pairs.begin(row); pair < end;) {
      const global_id side = step.kinematics.sideOf(step.faces, step.pairs.faces(pair));
      const std::int64_t begin = pair;
      if (step.kinematics.sideOf(step.faces, step.pairs.faces(end - 1)) == side)
        pair = end;
      while (pair < end && step.kinematics.sideOf(step.faces, step.pairs.faces(pair)) == side)
        ++pair;
      FaceContact contact;
      recallContact(side, history, contact, sums);
      if (isTested(own_body, side) && selectFaceOfSide(node, begin, pair, contact))
        contacts[num_contacts++] = contact;
    }
    return num_contacts;
  }

  // Calls accept(k, face) with the candidate that is the face of contact k, for all contacts of a
  // row of the history. Returns false if a contact is not under load or its face is none of the
  // candidates, if accept() is false, or if a contact with another side may become active. Whether
  // the pair is of this step (isOfThisStep()) is left to the caller. Notes rows that are steady if
  // all these contacts persist.
  template <class Accept>
  KOKKOS_INLINE_FUNCTION bool findFaces(std::int64_t row, int node, int first, int count,
                                        const Accept& accept) const {
    if (!step.steady.isSteady(row, node))
      return findFacesAmongCandidates(row, node, first, count, accept);
    for (int k = 0; k < count; ++k) {
      const Interaction& last = step.previous.interactions(first + k);
      if (!(last.depth > 0) || !accept(k, last.face_index))
        return false;
    }
    step.steady.note(node);
    return true;
  }
  // Sides ascend among candidates and contacts.
  template <class Accept>
  KOKKOS_INLINE_FUNCTION bool findFacesAmongCandidates(std::int64_t row, int node, int first,
                                                       int count, const Accept& accept) const {
    const auto& interactions = step.previous.interactions;
    bool is_steady = true;
    const global_id own_body = step.faces.surface.node_body(node);
    const std::int64_t begin = step.pairs.begin(row), end = step.pairs.end(row);
    if (begin == end)
      return false;
    const global_id last_side = step.kinematics.sideOf(step.faces, step.pairs.faces(end - 1));
    int k = 0;
    global_id side_of_contact = interactions(first).side, side = -1;
    bool is_found = false; // the face of contact k
    for (std::int64_t p = begin; p < end; ++p) {
      const int face = step.pairs.faces(p);
      if (side != last_side)
        side = step.kinematics.sideOf(step.faces, face);
      while (side_of_contact < side && k + 1 < count) {
        if (!is_found)
          return false;
        is_found = false;
        ++k;
        side_of_contact = interactions(first + k).side;
      }
      if (side != side_of_contact) {
        if (!isTested(own_body, side))
          continue;
        is_steady = false;
        if (step.kinematics.mayPenetrate(step.faces, node, face) &&
            step.kinematics.mayActivate(node, face))
          return false;
      } else if (!is_found && isFaceOf(interactions(first + k), face)) {
        if (!(interactions(first + k).depth > 0) || interactions(first + k).releases() ||
            !accept(k, face))
          return false;
        is_steady &= step.faces.isOwn(face);
        is_found = true;
      }
    }
    if (!is_found || k + 1 < count)
      return false;
    if (is_steady)
      step.steady.note(node);
    return true;
  }
  // Indices of own faces are those of the last step.
  KOKKOS_FORCEINLINE_FUNCTION bool isFaceOf(const Interaction& last, int face) const {
    return fills_lanes && last.face_index >= 0 && step.faces.isOwn(last.face_index)
               ? face == last.face_index
               : step.kinematics.idOf(step.faces, face) == last.face;
  }

  KOKKOS_INLINE_FUNCTION bool isTested(global_id own_body, global_id side) const {
    const global_id body = bodyOfSide(side);
    return (body != own_body || step.law.config.self_contact) &&
           step.kinematics.pushes(own_body, body);
  }

  // Selects the face of a side, from its candidates [begin, end): the last one while it stays in
  // contact under load, otherwise the least penetrated one.
  KOKKOS_INLINE_FUNCTION bool selectFaceOfSide(int node, std::int64_t begin, std::int64_t end,
                                               FaceContact& contact) const {
    // An unloaded contact is selected anew; otherwise a node that slid in beside a face would keep
    // it for ever.
    const bool is_released = contact.previous >= 0 &&
                             step.previous.interactions(contact.previous).releases() &&
                             !holdsEnergy(contact);
    const bool is_loaded = !is_released && contact.previous >= 0 &&
                           step.previous.interactions(contact.previous).depth > 0;
    const bool has_face = is_loaded && contact.previous_face >= 0;
    const bool persists = has_face && isStillTouching(ContactTest::persist, contact);
    if (persists && !step.kinematics.isBeyondInnerEdge(step.faces, contact))
      return true;
    // Where faces meet, the position of the node decides between them, not the order of contact:
    // the face that covers it better takes over.
    const double covered = persists ? leastWeight(contact) : -HUGE_VAL;
    // A node that has left through the face has ended its contact. Another contact with the side
    // then starts anew.
    if (!persists)
      contact.has_ended =
          is_released || (has_face && step.kinematics.isInFront(step.faces, contact.previous_face,
                                                                contact.persistent->point));
    for (ContactTest kind = ContactTest::activate;; kind = ContactTest::transfer) {
      if (findNearest(node, begin, end, kind, is_loaded, contact, covered))
        return is_loaded || !isOutside(node, begin, end, contact);
      if (!is_loaded)
        return false;
      if (persists || contact.has_ended || kind == ContactTest::transfer)
        return has_face && continuesOrReleases(node, begin, end, persists, contact);
    }
  }
  // The same for a loaded contact that no other face takes over.
  KOKKOS_INLINE_FUNCTION bool continuesOrReleases(int node, std::int64_t begin, std::int64_t end,
                                                  bool persists, FaceContact& contact) const {
    const bool may_be_retained = !step.previous.interactions(contact.previous).releases();
    if ((persists || (may_be_retained && isStillTouching(ContactTest::retain, contact))) &&
        !isOutside(node, begin, end, contact))
      return true;
    contact.releases = holdsEnergy(contact) && isStillTouching(ContactTest::release, contact) &&
                       mayRelease(node, contact);
    contact.has_ended = false;
    return contact.releases;
  }
  // Whether the node is in contact with its previous face. Their boxes of the step itself overlap,
  // since the contact is persistent: contacts do not depend on the search margin.
  KOKKOS_INLINE_FUNCTION bool isStillTouching(ContactTest test_kind, FaceContact& contact) const {
    return step.kinematics.testPersistent(step.faces, *contact.persistent, test_kind, contact);
  }
  // Beyond the reach of the spring only forces that are corrected return what is stored, and a node
  // that has faded must not catch on the edge.
  KOKKOS_INLINE_FUNCTION bool mayRelease(int node, const FaceContact& contact) const {
    const bool has_faded = !(step.kinematics.fadeWeightOf(step.faces, node, contact) > 0);
    if (step.law.config.scheme != Scheme::energy_neutral)
      return contact.depth > 0 && !has_faded;
    return !has_faded || isSeparating(node, contact);
  }
  KOKKOS_INLINE_FUNCTION bool isSeparating(int node, const FaceContact& contact) const {
    const Vec3 motion = step.faces.relativeMotion(
        step.kinematics.pointOf(step.faces, node, contact), contact.face, contact.weight);
    return dot(contact.unitNormal(), motion) >= 0;
  }
  // Whether the last step has not returned nearly all of the energy of a loaded contact.
  KOKKOS_INLINE_FUNCTION bool holdsEnergy(const FaceContact& contact) const {
    constexpr double least_share = 0.01;
    const double stored = step.previous.interactions(contact.previous).stored;
    return stored + contact.contact_work > least_share * maxOf(stored, contact.contact_work);
  }
  // Whether the node is outside the body, beyond an edge of the contact's face.
  KOKKOS_INLINE_FUNCTION bool isOutside(int node, std::int64_t begin, std::int64_t end,
                                        const FaceContact& contact) const {
    if (!step.kinematics.isBeyondInnerEdge(step.faces, contact))
      return false;
    for (std::int64_t p = begin; p < end; ++p)
      if (step.kinematics.hasLeftThrough(step.faces, node, step.pairs.faces(p), contact))
        return true;
    return false;
  }

  // Completes the data of a contact. Returns whether it has a force, as far as is known yet: one
  // without is dropped from the contact history, and the next step selects its face anew and takes
  // the present penetration as the offset.
  KOKKOS_INLINE_FUNCTION bool isCompressive(int node, FaceContact& contact) const {
    contact.node = node;
    contact.point = step.kinematics.pointOf(step.faces, node, contact);
    contact.is_persistent = contact.previous >= 0 && !contact.has_ended &&
                            step.previous.interactions(contact.previous).depth > 0;
    if (Kinematics::projects_persistent_contacts && contact.persistent != nullptr) {
      contact.motion = contact.persistent->motion;
      contact.inverse_mass = contact.persistent->inverse_mass;
    } else {
      contact.motion = step.faces.relativeMotion(contact.point, contact.face, contact.weight);
      contact.inverse_mass = step.inverseMassOf(contact);
    }
    if (!contact.is_persistent)
      return dot(contact.unitNormal(), contact.motion) < 0;
    const Interaction& last = step.previous.interactions(contact.previous);
    return contact.releases || contact.hasChangedFace(last) || contact.depth > last.offset;
  }

  // The least penetrated of the candidates [begin, end) whose smallest weight exceeds `covered`,
  // except a previous face that the node has left.
  KOKKOS_INLINE_FUNCTION bool findNearest(int node, std::int64_t begin, std::int64_t end,
                                          ContactTest test_kind, bool excludes_previous,
                                          FaceContact& contact, double covered) const {
    bool found = false;
    FaceContact nearest, other;
    const auto isExcluded = [&](int face) {
      return excludes_previous && face == contact.previous_face;
    };
    // Takes `other`, if it is in contact with `face`.
    const auto takeIfNearest = [&](int face) {
      other.previous = excludes_previous || face == contact.previous_face ? contact.previous : -1;
      if (!step.faces.isOfThisStep(step.pairs.step_test, node, face) ||
          !hasEnteredThrough(node, other) || !(leastWeight(other) > covered))
        return;
      if (!found || other.depth < nearest.depth)
        nearest = other;
      found = true;
    };
    if constexpr (Kinematics::projects_candidates_at_once) {
      constexpr int width = Kinematics::candidates_at_once;
      FacePoint points[width];
      int faces[width];
      for (std::int64_t p = begin; p < end;) {
        int count = 0;
        for (; p < end && count < width; ++p)
          if (!isExcluded(step.pairs.faces(p)) &&
              step.kinematics.isFacing(step.faces, node, step.pairs.faces(p), test_kind))
            faces[count++] = step.pairs.faces(p);
        step.kinematics.projectCandidates(step.faces, node, count, faces, points);
        for (int k = 0; k < count; ++k)
          if (step.kinematics.testPoint(step.faces, node, faces[k], test_kind, points[k], other))
            takeIfNearest(faces[k]);
      }
    } else if constexpr (EnforcementStep<Kinematics>::has_tested_pairs) {
      for (std::int64_t p = begin; p < end; ++p) {
        const int place = step.tested.place(p), face = step.pairs.faces(p);
        if (place < 0 || isExcluded(face))
          continue;
        const TestedPair& pair = step.tested.pairs(place);
        if ((pair.passed & bitOf(test_kind)) == 0)
          continue;
        static_cast<PenetratedPoint&>(other) = pair.point;
        other.face = face;
        other.is_retained = false;
        takeIfNearest(face);
      }
    } else {
      for (std::int64_t p = begin; p < end; ++p) {
        const int face = step.pairs.faces(p);
        // read by the tests of edges
        other.previous = excludes_previous || face == contact.previous_face ? contact.previous : -1;
        if (!isExcluded(face) && step.kinematics.test(step.faces, node, face, test_kind, other))
          takeIfNearest(face);
      }
    }
    if (!found)
      return false;
    nearest.persistent = nullptr;
    nearest.previous = contact.previous;
    nearest.previous_face = contact.previous_face;
    nearest.contact_work = contact.contact_work;
    nearest.closing_at_last_point = contact.closing_at_last_point;
    nearest.has_ended = contact.has_ended;
    nearest.releases = false;
    contact = nearest;
    return true;
  }

  // Smallest weight of the face's corners; negative beyond an edge.
  KOKKOS_INLINE_FUNCTION static double leastWeight(const FaceContact& contact) {
    return minOf(minOf(contact.weight[0], contact.weight[1]),
                 minOf(contact.weight[2], contact.weight[3]));
  }

  // Reads the interaction with `side` from the contact history if its face is still a candidate,
  // and records the work of its last forces.
  KOKKOS_INLINE_FUNCTION void recallContact(global_id side, History& history, FaceContact& contact,
                                            ContactSums& sums) const {
    while (history.next < history.end && step.previous.interactions(history.next).side < side)
      ++history.next;
    const bool is_known =
        history.next < history.end && step.previous.interactions(history.next).side == side;
    contact.previous = is_known ? history.next : -1;
    contact.previous_face = -1;
    contact.persistent = nullptr;
    contact.contact_work = contact.closing_at_last_point = 0;
    contact.has_ended = contact.releases = false;
    if (!is_known || history.persistent == history.persistent_end ||
        history.persistent->previous != history.next)
      return;
    contact.persistent = history.persistent++;
    contact.previous_face = contact.persistent->face;
    recordWork(contact, sums);
  }
  // Records the work of the last forces of a persistent contact.
  KOKKOS_INLINE_FUNCTION void recordWork(FaceContact& contact, ContactSums& sums) const {
    contact.closing_at_last_point =
        -dot(step.previous.interactions(contact.previous).normal, contact.persistent->last_motion);
    contact.contact_work =
        step.recordWork(*contact.persistent, contact.closing_at_last_point, sums);
  }

  // Whether the node can have entered the body through this face. If it is much deeper than before,
  // and deeper than this step can have brought it, it has entered through another face.
  KOKKOS_INLINE_FUNCTION bool hasEnteredThrough(int node, const FaceContact& contact) const {
    double limit = step.law.config.max_activation_depth;
    if (contact.depth <= limit)
      return true;
    if (contact.previous >= 0) {
      const Interaction& last = step.previous.interactions(contact.previous);
      limit += maxOf(last.depth + last.offset, 0.0);
    }
    const Vec3 motion = step.faces.relativeMotion(
        step.kinematics.pointOf(step.faces, node, contact), contact.face, contact.weight);
    return contact.depth <= limit - dot(contact.unitNormal(), motion);
  }

  // A loaded contact stays among the candidates (boxes hold x^n and x^{n+1}) unless it is deeper
  // than their tolerance, or retained farther beyond an edge.
  KOKKOS_INLINE_FUNCTION void countLost(int node, const Persistents& persistent,
                                        ContactSums& sums) const {
    History history = historyOf(node, persistent);
    for (int i = history.next; i < history.end; ++i)
      if (history.persistent != history.persistent_end && history.persistent->previous == i)
        ++history.persistent;
      else if (step.previous.interactions(i).depth > 0 && !step.previous.interactions(i).releases())
        ++sums.lost;
  }
};

} // namespace brickwall::contact
