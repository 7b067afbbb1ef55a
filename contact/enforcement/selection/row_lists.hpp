// The rows of candidates that may have a contact, in lists, so that the threads of a device that
// work together have equal work. Kernel part of InteractionSet::select() where threads have no SIMD
// lanes to fill.
#pragma once

#include "contact/enforcement/selection/select_interactions.hpp"

namespace brickwall::contact {

// Rows in arbitrary order.
struct RowList {
  View<int*> rows; // [place]
  View<std::int64_t> count;

  KOKKOS_INLINE_FUNCTION void add(std::int64_t row) const {
    rows(reservePlaces(count.data(), 1)) = static_cast<int>(row);
  }
};

// Rows with contacts in the history: those with one contact first, then, backwards from the end of
// the View, those with more, which take several times as long.
struct HistoryRows {
  View<int*> rows;
  View<std::int64_t[2]> counts; // of rows with one contact, and with more

  KOKKOS_INLINE_FUNCTION void add(std::int64_t row, int num_contacts) const {
    const int kind = num_contacts > 1;
    const std::int64_t place = reservePlaces(&counts(kind), 1);
    rows(kind == 0 ? place : fromEnd(place)) = static_cast<int>(row);
  }
  // The row at a place, or -1 beyond the last one.
  KOKKOS_INLINE_FUNCTION std::int64_t row(std::int64_t place) const {
    const std::int64_t num_single = counts(0);
    if (place < num_single)
      return rows(place);
    return place < num_single + counts(1) ? rows(fromEnd(place - num_single)) : -1;
  }

private:
  KOKKOS_INLINE_FUNCTION std::int64_t fromEnd(std::int64_t place) const {
    return static_cast<std::int64_t>(rows.extent(0)) - 1 - place;
  }
};

// Lists the rows that may have a contact. Rows whose contacts may all persist on their faces, and
// which cannot get others, are listed apart: most rows of bodies that are pressed together. Kernel
// functor, for one row.
template <class Kinematics>
struct ListRows {
  SelectInteractions<Kinematics> select;
  HistoryRows persistent;
  View<int*> persistent_face; // [interaction of the last step] candidate index, of these rows
  RowList others;
  bool lists_persistent = false; // otherwise all rows are among `others`

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t row) const {
    if (!select.mayHaveContact(row))
      return;
    const int node = select.step.pairs.node(row), count = select.step.previous.row_count(node);
    if constexpr (Kinematics::projects_persistent_contacts)
      if (lists_persistent && count > 0) {
        const auto& step = select.step;
        const int first = step.previous.row_begin(node);
        const auto accept = [&](int k, int face) {
          persistent_face(first + k) = face;
          return step.faces.isOfThisStep(step.pairs.step_test, node, face) &&
                 step.kinematics.isOpposing(node, face, ContactTest::persist);
        };
        if (SelectActiveFaces<Kinematics>{step}.findFaces(row, node, first, count, accept)) {
          persistent.add(row, count);
          return;
        }
      }
    others.add(row);
  }
};

// Tests the pairs of the listed rows for SelectActiveFaces::findNearest(), several of a row at once.
// Kernel functor, for one of `num_threads`.
template <class Kinematics>
struct TestListedPairs {
  static constexpr int threads_of_row = 8;

  EnforcementStep<Kinematics> step;
  RowList list;
  std::int64_t num_threads;

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t thread) const {
    const std::int64_t end = threads_of_row * list.count();
    for (std::int64_t i = thread; i < end; i += num_threads) {
      const std::int64_t row = list.rows(i / threads_of_row), row_end = step.pairs.end(row);
      const int node = step.pairs.node(row);
      for (std::int64_t p = step.pairs.begin(row) + i % threads_of_row; p < row_end;
           p += threads_of_row)
        test(p, node);
    }
  }

