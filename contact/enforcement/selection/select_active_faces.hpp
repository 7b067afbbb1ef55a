// Which faces a node (or edge) is in contact with: one face of each opposing body, kept while it lasts; birth and switch as
// enforcement.hpp states them. Kernel part of SelectInteractions.
#pragma once

#include "contact/enforcement/selection/persistent_contacts_simd.hpp"

namespace brickwall::contact {

template <class Kinematics>
struct SelectActiveFaces : PersistentContactsSimd<Kinematics> {
  using Base = PersistentContactsSimd<Kinematics>;
  using Base::bookWork;
  using Base::config;
  using Base::faces;
  using Base::goesOn;
  using Base::pairs;
  using Base::previous;
  using Base::touch;

  // One hit per opposing body. Returns their number.
  KOKKOS_INLINE_FUNCTION int selectActiveFaces(std::int64_t row, int node,
                                               const PersistentContact* known, int num_known,
                                               FaceContact (&hits)[max_interactions],
                                               ContactSums& sums) const {
    const std::int64_t end = pairs.end(row);
    const global_id own_body = faces.surface.node_body(node);
    int num_hits = 0;
    for (std::int64_t pair = pairs.begin(row); pair < end;) {
      const global_id body = touch.bodyOf(faces, pairs.faces(pair));
      const std::int64_t begin = pair;
      while (pair < end && touch.bodyOf(faces, pairs.faces(pair)) == body)
        ++pair;
      FaceContact hit;
      recall(node, body, known, num_known, hit, sums);
      const bool wanted = (body != own_body || config.self_contact) && touch.pushes(own_body, body);
      if (!wanted || !selectFaceOfBody(node, begin, pair, hit))
        continue;
      if (num_hits < max_interactions)
        hits[num_hits++] = hit;
      else
        ++sums.overflow;
    }
    return num_hits;
  }

  // The face of a body, of its candidates [begin, end), that the node is in contact with: the last one if it still is under load,
  // else the least penetrated.
  KOKKOS_INLINE_FUNCTION bool selectFaceOfBody(int node, std::int64_t begin, std::int64_t end,
                                               FaceContact& hit) const {
    // A contact without load is chosen anew: else a node that slid in beside a face would stay with it for ever.
    const bool is_loaded = hit.previous >= 0 && previous.interactions(hit.previous).depth > 0;
    const bool has_face = is_loaded && hit.previous_face >= 0;
    if (has_face && touch.testAgain(faces, *hit.known, hit)) {
      // Where faces meet, the node's place chooses between them, not which of them was the first: who covers it better takes over.
      if (touch.isPastInner(faces, hit))
        findNearest(node, begin, end, ContactTest::activate, true, hit, leastWeight(hit));
      return true;
    }
    hit.known = nullptr;
    // Where it went out through the face, the contact has ended and given back its energy; what it touches now, it meets anew.
    hit.has_ended = has_face && touch.isOutside(faces, node, hit.previous_face);
    if (findNearest(node, begin, end, ContactTest::activate, is_loaded, hit))
      return true;
    if (!is_loaded || hit.has_ended)
      return false;
    return findNearest(node, begin, end, ContactTest::transfer, is_loaded, hit) ||
           (has_face && isTouching(node, hit.previous_face, ContactTest::retain, hit));
  }

  // Whether the contact has a force, for all that is known yet. One without is forgotten: the next step chooses its face anew, and
  // takes the penetration that it finds as the offset.
  KOKKOS_INLINE_FUNCTION bool isCompressive(int node, FaceContact& hit) const {
    hit.motion = Kinematics::knows_motion && hit.known != nullptr
                     ? hit.known->motion
                     : faces.relativeMotion(touch.pointOf(faces, node, hit), hit.face, hit.weight);
    if (!goesOn(hit))
      return dot(hit.unitNormal(), hit.motion) < 0;
    const Interaction& last = previous.interactions(hit.previous);
    return last.face != touch.idOf(faces, hit.face) || last.is_held != hit.is_held ||
           hit.depth > last.offset;
  }

