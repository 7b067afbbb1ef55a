// The contacts of a step, row by row of the candidates: what there is to do is gathered for many rows at once, the faces are chosen
// (select_active_faces.hpp) and their forces written (interaction_forces.hpp). Kernel functor.
//
// `Touch` knows the geometry: NodeFaceKinematics or EdgeEdgeKinematics.
#pragma once

#include "contact/enforcement/dormancy/sleep_state.hpp"
#include "contact/enforcement/dormancy/stationary_nodes.hpp"
#include "contact/enforcement/selection/select_active_faces.hpp"

namespace brickwall::contact {

// Rows of candidates, one per surface node, some at once: tests the node against its candidates, chooses one face of each opposing
// body and writes the node's row of `next`. Rows of candidates are in the order of (body, face id), so ties go to the lower id.
// Rows without history where no contact can begin (Touch::mayPenetrate, mayActivate, or rowsThatMayActivate) are left as they are: row_count must
// be 0 before, and what Touch::record() writes that of no contact. Contacts that go on are looked at together.
template <class Kinematics>
struct SelectInteractions : SelectActiveFaces<Kinematics> {
  using value_type = ContactSums;
  using Base = SelectActiveFaces<Kinematics>;
  using Base::add;
  using Base::countLost;
  using Base::faces;
  using Base::interact;
  using Base::isCompressive;
  using Base::next;
  using Base::pairs;
  using Base::previous;
  using Base::selectActiveFaces;
  using Base::takePlaces;
  using Base::touch;

  static constexpr int rows_at_once = Base::max_rows;
  static constexpr std::int64_t rows_of_block = CandidatePairs::rows_per_block;
  static_assert(rows_at_once % rows_of_block == 0, "whole blocks");
  static constexpr int max_known = simd_width > 1 ? 2 * rows_at_once : max_interactions;

  std::int64_t first_row = 0; // rows before it are empty
  StationaryFlags still;
  SleepState sleep;
  bool has_asleep = false; // else `sleep` is not looked at