private:
  KOKKOS_INLINE_FUNCTION void test(std::int64_t p, int node) const {
    const TestedPairs& tested = step.tested;
    FaceContact contact;
    const unsigned passed =
        step.kinematics.passedTests(step.faces, node, step.pairs.faces(p), contact);
    std::int64_t place = -1;
    if (passed != 0) {
      place = reservePlaces(tested.count.data(), 1);
      if (place < static_cast<std::int64_t>(tested.pairs.extent(0)))
        tested.pairs(place) = {contact, passed};
      else // the step is repeated with more memory
        place = -1;
    }
    tested.place(p) = static_cast<int>(place);
  }
};

// Writes the contacts of the rows of ListRows::persistent whose contacts all persist, with a force.
// The other rows are appended to `others`. Without friction only plain contacts persist here
// (write_interactions.hpp). Kernel functor, for one place of the list.
template <class Kinematics, bool has_friction>
struct PersistRows {
  SelectInteractions<Kinematics> select;
  HistoryRows list;
  View<const int*> persistent_face;
  RowList others;

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t place, ContactSums& sums) const {
    const std::int64_t row = list.row(place);
    if (row >= 0 && !persist(row, sums))
      others.add(row);
  }

private:
  // Returns false, without effect, if the row is not such a row.
  KOKKOS_INLINE_FUNCTION bool persist(std::int64_t row, ContactSums& sums) const {
    const auto& step = select.step;
    const SelectActiveFaces<Kinematics> rules{step};
    const WriteInteractions<Kinematics> write{step};
    const int node = step.pairs.node(row), count = step.previous.row_count(node);
    const int first = step.previous.row_begin(node);
    // All contacts but the last are tested, then the last one is tested and written, then the first
    // ones are tested again and written.
    std::int64_t begin = 0;
    double deepest = 0;
    for (int turn = 0; turn < 2 * count - 1; ++turn) {
      const int k = turn < count ? turn : turn - count;
      PersistentContact persistent;
      persistent.node = node;
      persistent.previous = first + k;
      persistent.face = persistent_face(first + k);
      FaceContact contact;
      if (!continues(rules, write, persistent, contact))
        return false;
      deepest = maxOf(deepest, contact.depth);
      if (turn + 1 < count)
        continue;
      if (turn + 1 == count) {
        begin = step.reserveSlots(count);
        sums.interactions += count;
        if (!step.hasSlots(begin, count)) // the step is repeated with more memory
          return true;
      }
      rules.recordWork(contact, sums);
      if constexpr (has_friction)
        write.writeOne(contact, begin + k, sums);
      else
        write.writePlain(contact, begin + k, sums);
    }
    sums.penetrating += count;
    step.next.row_begin(node) = static_cast<int>(begin);
    step.next.row_count(node) = count;
    step.kinematics.record(node, count, deepest);
    step.returns(node);
    select.idle.stationary.known_apart(node) = 0;
    return true;
  }

  // Whether the contact stays under load on its face, with a force; completes its data.
  KOKKOS_INLINE_FUNCTION bool continues(const SelectActiveFaces<Kinematics>& rules,
                                        const WriteInteractions<Kinematics>& write,
                                        PersistentContact& persistent, FaceContact& contact) const {
    const auto& step = select.step;
    step.kinematics.projectPersistent(step.faces, step.previous, 1, &persistent);
    contact.previous = persistent.previous;
    contact.previous_face = persistent.face;
    contact.persistent = &persistent;
    contact.has_ended = contact.releases = false;
    if (!step.kinematics.acceptPersistent(step.faces, persistent, contact) ||
        step.kinematics.isBeyondInnerEdge(step.faces, contact) ||
        !rules.isCompressive(persistent.node, contact))
      return false;
    contact.settles = step.previous.interactions(persistent.previous).settles;
    return has_friction || write.isPlain(contact);
  }
};

// Selects the contacts of the listed rows. Kernel functor, for one place of the list.
template <class Kinematics>
struct SelectListedRows {
  SelectInteractions<Kinematics> select;
  RowList list;

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t place, ContactSums& sums) const {
    if constexpr (EnforcementStep<Kinematics>::has_tested_pairs)
      if (place == 0) // one thread reports the count
        sums.tested += select.step.tested.count();
    if (place < list.count())
      select.selectRow(list.rows(place), sums);
  }
};

} // namespace brickwall::contact