  // The least penetrated of the candidates [begin, end) with a least weight above `covered`, but for a previous face that the node
  // has left.
  KOKKOS_INLINE_FUNCTION bool findNearest(int node, std::int64_t begin, std::int64_t end,
                                          ContactTest test_kind, bool has_left, FaceContact& hit,
                                          double covered = -HUGE_VAL) const {
    bool found = false;
    FaceContact nearest, other;
    for (std::int64_t p = begin; p < end; ++p) {
      const int face = pairs.faces(p);
      other.previous = has_left || face == hit.previous_face ? hit.previous : -1;
      if ((has_left && face == hit.previous_face) || !isTouching(node, face, test_kind, other) ||
          !hasComeThrough(node, other) || !(leastWeight(other) > covered))
        continue;
      if (!found || other.depth < nearest.depth)
        nearest = other;
      found = true;
    }
    if (!found)
      return false;
    nearest.known = nullptr;
    nearest.previous = hit.previous;
    nearest.previous_face = hit.previous_face;
    nearest.contact_work = hit.contact_work;
    nearest.closing_before = hit.closing_before;
    nearest.has_ended = hit.has_ended;
    hit = nearest;
    return true;
  }

  // Of the face's corners: below 0 beyond an edge.
  KOKKOS_INLINE_FUNCTION static double leastWeight(const FaceContact& hit) {
    return minOf(minOf(hit.weight[0], hit.weight[1]), minOf(hit.weight[2], hit.weight[3]));
  }

  // What the node touched on `body` at the last step, if that face is among its candidates, and the work that its forces did since.
  KOKKOS_INLINE_FUNCTION void recall(int node, global_id body, const PersistentContact* known,
                                     int num_known, FaceContact& hit, ContactSums& sums) const {
    const int slot = previousSlot(node, body);
    hit.previous = slot < 0 ? -1 : previous.row_begin(node) + slot;
    hit.previous_face = -1;
    hit.known = nullptr;
    hit.contact_work = hit.closing_before = 0;
    hit.has_ended = false;
    for (int k = 0; k < num_known; ++k)
      if (known[k].slot == slot) {
        hit.known = &known[k];
        hit.previous_face = known[k].face;
        hit.closing_before = -dot(previous.interactions(hit.previous).normal, known[k].last_motion);
        hit.contact_work = bookWork(known[k], hit.closing_before, sums);
      }
  }

  // A node that is much deeper than it was, and than this step can have brought it, has not come through that face but through
  // another one of the body.
  KOKKOS_INLINE_FUNCTION bool hasComeThrough(int node, const FaceContact& hit) const {
    double known = config.deepest_birth;
    if (hit.depth <= known)
      return true;
    if (hit.previous >= 0) {
      const Interaction& last = previous.interactions(hit.previous);
      known += maxOf(last.depth + last.offset, 0.0);
    }
    const Vec3 motion = faces.relativeMotion(touch.pointOf(faces, node, hit), hit.face, hit.weight);
    return hit.depth <= known - dot(hit.unitNormal(), motion);
  }

  // The cheap tests first. That of the step last, of few pairs: with it the contacts do not depend on the margin.
  KOKKOS_INLINE_FUNCTION bool isTouching(int node, int face, ContactTest test_kind,
                                         FaceContact& hit) const {
    return touch.test(faces, node, face, test_kind, hit) &&
           faces.isOfThisStep(pairs.step_test, node, face);
  }
  KOKKOS_INLINE_FUNCTION int previousSlot(int node, global_id body) const {
    for (int s = 0; s < previous.row_count(node); ++s)
      if (previous.interactions(previous.row_begin(node) + s).body == body)
        return s;
    return -1;
  }

  // A loaded contact cannot leave the candidates (boxes hold x^n and x^{n+1}) unless it is deeper than their tolerance.
  KOKKOS_INLINE_FUNCTION void countLost(int node, int seen, ContactSums& sums) const {
    for (int s = 0; s < previous.row_count(node); ++s)
      if (!(seen & (1 << s)) && previous.interactions(previous.row_begin(node) + s).depth > 0)
        ++sums.lost;
  }
};

} // namespace brickwall::contact
