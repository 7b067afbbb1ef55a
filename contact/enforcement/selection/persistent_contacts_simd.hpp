// SIMD path for persistent node-to-face contacts that stay as they are: loaded, on the same face
// and within its edges, without friction and damping, in rows without any other contact. Most
// contacts of a body at rest under load are of this kind. As many as there are lanes are computed
// at once, with the same bits as select_active_faces.hpp and interaction_forces.hpp, which take all
// other contacts. Kernel part of SelectInteractions.
#pragma once

#include "contact/enforcement/law/interaction_forces.hpp"
#include "contact/enforcement/law/node_quanta.hpp"

namespace brickwall::contact {
namespace persistent_contacts_simd {

// Values read from the contact history, [lane].
template <class Real>
struct LastStep {
  static constexpr int width = NumLanes<Real>::value;
  double depth[width], offset[width], stiffness[width], stored[width], force[width], closing[width];
  double normal[3][width], face_area[width], is_facing[width], was_new[width];

  KOKKOS_FORCEINLINE_FUNCTION void gather(int lane, const Interaction& last, double area,
                                          bool faces) {
    depth[lane] = last.depth;
    offset[lane] = last.offset;
    stiffness[lane] = last.stiffness;
    stored[lane] = last.stored;
    force[lane] = last.force;
    closing[lane] = last.closing;
    for (int d = 0; d < 3; ++d)
      normal[d][lane] = last.normal[d];
    face_area[lane] = area;
    is_facing[lane] = faces;
    was_new[lane] = last.is_new;
  }
};

// Values of the interactions of this step, [lane].
template <class Real>
struct ThisStep {
  static constexpr int width = NumLanes<Real>::value;
  double depth[width], offset[width], stiffness[width], stored[width], closing[width];
  double first_force[width], spring_energy[width]; // spring_energy: at the half step
  double penetration[width], relative_penetration[width];
  double persists[width]; // 1: the contact qualifies, and the values are valid
  LaneQuanta<Real> quanta;

  KOKKOS_FORCEINLINE_FUNCTION void write(int lane, const persistent_contact::Found<Real>& found,
                                         Interaction& now) const {
    now.offset = offset[lane];
    now.depth = depth[lane];
    now.stiffness = stiffness[lane];
    now.fade_weight = 1;
    now.stored = stored[lane];
    now.force = now.first_force = first_force[lane];
    now.damping = now.first_damping = 0;
    now.closing = closing[lane];
    now.normal = {found.normal[0][lane], found.normal[1][lane], found.normal[2][lane]};
    for (int j = 0; j < 4; ++j)
      now.weight[j] = found.weight[j][lane];
    now.is_retained = now.is_new = 0;
    now.inverse_mass = found.inverse_mass[lane];
  }
};

// Rows that may qualify, and their contacts: row r has contacts first[r] .. first[r + 1] - 1.
template <int max_rows, int max_contacts>
struct Rows {
  int num_rows = 0, num_contacts = 0;
  std::int64_t rows[max_rows];
  int first[max_rows + 1];
  int node[max_contacts], previous[max_contacts], face[max_contacts];
};

} // namespace persistent_contacts_simd

template <class Kinematics>
struct PersistentContactsSimd : InteractionForces<Kinematics> {
  using Base = InteractionForces<Kinematics>;
  using Base::add;
  using Base::config;
  using Base::dt;
  using Base::energy_scale;
  using Base::faces;
  using Base::kinematics;
  using Base::next;
  using Base::previous;
  using Base::previous_dt;

  static constexpr int max_rows = simd_width > 1 ? 32 : 1;
  static constexpr int lanes = NumLanes<Lanes>::value;
  using PersistentRows = persistent_contacts_simd::Rows<max_rows, lanes * max_rows>;

  CandidatePairs pairs = CandidatePairs::none();
  View<std::int64_t> next_count;

  KOKKOS_FORCEINLINE_FUNCTION bool canUseSimd() const {
    return !(config.friction > 0) && !(config.damping > 0);
  }

