// Contacts of nodes that go on as they were: under load, on the face that they had and not beyond its edges, without friction and
// damping, in rows where nothing else happens. Most contacts of a body at rest under load are such. Worked out for as many at once
// as there are lanes; the same bits as select_active_faces.hpp and interaction_forces.hpp give, which take all others. Kernel part of
// SelectInteractions.
#pragma once

#include "contact/enforcement/law/interaction_forces.hpp"
#include "contact/enforcement/law/node_quanta.hpp"

namespace brickwall::contact {
namespace persistent_contacts_simd {

// What is asked of the interactions of the last step.
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

// What an interaction becomes.
template <class Real>
struct ThisStep {
  static constexpr int width = NumLanes<Real>::value;
  double depth[width], offset[width], stiffness[width], stored[width], closing[width];
  double first_force[width], held[width]; // energy in the spring at the half step
  double penetration[width], relative_penetration[width];
  double is_steady[width]; // 1: all of this holds
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
    now.is_held = now.is_new = 0;
    now.inverse_mass = found.inverse_mass[lane];
  }
};

// Rows that may be steady, and their contacts: row r has [first[r], first[r + 1]).
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
  using Base::next;
  using Base::previous;
  using Base::previous_dt;
  using Base::touch;

  static constexpr int max_rows = simd_width > 1 ? 32 : 1;
  static constexpr int lanes = NumLanes<Lanes>::value;
  using SteadyRows = persistent_contacts_simd::Rows<max_rows, lanes * max_rows>;

  CandidatePairs pairs = CandidatePairs::none();
  View<std::int64_t> next_count;

  KOKKOS_FORCEINLINE_FUNCTION bool hasSteady() const {
    return !(config.friction > 0) && !(config.damping > 0);
  }

  // Adds a row whose node has `count` > 0 interactions, if it may be steady: each is under load on a face that still is a candidate,
  // and nothing can be born on other bodies.
  KOKKOS_INLINE_FUNCTION bool addSteady(std::int64_t row, int node, int count,
                                        SteadyRows& steady) const {
    if (count > lanes)
      return false;
    const int begin = previous.row_begin(node);
    for (int s = 0; s < count; ++s)
      if (!isPlain(previous.interactions(begin + s)))
        return false;
    const global_id own_body = faces.surface.node_body(node);
    const std::int64_t end = pairs.end(row);
    int found = 0;
    for (std::int64_t p = pairs.begin(row); p < end; ++p) {
      const int face = pairs.faces(p);
      const FaceRecord& record = touch.recordOfFace(face);
      int slot = 0;
      while (slot < count && previous.interactions(begin + slot).body != record.body)
        ++slot;
      if (slot == count) {
        const bool is_wanted = record.body != own_body || config.self_contact;
        if (is_wanted && touch.mayPenetrate(faces, node, face) && touch.mayActivate(node, face))
          return false;
      } else if (previous.interactions(begin + slot).face == record.id) {
        if (!faces.isOfThisStep(pairs.step_test, node, face))
          return false;
        const int at = steady.num_contacts + found++;
        steady.node[at] = node;
        steady.previous[at] = begin + slot;
        steady.face[at] = face;
        faces.prefetchFace(face);
      }
    }
    if (found != count)
      return false;
    steady.rows[steady.num_rows] = row;
    steady.first[steady.num_rows++] = steady.num_contacts;
    steady.num_contacts += count;
    return true;
  }
  KOKKOS_FORCEINLINE_FUNCTION static bool isPlain(const Interaction& last) {
    return last.depth > 0 && last.fade_weight == 1 && !last.is_held && last.damping == 0;
  }

  // Writes the rows that are steady; the others are then the first ones. Returns how many they are.
  KOKKOS_INLINE_FUNCTION int writeSteady(SteadyRows& steady, ContactSums& sums) const {
    using namespace persistent_contacts_simd;
    if (steady.num_contacts < lanes) // lanes that are mostly idle cost more than they save
      return steady.num_rows;
    persistent_contact::Gathered<Lanes> gathered;
    persistent_contact::Found<Lanes> found;
    LastStep<Lanes> last;
    ThisStep<Lanes> now;
    steady.first[steady.num_rows] = steady.num_contacts;
    prefetchSteady(steady);
    int num_left = 0;
    for (int begin = 0; begin < steady.num_rows;) {
      int end = begin + 1;
      while (end < steady.num_rows && steady.first[end + 1] - steady.first[begin] <= lanes)
        ++end;
      const int first = steady.first[begin], behind = steady.first[end];
      for (int lane = 0; lane < lanes; ++lane)
        gather(steady, minOf(first + lane, behind - 1), lane, gathered, last);
      persistent_contact::evaluate(gathered, found);
      evaluate(found, last, now);
      for (; begin < end; ++begin)
        if (!write(steady, begin, first, found, now, sums))
          steady.rows[num_left++] = steady.rows[begin];
    }
    return num_left;
  }
  KOKKOS_FORCEINLINE_FUNCTION void prefetchSteady(const SteadyRows& steady) const {
    for (int i = 0; i < steady.num_contacts; ++i) {
      const int node = steady.node[i], face = steady.face[i];
      faces.prefetchCorners(face, faces.surface.coordinates_new);
      faces.prefetchCorners(face, faces.surface.coordinates_old);
      faces.prefetchRow(add.target.nodes, node);
      faces.prefetchCorners(face, add.target.nodes);
      touch.prefetchAround(node);
    }
  }
  KOKKOS_FORCEINLINE_FUNCTION void gather(const SteadyRows& steady, int i, int lane,
                                          persistent_contact::Gathered<Lanes>& gathered,
                                          persistent_contacts_simd::LastStep<Lanes>& last) const {
    const int node = steady.node[i], face = steady.face[i];
    const Interaction& before = previous.interactions(steady.previous[i]);
    gathered.gather(lane, faces, touch.node_mass, before, node, face);
    const Vec3 x = rowOf(faces.surface.coordinates_new, node);
    last.gather(lane, before, touch.recordOfFace(face).plane.area,
                touch.isFacing(x, node, face, ContactTest::persist));
  }

