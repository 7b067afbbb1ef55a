// Rows whose contacts all stay under load on their faces and cannot get others: most rows of bodies
// that are pressed together. Their contacts are projected, tested and written in SIMD lanes,
// straight from the contact history; friction is added one by one. Kernel part of
// SelectInteractions on processors; PersistRows (row_lists.hpp) is that of devices.
#pragma once

#include "contact/base/lane_sums.hpp"
#include "contact/enforcement/selection/select_active_faces.hpp"
#include "contact/enforcement/selection/write_interactions.hpp"

namespace brickwall::contact {

template <class Kinematics, int max_rows, class Real = Lanes>
struct PersistInLanes {
  static constexpr int width = NumLanes<Real>::value;
  static constexpr int max_contacts = 2 * max_rows;
  static_assert(max_contacts % width == 0, "whole packs");

  const EnforcementStep<Kinematics>& step;
  const View<unsigned char*>& known_apart;

  // Writes the contacts of such rows. Moves the other rows to the front, and returns their number.
  int operator()(std::int64_t* rows, int num_rows, ContactSums& sums) const {
    Batch batch;
    int num_kept = 0;
    for (int r = 0; r < num_rows; ++r)
      if (!add(rows[r], batch))
        rows[num_kept++] = rows[r];
    test(batch);
    int num_contacts = 0;
    for (int t = 0; t < batch.num_rows; ++t) {
      Row& row = batch.rows[t];
      for (int i = row.first; i < row.first + row.count; ++i)
        row.persists = row.persists && batch.places[i].persists;
      if (row.persists)
        num_contacts += row.count;
      else
        rows[num_kept++] = row.number;
    }
    if (num_contacts > 0)
      write(batch, num_contacts, sums);
    return num_kept;
  }

private:
  struct Place {
    int node, previous, face;
    std::int64_t next; // index in the next history, or -1
    bool persists;
  };
  struct Row {
    std::int64_t number;
    int node, first, count;
    bool persists;
  };
  struct Batch {
    int num_rows = 0, count = 0;
    Row rows[max_rows];
    Place places[max_contacts];
    persistent_contact::Found<Real> found[max_contacts / width];
  };

  bool add(std::int64_t number, Batch& batch) const {
    const int node = step.pairs.node(number), count = step.previous.row_count(node);
    if (count == 0 || batch.count + count > max_contacts)
      return false;
    const int first = step.previous.row_begin(node);
    const auto accept = [&](int k, int face) {
      const Interaction& last = step.previous.interactions(first + k);
      if (last.fade_weight < 1 || last.settles || last.is_retained)
        return false;
      step.kinematics.prefetchFace(face);
      step.faces.prefetchFace(face);
      batch.places[batch.count + k] = {node, first + k, face, -1, true};
      return true;
    };
    if (!SelectActiveFaces<Kinematics>{step}.findFaces(number, node, first, count, accept))
      return false;
    step.kinematics.prefetchAdjacentFaces(node);
    batch.rows[batch.num_rows++] = {number, node, batch.count, count, true};
    batch.count += count;
    return true;
  }

  // Projects the contacts, and finds which persist with a force.
  void test(Batch& batch) const {
    const SweptBoxes& surface = step.faces.surface;
    for (int i = 0; i < batch.count; ++i) {
      Place& place = batch.places[i];
      step.faces.prefetchCorners(place.face, surface.coordinates_new);
      step.faces.prefetchCorners(place.face, surface.coordinates_old);
      step.add.prefetchTarget(place.node, place.face);
      place.persists = step.kinematics.isOpposing(place.node, place.face, ContactTest::persist);
    }
    persistent_contact::Gathered<Real> gathered;
    for (int first = 0; first < batch.count; first += width) {
      LaneArray<Real> offset, reach, persists;
      for (int lane = 0; lane < width; ++lane) {
        const Place& place = batch.places[minOf(first + lane, batch.count - 1)];
        const Interaction& last = step.previous.interactions(place.previous);
        gathered.gather(lane, step.faces, step.kinematics.node_mass, last, place.node, place.face);
        offset[lane] = last.offset;
        reach[lane] = step.kinematics.reachOf(step.faces.attributes(place.face));
      }
      auto& found = batch.found[first / width];
      evaluate(gathered, found);
      persists =
          where(step.kinematics.staysInside(found, Real(reach)) & (-Real(found.gap) > Real(offset)),
                Real(1.0), Real(0.0));
      const int count = minOf(width, batch.count - first);
      for (int lane = 0; lane < count; ++lane)
        batch.places[first + lane].persists &= persists[lane] != 0;
      if (step.pairs.step_test.is_needed)
        testBoxes(gathered, batch.places + first, count);
    }
  }
  // Whether a search in this step would list them: most are too near to need their boxes.
  void testBoxes(const persistent_contact::Gathered<Real>& gathered, Place* places,
                 int count) const {
    const StepTest& boxes = step.pairs.step_test;
    const double reach = 0.5 * (boxes.node_tolerance + boxes.face_tolerance);
    LaneArray<Real> is_near;
    is_near = where(isWithin(reach, gathered), Real(1.0), Real(0.0));
    for (int lane = 0; lane < count; ++lane) {
      Place& place = places[lane];
      place.persists = place.persists && (is_near[lane] != 0 ||
                                          step.faces.isOfThisStep(boxes, place.node, place.face));
    }
  }

