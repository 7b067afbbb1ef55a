// Kernel functor that finds the contacts of a step, row by row of the candidates: rows that may
// have a contact are gathered, faces are selected (select_active_faces.hpp), and forces are written
// (write_interactions.hpp).
//
// `Kinematics` provides the geometry; its contract is in kinematics.hpp.
#pragma once

#include "contact/enforcement/dormancy/idle_rows.hpp"
#include "contact/enforcement/selection/persist_in_lanes.hpp"
#include "contact/enforcement/selection/select_active_faces.hpp"
#include "contact/enforcement/selection/write_interactions.hpp"

#include <type_traits>

namespace brickwall::contact {

// An array whose elements have no values until they are assigned.
template <class T, int size>
struct UnsetArray {
  static_assert(std::is_trivially_copyable<T>::value, "elements come to life by assignment");
  alignas(T) unsigned char bytes[size * sizeof(T)];
  KOKKOS_FORCEINLINE_FUNCTION operator T*() { return reinterpret_cast<T*>(bytes); }
};

// Takes rows_at_once rows of candidates, one row per surface node: tests the node against its
// candidates, selects one face of each opposing side and writes the node's row of `next`.
// Candidates are in the order of (side, face id), so ties go to the lower id. Rows without history
// where no contact can become active are skipped: row_count must be 0 before the launch, and
// Kinematics::record() values must be those of no contact.
template <class Kinematics>
struct SelectInteractions {
  using value_type = ContactSums;
  using Persistents = typename SelectActiveFaces<Kinematics>::Persistents;

  static constexpr int rows_at_once = simd_width > 1 ? 32 : 1;
  static constexpr std::int64_t rows_of_block = CandidatePairs::rows_per_block;
  static_assert(rows_at_once % rows_of_block == 0, "whole blocks");
  // Sides of a row whose contacts fit local arrays; a row with more is crowded, and uses the
  // workspace.
  static constexpr int max_sides = simd_width > 1 ? 16 : 4;
  static constexpr int max_persistent = simd_width > 1 ? 2 * rows_at_once : max_sides;
  static constexpr int max_selected = simd_width > 1 ? 2 * rows_at_once : 0;

  EnforcementStep<Kinematics> step;
  std::int64_t first_row = 0; // rows before it are empty
  IdleState idle;