  // As NodeFaceKinematics::testAgain(), bookWork(), continueContact(), storedBetween() and followWork() do, in that order.
  template <class Real>
  KOKKOS_INLINE_FUNCTION void evaluate(const persistent_contact::Found<Real>& found,
                                       const persistent_contacts_simd::LastStep<Real>& last,
                                       persistent_contacts_simd::ThisStep<Real>& now) const {
    using Mask = typename MaskOf<Real>::type;
    const Real one = 1.0, gap = loadLanes<Real>(found.gap), penetration = -gap;
    const Real last_offset = loadLanes<Real>(last.offset);
    const Real place =
        maxOf(magnitude(loadLanes<Real>(found.xi)), magnitude(loadLanes<Real>(found.eta)));
    const Mask is_kept = (loadLanes<Real>(found.is_found) == one) &
                         (loadLanes<Real>(last.is_facing) == one) &
                         (gap < Real(-touch.least_depth)) &
                         (loadLanes<Real>(found.excess) <= Real(touch.lateral_tolerance)) &
                         (place <= Real(touch.farthestSteady())) & (penetration > last_offset);
    const Real closing_before =
        -dot(loadTriple<Real>(last.normal), loadTriple<Real>(found.last_motion));
    const Real way = this->closingOfKick(loadLanes<Real>(last.closing), closing_before);
    const Real stored = loadLanes<Real>(last.stored) + loadLanes<Real>(last.force) * way;
    const Triple<Real> normal = loadTriple<Real>(found.normal);
    const Real inverse_mass = loadLanes<Real>(found.inverse_mass);
    const Real last_stiffness = loadLanes<Real>(last.stiffness);
    Real stiffness = last_stiffness;
    Real offset = minOf(last_offset, penetration);
    this->soften(touch.template stiffnessCap<Real>(config, inverse_mass), penetration, stiffness,
                 offset);
    const Real depth = penetration - offset, force = stiffness * depth;
    const Real held = this->storedWithoutFading(last_stiffness, stiffness, Real(2.0),
                                                loadLanes<Real>(last.depth), depth);
    if (config.scheme == Scheme::energy_neutral)
      offset = this->offsetThatFollows(offset, stored, held, depth, force, depth);
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
    storeLanes(this->toBeReturned(held, stored, loadLanes<Real>(last.was_new) == one), now.held);
    storeLanes(penetration, now.penetration);
    storeLanes(penetration / squareRoot(loadLanes<Real>(last.face_area)), now.relative_penetration);
    storeLanes(where(is_kept & quanta.fits & (depth > Real(0.0)), one, Real(0.0)), now.is_steady);
  }

  // A row whose contacts start at lane `first contact of the row` - `first`. Returns whether it is steady.
  KOKKOS_FORCEINLINE_FUNCTION bool write(const SteadyRows& steady, int r, int first,
                                         const persistent_contact::Found<Lanes>& found,
                                         const persistent_contacts_simd::ThisStep<Lanes>& now,
                                         ContactSums& sums) const {
    const int begin = steady.first[r], count = steady.first[r + 1] - begin;
    bool is_steady = true;
    for (int lane = begin - first; lane < begin - first + count; ++lane)
      is_steady &= now.is_steady[lane] != 0;
    if (!is_steady)
      return false;
    const int node = steady.node[begin];
    const std::int64_t index = takePlaces(count);
    next.row_begin(node) = static_cast<int>(index);
    next.row_count(node) = static_cast<unsigned char>(count);
    double deepest = 0;
    for (int i = 0; i < count; ++i) {
      const int lane = begin - first + i, face = steady.face[begin + i];
      deepest = maxOf(deepest, now.penetration[lane]);
      sums.max_penetration = maxOf(sums.max_penetration, now.relative_penetration[lane]);
      sums.terms.add(spring_stored, now.held[lane], energy_scale);
      if (index + i >= static_cast<std::int64_t>(next.interactions.extent(0)))
        continue;
      Interaction& pair = next.interactions(index + i);
      pair.body = touch.bodyOf(faces, face);
      pair.face = touch.idOf(faces, face);
      pair.node = node;
      pair.point = atNode(node);
      pair.face_index = face;
      now.write(lane, found, pair);
      add.add(pair, now.quanta.of(lane), 1);
    }
    touch.record(node, count, deepest);
    sums.touching += count;
    sums.interactions += count;
    sums.active += count;
    sums.deepest = maxOf(sums.deepest, deepest);
    return true;
  }

  KOKKOS_INLINE_FUNCTION std::int64_t takePlaces(std::int64_t count) const {
    if (!add.is_alone)
      return Kokkos::atomic_fetch_add(next_count.data(), count);
    const std::int64_t first = next_count();
    next_count() = first + count;
    return first;
  }
};

} // namespace brickwall::contact