  // Adds a row whose node has `count` > 0 interactions if it may qualify: each of them is loaded on
  // a face that is still a candidate, and no contact with another body can become active.
  KOKKOS_INLINE_FUNCTION bool addPersistentRow(std::int64_t row, int node, int count,
                                               PersistentRows& persistent_rows) const {
    if (count > lanes)
      return false;
    const int begin = previous.row_begin(node);
    for (int s = 0; s < count; ++s)
      if (!isPlainSpring(previous.interactions(begin + s)))
        return false;
    const global_id own_body = faces.surface.node_body(node);
    const std::int64_t end = pairs.end(row);
    int found = 0;
    for (std::int64_t p = pairs.begin(row); p < end; ++p) {
      const int face = pairs.faces(p);
      const FaceRecord& record = kinematics.recordOfFace(face);
      int slot = 0;
      while (slot < count && previous.interactions(begin + slot).body != record.body)
        ++slot;
      if (slot == count) {
        const bool is_tested = record.body != own_body || config.self_contact;
        if (is_tested && kinematics.mayPenetrate(faces, node, face) &&
            kinematics.mayActivate(node, face))
          return false;
      } else if (previous.interactions(begin + slot).face == record.id) {
        if (!faces.isOfThisStep(pairs.step_test, node, face))
          return false;
        const int at = persistent_rows.num_contacts + found++;
        persistent_rows.node[at] = node;
        persistent_rows.previous[at] = begin + slot;
        persistent_rows.face[at] = face;
        faces.prefetchFace(face);
      }
    }
    if (found != count)
      return false;
    persistent_rows.rows[persistent_rows.num_rows] = row;
    persistent_rows.first[persistent_rows.num_rows++] = persistent_rows.num_contacts;
    persistent_rows.num_contacts += count;
    return true;
  }
  KOKKOS_FORCEINLINE_FUNCTION static bool isPlainSpring(const Interaction& last) {
    return last.depth > 0 && last.fade_weight == 1 && !last.is_retained && last.damping == 0;
  }

  // Writes the rows that qualify, and moves the others to the front. Returns the number of others.
  KOKKOS_INLINE_FUNCTION int writePersistentRows(PersistentRows& persistent_rows,
                                                 ContactSums& sums) const {
    using namespace persistent_contacts_simd;
    if (persistent_rows.num_contacts < lanes) // mostly idle lanes cost more than they save
      return persistent_rows.num_rows;
    persistent_contact::Gathered<Lanes> gathered;
    persistent_contact::Found<Lanes> found;
    LastStep<Lanes> last;
    ThisStep<Lanes> now;
    persistent_rows.first[persistent_rows.num_rows] = persistent_rows.num_contacts;
    prefetchPersistent(persistent_rows);
    int num_left = 0;
    for (int begin = 0; begin < persistent_rows.num_rows;) {
      int end = begin + 1;
      while (end < persistent_rows.num_rows &&
             persistent_rows.first[end + 1] - persistent_rows.first[begin] <= lanes)
        ++end;
      const int first = persistent_rows.first[begin], end_contact = persistent_rows.first[end];
      for (int lane = 0; lane < lanes; ++lane)
        gather(persistent_rows, minOf(first + lane, end_contact - 1), lane, gathered, last);
      persistent_contact::evaluate(gathered, found);
      evaluate(found, last, now);
      for (; begin < end; ++begin)
        if (!write(persistent_rows, begin, first, found, now, sums))
          persistent_rows.rows[num_left++] = persistent_rows.rows[begin];
    }
    return num_left;
  }
  KOKKOS_FORCEINLINE_FUNCTION void prefetchPersistent(const PersistentRows& persistent_rows) const {
    for (int i = 0; i < persistent_rows.num_contacts; ++i) {
      const int node = persistent_rows.node[i], face = persistent_rows.face[i];
      faces.prefetchCorners(face, faces.surface.coordinates_new);
      faces.prefetchCorners(face, faces.surface.coordinates_old);
      faces.prefetchRow(add.target.nodes, node);
      faces.prefetchCorners(face, add.target.nodes);
      kinematics.prefetchAdjacentFaces(node);
    }
  }
  KOKKOS_FORCEINLINE_FUNCTION void gather(const PersistentRows& persistent_rows, int i, int lane,
                                          persistent_contact::Gathered<Lanes>& gathered,
                                          persistent_contacts_simd::LastStep<Lanes>& last) const {
    const int node = persistent_rows.node[i], face = persistent_rows.face[i];
    const Interaction& before = previous.interactions(persistent_rows.previous[i]);
    gathered.gather(lane, faces, kinematics.node_mass, before, node, face);
    const Vec3 x = rowOf(faces.surface.coordinates_new, node);
    last.gather(lane, before, kinematics.recordOfFace(face).plane.area,
                kinematics.isFacing(x, node, face, ContactTest::persist));
  }