  // Rows that may have a contact, and their persistent contacts: row r has persistent[first[r]] ..
  // persistent[first[r + 1] - 1]. A crowded row is alone in its batch.
  struct Batch {
    int num_rows = 0, num_persistent = 0;
    std::int64_t rows[rows_at_once];
    int first[rows_at_once + 1];
    UnsetArray<PersistentContact, max_persistent> local;
    PersistentContact* persistent = local;
    FaceContact* crowded = nullptr; // room for the contacts of a crowded row
  };

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t part, ContactSums& sums) const {
    std::int64_t awake_rows[rows_at_once];
    int num_awake_rows = 0;
    forAwakeRows(part, [&](std::int64_t row) {
      if (!isEmpty(row) && !idle.stationary.isKnownApart(step.pairs, row))
        awake_rows[num_awake_rows++] = row;
    });
    // They arrive while this part is selected.
    forAwakeRows(part + 2, [&](std::int64_t row) { prefetchHead(step.pairs.node(row)); });
    forAwakeRows(part + 1, [&](std::int64_t row) { prefetchRow(row); });
    if (num_awake_rows == 0)
      return;
    if constexpr (Kinematics::tests_rows_at_once) {
      num_awake_rows = keepRowsThatMayActivate(awake_rows, num_awake_rows);
      if (num_awake_rows == 0)
        return;
    }
    if constexpr (simd_width > 1 && Kinematics::projects_persistent_contacts)
      num_awake_rows = PersistInLanes<Kinematics, rows_at_once>{step, idle.stationary.known_apart}(
          awake_rows, num_awake_rows, sums);
    selectBatches(awake_rows, num_awake_rows, sums);
  }
  // Calls body(row) for the rows of a part whose blocks are awake.
  template <class Body>
  KOKKOS_FORCEINLINE_FUNCTION void forAwakeRows(std::int64_t part, const Body& body) const {
    const std::int64_t begin = part * rows_at_once;
    const std::int64_t end = minOf<std::int64_t>(begin + rows_at_once, step.pairs.num_rows);
    for (std::int64_t first = begin; first < end; first += rows_of_block)
      if (!idle.sleeps(first / rows_of_block))
        for (std::int64_t row = first; row < minOf(first + rows_of_block, end); ++row)
          body(row);
  }
  // The tests by which operator() rejects rows, for one row.
  KOKKOS_INLINE_FUNCTION bool mayHaveContact(std::int64_t row) const {
    if (idle.sleeps(row / rows_of_block))
      return false;
    if (isEmpty(row) || idle.stationary.isKnownApart(step.pairs, row))
      return false;
    if constexpr (Kinematics::tests_rows_at_once) {
      return keepRowsThatMayActivate(&row, 1) > 0;
    } else {
      const int node = step.pairs.node(row);
      std::int64_t penetrating;
      return keepRowsThatMayPenetrate(&row, 1, &penetrating) > 0 &&
             (step.previous.row_count(node) > 0 || rowMayActivate(row, node, penetrating));
    }
  }
  // Selects the contacts of a row for which mayHaveContact() is true.
  KOKKOS_INLINE_FUNCTION void selectRow(std::int64_t row, ContactSums& sums) const {
    Batch batch;
    const int count = step.previous.row_count(step.pairs.node(row)), crowd = crowdOf(row, count);
    if (crowd > 0 && !useWorkspace(batch, crowd, sums))
      return;
    addRow(row, count, batch);
    selectBatch(batch, sums);
  }
  KOKKOS_INLINE_FUNCTION void selectBatches(std::int64_t* awake_rows, int num_awake_rows,
                                            ContactSums& sums) const {
    Batch batch;
    // of rows without history: the first pair that may penetrate
    std::int64_t penetrating[rows_at_once];
    if constexpr (!Kinematics::tests_rows_at_once)
      num_awake_rows = keepRowsThatMayPenetrate(awake_rows, num_awake_rows, penetrating);
    for (int r = 0; r < num_awake_rows; ++r) {
      const std::int64_t row = awake_rows[r];
      const int node = step.pairs.node(row), count = step.previous.row_count(node);
      if constexpr (!Kinematics::tests_rows_at_once)
        if (count == 0 && !rowMayActivate(row, node, penetrating[r]))
          continue;
      const int crowd = crowdOf(row, count);
      if (crowd > 0 || batch.crowded != nullptr || batch.num_persistent + count > max_persistent)
        selectBatch(batch, sums);
      if (crowd > 0 && !useWorkspace(batch, crowd, sums))
        continue;
      addRow(row, count, batch);
    }
    selectBatch(batch, sums);
  }
  KOKKOS_FORCEINLINE_FUNCTION void addRow(std::int64_t row, int count, Batch& batch) const {
    batch.rows[batch.num_rows] = row;
    batch.first[batch.num_rows++] = batch.num_persistent;
    if constexpr (Kinematics::projects_candidates_at_once)
      prefetchFaces(row);
    if (count > 0) {
      const int node = step.pairs.node(row);
      idle.stationary.known_apart(node) = 0;
      if constexpr (Kinematics::projects_persistent_contacts)
        step.steady.forget(node);
      findPersistent(row, node, count, batch);
    }
  }
  // Whether the row has neither a candidate nor a contact in the history.
  KOKKOS_FORCEINLINE_FUNCTION bool isEmpty(std::int64_t row) const {
    if (step.pairs.begin(row) != step.pairs.end(row))
      return false;
    const int node = step.pairs.node(row);
    const bool is_empty = step.previous.row_count(node) == 0;
    if (is_empty)
      idle.stationary.known_apart(node) = 1;
    return is_empty;
  }
  // The data of a row are scattered in memory, so those of a part are prefetched while the part
  // before it is selected, and the heads of its rows one part earlier.
  KOKKOS_FORCEINLINE_FUNCTION void prefetchHead(int node) const {
    step.kinematics.prefetchHead(node);
    prefetch(&step.previous.row_count(node));
    prefetch(&step.previous.row_begin(node));
    if (step.steady.are_known)
      prefetch(&step.steady.last_step(node));
  }
  KOKKOS_FORCEINLINE_FUNCTION void prefetchRow(std::int64_t row) const {
    const int node = step.pairs.node(row);
    brickwall::prefetchRow(step.faces.surface.coordinates_new, node);
    const std::int64_t begin = step.pairs.begin(row), end = step.pairs.end(row);
    if (step.previous.row_count(node) == 0) {
      for (std::int64_t p = begin; p < end; ++p)
        step.kinematics.prefetchFace(step.pairs.faces(p));
      return;
    }
    if (begin < end && !step.steady.isSteady(row, node)) {
      step.kinematics.prefetchSide(step.faces, step.pairs.faces(begin));
      step.kinematics.prefetchSide(step.faces, step.pairs.faces(end - 1));
      prefetch(&step.faces.surface.node_body(node));
    }
    brickwall::prefetchRow(step.faces.surface.coordinates_old, node);
    step.previous.interactions.prefetch(step.previous.row_begin(node));
    step.kinematics.prefetchNode(node);
  }
  // Keeps rows with history, and rows without history where a node may penetrate by its position;
  // prefetches the data of the tests that follow. `known_apart` flags the others: none of their
  // pairs could be in contact however the faces around the node were oriented. Returns the number
  // of rows kept.
  KOKKOS_INLINE_FUNCTION int keepRowsThatMayPenetrate(std::int64_t* rows, int count,
                                                      std::int64_t* penetrating) const {
    int num_kept = 0;
    for (int r = 0; r < count; ++r) {
      const std::int64_t row = rows[r], end = step.pairs.end(row);
      const int node = step.pairs.node(row);
      std::int64_t p = step.pairs.begin(row);
      if (step.previous.row_count(node) == 0) {
        while (p < end && !step.kinematics.mayPenetrate(step.faces, node, step.pairs.faces(p)))
          ++p;
        idle.stationary.known_apart(node) = p == end;
        if (p == end)
          continue;
        step.kinematics.prefetchNode(node);
      }
      rows[num_kept] = row;
      penetrating[num_kept++] = p;
    }
    for (int r = 0; r < num_kept; ++r)
      if (step.previous.row_count(step.pairs.node(rows[r])) == 0)
        step.kinematics.prefetchAdjacentFaces(step.pairs.node(rows[r]));
    return num_kept;
  }
  // Whether a contact may become active among the pairs from `penetrating` on, which itself may
  // penetrate.
  KOKKOS_INLINE_FUNCTION bool rowMayActivate(std::int64_t row, int node,
                                             std::int64_t penetrating) const {
    const std::int64_t end = step.pairs.end(row);
    bool may_activate = step.kinematics.mayActivate(node, step.pairs.faces(penetrating));
    for (std::int64_t p = penetrating + 1; p < end && !may_activate; ++p)
      may_activate = step.kinematics.mayPenetrate(step.faces, node, step.pairs.faces(p)) &&
                     step.kinematics.mayActivate(node, step.pairs.faces(p));
    return may_activate;
  }
  // The same for several rows at once by Kinematics::rowsThatMayActivate(). Keeps these rows and
  // those with history; returns their number.
  KOKKOS_INLINE_FUNCTION int keepRowsThatMayActivate(std::int64_t* rows, int count) const {
    static_assert(rows_at_once <= 32, "a bit for each row");
    unsigned without_history = 0;
    for (int r = 0; r < count; ++r)
      without_history |=
          static_cast<unsigned>(step.previous.row_count(step.pairs.node(rows[r])) == 0) << r;
    const unsigned activating =
        step.kinematics.rowsThatMayActivate(step.faces, step.pairs, rows, count, without_history);
    int num_kept = 0;
    for (int r = 0; r < count; ++r) {
      const std::int64_t row = rows[r];
      const bool has_none = without_history >> r & 1u, may_activate = activating >> r & 1u;
      if (has_none)
        idle.stationary.known_apart(step.pairs.node(row)) = !may_activate;
      rows[num_kept] = row;
      num_kept += !has_none || may_activate;
    }
    return num_kept;
  }
  // The number of sides of a crowded row, 0 for others. `count`: its contacts in the history.
  KOKKOS_INLINE_FUNCTION int crowdOf(std::int64_t row, int count) const {
    const std::int64_t begin = step.pairs.begin(row), end = step.pairs.end(row);
    if (maxOf<std::int64_t>(end - begin, count) <= max_sides)
      return 0;
    int num_sides = 0;
    for (std::int64_t p = begin; p < end; ++p)
      num_sides += p == begin || sideOf(p) != sideOf(p - 1);
    const int crowd = maxOf(num_sides, count);
    return crowd > max_sides ? crowd : 0;
  }
  KOKKOS_INLINE_FUNCTION global_id sideOf(std::int64_t pair) const {
    return step.kinematics.sideOf(step.faces, step.pairs.faces(pair));
  }
  // Takes workspace for an empty batch. Returns false if there is too little: the step is then
  // repeated with more.
  KOKKOS_INLINE_FUNCTION bool useWorkspace(Batch& batch, int crowd, ContactSums& sums) const {
    sums.workspace += crowd;
    const std::int64_t place = step.workspace.reserve(crowd);
    if (place < 0)
      return false;
    batch.persistent = &step.workspace.persistent(place);
    batch.crowded = &step.workspace.contacts(place);
    return true;
  }
  // Candidates and the row of the history are in the order of (side, face id).
  KOKKOS_INLINE_FUNCTION void findPersistent(std::int64_t row, int node, int count,
                                             Batch& batch) const {
    const std::int64_t pairs_end = step.pairs.end(row);
    std::int64_t next = step.pairs.begin(row);
    const int begin = step.previous.row_begin(node);
    const SelectActiveFaces<Kinematics> rules{step};
    for (int i = begin; i < begin + count; ++i) {
      const Interaction& last = step.previous.interactions(i);
      std::int64_t p = next;
      while (p < pairs_end && !rules.isFaceOf(last, step.pairs.faces(p)))
        ++p;
      if (p == pairs_end)
        continue;
      next = p + 1;
      const int face = step.pairs.faces(p);
      if (!step.faces.isOfThisStep(step.pairs.step_test, node, face))
        continue;
      PersistentContact& contact = batch.persistent[batch.num_persistent++];
      contact.node = node;
      contact.previous = i;
      contact.face = face;
      step.kinematics.prefetchFace(face);
      step.faces.prefetchFace(face);
    }
  }
  // What findNearest() reads of the faces of a row: numbers and attributes first, then corners.
  KOKKOS_FORCEINLINE_FUNCTION void prefetchFaces(std::int64_t row) const {
    for (std::int64_t p = step.pairs.begin(row); p < step.pairs.end(row); ++p)
      step.faces.prefetchFace(step.pairs.faces(p));
  }
  KOKKOS_FORCEINLINE_FUNCTION void prefetchCorners(std::int64_t row) const {
    for (std::int64_t p = step.pairs.begin(row); p < step.pairs.end(row); ++p) {
      step.faces.prefetchCorners(step.pairs.faces(p), step.faces.surface.coordinates_new);
      step.faces.prefetchCorners(step.pairs.faces(p), step.faces.surface.coordinates_old);
    }
  }
  KOKKOS_INLINE_FUNCTION void selectBatch(Batch& batch, ContactSums& sums) const {
    if (batch.num_rows == 0)
      return;
    if constexpr (Kinematics::projects_candidates_at_once)
      for (int r = 0; r < batch.num_rows; ++r)
        prefetchCorners(batch.rows[r]);
    for (int k = 0; k < batch.num_persistent; ++k)
      step.add.prefetchTarget(batch.persistent[k].node, batch.persistent[k].face);
    step.kinematics.projectPersistent(step.faces, step.previous, batch.num_persistent,
                                      batch.persistent);
    batch.first[batch.num_rows] = batch.num_persistent;
    const WriteInteractions<Kinematics> write{step};
    UnsetArray<FaceContact, max_selected + max_sides> local; // room for one more row
    FaceContact* contacts =
        batch.crowded != nullptr ? batch.crowded : static_cast<FaceContact*>(local);
    int num_selected = 0;
    // On devices 1: no loop, and one call of writeAll(), which is inlined. For a function that is
    // not, each thread copies the arguments of the kernel to memory.
    const int num_rows = minOf(batch.num_rows, rows_at_once);
    for (int r = 0; r < num_rows; ++r) {
      if (rows_at_once > 1 && num_selected > max_selected) {
        write.writeAll(contacts, num_selected, sums);
        num_selected = 0;
      }
      num_selected += selectOfRow(
          batch.rows[r], {batch.persistent + batch.first[r], batch.first[r + 1] - batch.first[r]},
          contacts + num_selected, sums);
    }
    write.writeAll(contacts, num_selected, sums);
    batch.num_rows = batch.num_persistent = 0;
    batch.persistent = batch.local;
    batch.crowded = nullptr;
  }