  // Rows with something to do, and the contacts that they go on with: row r has known[first[r]] .. known[first[r + 1] - 1].
  struct Batch {
    int num_rows = 0, num_known = 0;
    std::int64_t rows[rows_at_once];
    int first[rows_at_once + 1];
    PersistentContact known[max_known];
  };

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t part, ContactSums& sums) const {
    const std::int64_t begin = part * rows_at_once;
    const std::int64_t end = minOf<std::int64_t>(begin + rows_at_once, pairs.num_rows);
    std::int64_t to_see[rows_at_once];
    int num_to_see = 0;
    for (std::int64_t first = begin; first < end; first += rows_of_block) {
      if (has_asleep && sleep.sleeps(first / rows_of_block))
        continue;
      const std::int64_t last = minOf(first + rows_of_block, end);
      for (std::int64_t row = first; row < last; ++row)
        if (!isEmpty(row) && !still.isClear(pairs, row))
          to_see[num_to_see++] = row;
    }
    if (num_to_see == 0)
      return;
    for (int r = 0; r < num_to_see; ++r)
      prefetchHead(pairs.node(to_see[r]));
    for (int r = 0; r < num_to_see; ++r)
      prefetchRow(to_see[r]);
    if constexpr (Kinematics::tests_rows_together) {
      num_to_see = keepRowsThatBear(to_see, num_to_see);
      if (num_to_see == 0)
        return;
    }
    num_to_see = writeSteadyRows(to_see, num_to_see, sums);
    if (num_to_see > 0)
      selectBatches(to_see, num_to_see, sums);
  }
  KOKKOS_INLINE_FUNCTION void selectBatches(std::int64_t* to_see, int num_to_see,
                                            ContactSums& sums) const {
    Batch batch;
    std::int64_t touching[rows_at_once]; // of rows without history: the first pair that may touch
    if constexpr (!Kinematics::tests_rows_together)
      num_to_see = keepRowsThatTouch(to_see, num_to_see, touching);
    for (int r = 0; r < num_to_see; ++r) {
      const std::int64_t row = to_see[r];
      const int node = pairs.node(row), count = previous.row_count(node);
      if constexpr (!Kinematics::tests_rows_together)
        if (count == 0 && !rowMayActivate(row, node, touching[r]))
          continue;
      if (batch.num_known + count > max_known)
        finish(batch, sums);
      batch.rows[batch.num_rows] = row;
      batch.first[batch.num_rows++] = batch.num_known;
      if (count > 0)
        findKnown(row, node, count, batch);
    }
    finish(batch, sums);
  }
  // Those of the listed rows whose contacts go on as they were. The others are then the first ones; returns how many they are.
  KOKKOS_INLINE_FUNCTION int writeSteadyRows(std::int64_t* rows, int count,
                                             ContactSums& sums) const {
    int num_left = 0;
    if constexpr (Kinematics::knows_motion) {
      typename Base::SteadyRows steady;
      for (int r = 0; r < count; ++r) {
        const int node = pairs.node(rows[r]), history = previous.row_count(node);
        if (history > 0)
          still.known_apart(node) = 0;
        if (history == 0 || !this->hasSteady() || !this->addSteady(rows[r], node, history, steady))
          rows[num_left++] = rows[r];
      }
      const int num_unsteady = this->writeSteady(steady, sums);
      for (int r = 0; r < num_unsteady; ++r)
        rows[num_left++] = steady.rows[r];
    } else {
      for (; num_left < count; ++num_left)
        if (previous.row_count(pairs.node(rows[num_left])) > 0)
          still.known_apart(pairs.node(rows[num_left])) = 0;
    }
    return num_left;
  }
  // Whether there is neither a candidate nor a contact of the last step.
  KOKKOS_FORCEINLINE_FUNCTION bool isEmpty(std::int64_t row) const {
    if (pairs.begin(row) != pairs.end(row))
      return false;
    const int node = pairs.node(row);
    const bool is_empty = previous.row_count(node) == 0;
    if (is_empty)
      still.known_apart(node) = 1;
    return is_empty;
  }
  // What is read of a row comes from many places: all of them are asked for before any is waited for.
  KOKKOS_FORCEINLINE_FUNCTION void prefetchHead(int node) const {
    touch.prefetchHead(node);
    prefetch(&previous.row_count(node));
    prefetch(&previous.row_begin(node));
  }
  KOKKOS_FORCEINLINE_FUNCTION void prefetchRow(std::int64_t row) const {
    const int node = pairs.node(row);
    const std::int64_t end = pairs.end(row);
    for (std::int64_t p = pairs.begin(row); p < end; ++p)
      touch.prefetchFace(pairs.faces(p));
    faces.prefetchRow(faces.surface.coordinates_new, node);
    if (previous.row_count(node) == 0)
      return;
    faces.prefetchRow(faces.surface.coordinates_old, node);
    previous.prefetch(previous.row_begin(node));
    prefetch(&faces.surface.node_body(node));
    touch.prefetchNode(node);
  }
  // Rows with history, and those without where a contact may begin as far as the places of node and faces tell; what else is
  // asked then is asked for. `clear` remembers the others: none of their pairs could be touched even if the faces around the node
  // turned. Returns the number of rows kept.
  KOKKOS_INLINE_FUNCTION int keepRowsThatTouch(std::int64_t* rows, int count,
                                               std::int64_t* touching) const {
    int num_kept = 0;
    for (int r = 0; r < count; ++r) {
      const std::int64_t row = rows[r], end = pairs.end(row);
      const int node = pairs.node(row);
      std::int64_t p = pairs.begin(row);
      if (previous.row_count(node) == 0) {
        while (p < end && !touch.mayPenetrate(faces, node, pairs.faces(p)))
          ++p;
        still.known_apart(node) = p == end;
        if (p == end)
          continue;
        touch.prefetchNode(node);
      }
      rows[num_kept] = row;
      touching[num_kept++] = p;
    }
    for (int r = 0; r < num_kept; ++r)
      if (previous.row_count(pairs.node(rows[r])) == 0)
        touch.prefetchAround(pairs.node(rows[r]));
    return num_kept;
  }
  // Whether a contact may begin with the pairs from `touching` on, which itself may touch.
  KOKKOS_INLINE_FUNCTION bool rowMayActivate(std::int64_t row, int node,
                                             std::int64_t touching) const {
    const std::int64_t end = pairs.end(row);
    bool may_bear = touch.mayActivate(node, pairs.faces(touching));
    for (std::int64_t p = touching + 1; p < end && !may_bear; ++p)
      may_bear = touch.mayPenetrate(faces, node, pairs.faces(p)) &&
                 touch.mayActivate(node, pairs.faces(p));
    return may_bear;
  }
  // The same for rows at once, by Touch::rowsThatMayActivate(), where nothing but the two of a pair matters. Keeps these rows and those with
  // history; returns their number.
  KOKKOS_INLINE_FUNCTION int keepRowsThatBear(std::int64_t* rows, int count) const {
    static_assert(rows_at_once <= 32, "a bit for each row");
    unsigned without_history = 0;
    for (int r = 0; r < count; ++r)
      without_history |= static_cast<unsigned>(previous.row_count(pairs.node(rows[r])) == 0) << r;
    const unsigned bearing = touch.rowsThatMayActivate(faces, pairs, rows, count, without_history);
    int num_kept = 0;
    for (int r = 0; r < count; ++r) {
      const std::int64_t row = rows[r];
      const bool has_none = without_history >> r & 1u, may_bear = bearing >> r & 1u;
      if (has_none)
        still.known_apart(pairs.node(row)) = !may_bear;
      rows[num_kept] = row;
      num_kept += !has_none || may_bear;
    }
    return num_kept;
  }
  KOKKOS_INLINE_FUNCTION void findKnown(std::int64_t row, int node, int count, Batch& batch) const {
    const std::int64_t end = pairs.end(row);
    const int first = previous.row_begin(node);
    int missing = count;
    for (std::int64_t p = pairs.begin(row); p < end && missing > 0; ++p) {
      const int face = pairs.faces(p);
      const global_id id = touch.idOf(faces, face);
      for (int s = 0; s < count; ++s) {
        if (previous.interactions(first + s).face != id)
          continue;
        --missing;
        if (!faces.isOfThisStep(pairs.step_test, node, face))
          continue;
        PersistentContact& contact = batch.known[batch.num_known++];
        contact.node = node;
        contact.slot = s;
        contact.previous = first + s;
        contact.face = face;
        faces.prefetchFace(face);
      }
    }
  }
  KOKKOS_INLINE_FUNCTION void finish(Batch& batch, ContactSums& sums) const {
    touch.look(faces, previous, batch.num_known, batch.known);
    batch.first[batch.num_rows] = batch.num_known;
    for (int r = 0; r < batch.num_rows; ++r)
      selectOfRow(batch.rows[r], batch.known + batch.first[r], batch.first[r + 1] - batch.first[r],
                  sums);
    batch.num_rows = batch.num_known = 0;
  }