  // The same arithmetic as NodeFaceKinematics::testPersistent(), recordWork(), persist(),
  // storedAtHalfStep() and adjustOffset(), in that order.
  template <class Real>
  KOKKOS_INLINE_FUNCTION void evaluate(const persistent_contact::Found<Real>& found,
                                       const persistent_contacts_simd::LastStep<Real>& last,
                                       persistent_contacts_simd::ThisStep<Real>& now) const {
    using Mask = typename MaskOf<Real>::type;
    const Real one = 1.0, gap = loadLanes<Real>(found.gap), penetration = -gap;
    const Real last_offset = loadLanes<Real>(last.offset);
    const Real place =
        maxOf(magnitude(loadLanes<Real>(found.xi)), magnitude(loadLanes<Real>(found.eta)));
    const Mask is_persistent =
        (loadLanes<Real>(found.is_found) == one) & (loadLanes<Real>(last.is_facing) == one) &
        (gap < Real(-kinematics.least_depth)) &
        (loadLanes<Real>(found.excess) <= Real(kinematics.lateral_tolerance)) &
        (place <= Real(kinematics.innerParameterLimit())) & (penetration > last_offset);
    const Real closing_at_last_point =
        -dot(loadTriple<Real>(last.normal), loadTriple<Real>(found.last_motion));
    const Real approach = this->kickClosing(loadLanes<Real>(last.closing), closing_at_last_point);
    const Real stored = loadLanes<Real>(last.stored) + loadLanes<Real>(last.force) * approach;
    const Triple<Real> normal = loadTriple<Real>(found.normal);
    const Real inverse_mass = loadLanes<Real>(found.inverse_mass);
    const Real last_stiffness = loadLanes<Real>(last.stiffness);
    Real stiffness = last_stiffness;
    Real offset = minOf(last_offset, penetration);
    this->soften(kinematics.template stiffnessCap<Real>(config, inverse_mass), penetration,
                 stiffness, offset);
    const Real depth = penetration - offset, force = stiffness * depth;
    const Real spring_energy = this->storedWithoutFading(last_stiffness, stiffness, Real(2.0),
                                                         loadLanes<Real>(last.depth), depth);
    if (config.scheme == Scheme::energy_neutral)
      offset = this->adjustedOffset(offset, stored, spring_energy, depth, force, depth);
    Real weight[4];
    for (int j = 0; j < 4; ++j)
      weight[j] = loadLanes<Real>(found.weight[j]);
    const NodeQuanta<Real> quanta(force, normal, weight, add.inverse_quantum);
    now.quanta.keep(quanta);
    storeLanes(depth, now.depth);
    storeLanes(offset, now.offset);
    storeLanes(stiffness, now.stiffness);
    storeLanes(stored, now.stored);
    storeLanes(-dot(normal, loadTriple<Real>(found.motion)), now.closing);
    storeLanes(force, now.first_force);
    storeLanes(this->recoverableEnergy(spring_energy, stored, loadLanes<Real>(last.was_new) == one),
               now.spring_energy);
    storeLanes(penetration, now.penetration);
    storeLanes(penetration / squareRoot(loadLanes<Real>(last.face_area)), now.relative_penetration);
    storeLanes(where(is_persistent & quanta.fits & (depth > Real(0.0)), one, Real(0.0)),
               now.persists);
  }

  // Writes row r, whose first contact is in lane persistent_rows.first[r] - first. Returns whether
  // the row qualifies.
  KOKKOS_FORCEINLINE_FUNCTION bool write(const PersistentRows& persistent_rows, int r, int first,
                                         const persistent_contact::Found<Lanes>& found,
                                         const persistent_contacts_simd::ThisStep<Lanes>& now,
                                         ContactSums& sums) const {
    const int begin = persistent_rows.first[r], count = persistent_rows.first[r + 1] - begin;
    bool persists = true;
    for (int lane = begin - first; lane < begin - first + count; ++lane)
      persists &= now.persists[lane] != 0;
    if (!persists)
      return false;
    const int node = persistent_rows.node[begin];
    const std::int64_t index = reserveSlots(count);
    next.row_begin(node) = static_cast<int>(index);
    next.row_count(node) = static_cast<unsigned char>(count);
    double deepest = 0;
    for (int i = 0; i < count; ++i) {
      const int lane = begin - first + i, face = persistent_rows.face[begin + i];
      deepest = maxOf(deepest, now.penetration[lane]);
      sums.max_penetration = maxOf(sums.max_penetration, now.relative_penetration[lane]);
      sums.terms.add(spring_stored, now.spring_energy[lane], energy_scale);
      if (index + i >= static_cast<std::int64_t>(next.interactions.extent(0)))
        continue;
      Interaction& pair = next.interactions(index + i);
      pair.body = kinematics.bodyOf(faces, face);
      pair.face = kinematics.idOf(faces, face);
      pair.node = node;
      pair.point = atNode(node);
      pair.face_index = face;
      now.write(lane, found, pair);
      add.add(pair, now.quanta.of(lane), 1);
    }
    kinematics.record(node, count, deepest);
    sums.penetrating += count;
    sums.interactions += count;
    sums.active += count;
    sums.deepest = maxOf(sums.deepest, deepest);
    return true;
  }

  KOKKOS_INLINE_FUNCTION std::int64_t reserveSlots(std::int64_t count) const {
    if (!add.is_alone)
      return Kokkos::atomic_fetch_add(next_count.data(), count);
    const std::int64_t first = next_count();
    next_count() = first + count;
    return first;
  }
};

} // namespace brickwall::contact