  // Writes the contacts of the row that have a force to `contacts`, which has room for one for each
  // side of the row. Returns their number.
  KOKKOS_INLINE_FUNCTION int selectOfRow(std::int64_t row, const Persistents& persistent,
                                         FaceContact* contacts, ContactSums& sums) const {
    const SelectActiveFaces<Kinematics> select{step};
    const int node = step.pairs.node(row);
    const int num_contacts = select.selectActiveFaces(row, node, persistent, contacts, sums);
    select.countLost(node, persistent, sums);
    const bool returns = step.returns(node);
    double deepest = 0;
    for (int h = 0; h < num_contacts; ++h) {
      deepest = maxOf(deepest, contacts[h].depth);
      contacts[h].is_compressive = select.isCompressive(node, contacts[h]);
      contacts[h].settles = contacts[h].is_persistent
                                ? step.previous.interactions(contacts[h].previous).settles
                                : returns && contacts[h].slides();
    }
    for (int h = 0; h < num_contacts; ++h)
      if (contacts[h].is_compressive && !contacts[h].is_persistent)
        contacts[h].activation_stiffness = step.kinematics.stiffnessAtActivation(
            step.law.config, step.faces, contacts[h], contacts, num_contacts);
    step.kinematics.record(node, num_contacts, deepest);
    sums.penetrating += num_contacts;
    int num_compressive = 0;
    for (int h = 0; h < num_contacts; ++h)
      if (contacts[h].is_compressive) {
        if (num_compressive < h)
          contacts[num_compressive] = contacts[h];
        ++num_compressive;
      }
    step.next.row_count(node) = num_compressive;
    return num_compressive;
  }
};

} // namespace brickwall::contact