  // Writes the contacts of rows that persist, and the values of their nodes.
  void write(Batch& batch, int num_contacts, ContactSums& sums) const {
    std::int64_t next = step.reserveSlots(num_contacts);
    sums.interactions += num_contacts;
    if (!step.hasSlots(next, num_contacts)) // the step is repeated with more memory
      return;
    sums.penetrating += num_contacts;
    for (int t = 0; t < batch.num_rows; ++t) {
      const Row& row = batch.rows[t];
      if (!row.persists)
        continue;
      double deepest = 0;
      step.next.row_begin(row.node) = static_cast<int>(next);
      step.next.row_count(row.node) = row.count;
      for (int i = row.first; i < row.first + row.count; ++i) {
        step.next.interactions.prefetch(next);
        if (step.law.config.friction > 0) {
          step.previous.friction.prefetch(batch.places[i].previous);
          step.next.friction.prefetch(next);
        }
        deepest = maxOf(deepest, -batch.found[i / width].gap[i % width]);
        batch.places[i].next = next++;
      }
      step.kinematics.record(row.node, row.count, deepest);
      step.returns(row.node);
      known_apart(row.node) = 0;
    }
    const SplitScale scale = SplitScale::of(step.energy_scale);
    LaneSums<1, width> stored;
    for (int first = 0; first < batch.count; first += width) {
      stored.add(0,
                 writePack(batch.places + first, minOf(width, batch.count - first),
                           batch.found[first / width], sums),
                 scale);
      stored.endRow();
    }
    stored.foldInto(sums.terms, {spring_stored}, {&scale});
  }
  // Returns the stored energies.
  Real writePack(const Place* places, int count, const persistent_contact::Found<Real>& found,
                 ContactSums& sums) const {
    const WriteInteractions<Kinematics> write{step};
    ContactState<Real> state;
    LaneTriple<Real> last_normal;
    LaneArray<Real> last_force, last_closing, closing, area, relative_depth, fits, bound,
        is_written;
    bound = step.kinematics.stiffnessCap(step.law.config, Real(found.inverse_mass));
    for (int lane = 0; lane < width; ++lane) {
      const Place& place = places[minOf(lane, count - 1)];
      const Interaction& last = step.previous.interactions(place.previous);
      state.recall(lane, last);
      is_written[lane] = lane < count && place.next >= 0;
      last_normal.set(lane, last.normal);
      last_force[lane] = last.force;
      last_closing[lane] = last.closing;
      area[lane] = step.kinematics.areaOf(place.face);
      state.cap_factor[lane] = write.capFactor(place.node, place.face, last.stiffness, bound[lane]);
    }
    const Real none = 0.0, one = 1.0;
    const Real closing_now = -dot(Triple<Real>(last_normal), Triple<Real>(found.last_motion));
    closing = step.law.kickClosing(Real(last_closing), closing_now);
    state.closing_at_last_point = closing_now;
    state.contact_work = Real(last_force) * Real(closing);
    state.normal = found.normal;
    state.motion = found.motion;
    state.penetration = -Real(found.gap);
    state.inverse_mass = found.inverse_mass;
    state.is_persistent = state.depth_factor = state.activation_stiffness = one;
    state.has_changed_face = none;
    PairQuanta<Real> quanta;
    const Real weights[4] = {found.weight[0], found.weight[1], found.weight[2], found.weight[3]};
    write.apply(state, none, weights, quanta);
    relative_depth = Real(state.penetration) / squareRoot(Real(area));
    fits = where(quanta.fits, one, none);
    for (int lane = 0; lane < count; ++lane) {
      const Place& place = places[lane];
      if (place.next < 0)
        continue;
      const Interaction& last = step.previous.interactions(place.previous);
      Interaction& now = step.next.interactions(place.next);
      now = last;
      state.write(lane, now);
      now.normal = found.normal.of(lane);
      for (int j = 0; j < 4; ++j)
        now.weight[j] = found.weight[j][lane];
      now.node = place.node;
      now.point = atNode(place.node);
      now.face_index = place.face;
      if (last.damping != 0)
        sums.terms.add(damping_work, -last.damping * closing[lane], step.energy_scale);
      if (now.depth > 0)
        write.count(state.penetration[lane], relative_depth[lane], sums);
      if (step.law.config.friction > 0) {
        step.recordFrictionWork(place.previous, found.last_motion.of(lane), place.face, sums);
        write.addForces(now, place.next, state.penetration[lane], found.motion.of(lane),
                        place.previous, {}, sums);
      } else if (fits[lane] != 0) {
        step.add.add(now, quanta, 1, lane);
      } else {
        ++sums.invalid;
      }
    }
    return where(Real(is_written) == none, none, Real(state.recoverable));
  }
};

} // namespace brickwall::contact