  KOKKOS_INLINE_FUNCTION void selectOfRow(std::int64_t row, const PersistentContact* known,
                                          int num_known, ContactSums& sums) const {
    const int node = pairs.node(row);
    FaceContact hits[max_interactions];
    int seen = 0; // bit s: the face of the node's previous interaction s is still a candidate
    for (int k = 0; k < num_known; ++k)
      seen |= 1 << known[k].slot;
    const int num_hits = selectActiveFaces(row, node, known, num_known, hits, sums);
    countLost(node, seen, sums);
    double deepest = 0;
    int num_loaded = 0;
    for (int h = 0; h < num_hits; ++h) {
      deepest = maxOf(deepest, hits[h].depth);
      hits[h].is_loaded = isCompressive(node, hits[h]);
      num_loaded += hits[h].is_loaded;
    }
    touch.record(node, num_hits, deepest);
    sums.touching += num_hits;
    next.row_count(node) = static_cast<unsigned char>(num_loaded);
    if (num_loaded == 0)
      return;
    std::int64_t index = takePlaces(num_loaded);
    next.row_begin(node) = static_cast<int>(index);
    for (int h = 0; h < num_hits; ++h) {
      if (!hits[h].is_loaded)
        continue;
      const bool has_room = index < static_cast<std::int64_t>(next.interactions.extent(0));
      interact(node, hits, num_hits, h, has_room ? index : -1, sums);
      ++index;
    }
  }
};

} // namespace brickwall::contact
