// The interactions of one kind of contact (node-to-face or edge-to-edge) from step to step, and
// their forces.
#pragma once

#include "contact/base/sum_over.hpp"
#include "contact/enforcement/law/contact_records.hpp"
#include "contact/enforcement/law/correct_pair.hpp"
#include "contact/enforcement/law/enforcement_config.hpp"
#include "contact/enforcement/selection/row_lists.hpp"

#include <functional>
#include <string>
#include <utility>

namespace brickwall::contact {

// Counts of corrected pairs, taken in turn: a round adds to one and empties the next.
constexpr int num_turns = 3;

// What the passes of corrections note, in device memory.
struct CorrectionNotes {
  std::int64_t last_proposing = 0; // number of the last first pass that proposed a change
  std::int64_t invalid = 0; // forces that do not fit the fixed point
};

// Below this many contacts in the history, a kernel for persistent contacts costs more than it
// saves; on processors without lanes, which test the code paths of devices, it runs always.
constexpr std::int64_t least_history = host_accessible ? 1 : 4096;

class InteractionSet {
public:
  InteractionSet() = default;
  // Forces act on the first `num_nodes` nodes of the surface. `face_corners` is 4, or 2 if only the
  // first two corners of a face carry weight.
  InteractionSet(const exec_space& space, const std::string& label, const SweptBoxes& surface,
                 int num_nodes, int face_corners, const EnforcementConfig& config,
                 const Quantum& quantum, const LimbScale& energy_scale);

  // What kinematics record of each node, [as rows of the history]: select() clears it before.
  void recordIn(const View<int*>& status, const View<double*>& gap) {
    _status = status;
    _gap = gap;
  }

  // Launches SelectInteractions<Kinematics> over the rows of `pairs` from `first_row` on, in a step
  // of length `dt`. The function returned waits for the device, and launches again with more memory
  // if the interactions, or the contacts of crowded rows, did not fit. Afterwards next() holds the
  // interactions of this step, history() those of the last one, and forces() the forces of next()
  // (pair_forces.hpp).
  template <class Kinematics>
  std::function<ContactSums()> select(const exec_space& space, const Kinematics& kinematics,
                                      const FaceAccess& faces, const CandidatePairs& pairs,
                                      const IdleState& idle, double dt, int first_row = 0);

  // The same in a step without any interaction that follows a step without any.
  void selectNone(const exec_space& space, const FaceAccess& faces);

  // The two passes of a round of the energy-neutral correction (correct_pair.hpp), from the
  // accelerations by the present forces. The first adds the magnitudes of the proposed changes to
  // proposals(), which must be zero. The second makes these changes and updates forces(). Neither
  // waits for the device.
  // `has_changed` [surface node], in rounds after the first: accelerations that have changed since
  // the last round, or more. A pair is skipped if neither these nor the last round changed it.
  // `marks` [surface node], if given, is set to 1 at the nodes to which the pass adds.
  void proposeChanges(const exec_space& space, const FaceAccess& faces, const StepLengths& steps,
                      const NodeVectors& accelerations,
                      const View<const unsigned char*>& has_changed,
                      const View<unsigned char*>& marks = {});
  void correctForces(const exec_space& space, const FaceAccess& faces, const StepLengths& steps,
                     const NodeVectors& accelerations, const NodeVectors& responses,
                     const View<unsigned char*>& marks = {});
  const ContactForces& proposals() const { return _proposals; }
  // Whether the last proposeChanges() proposed any. Waits for the device.
  bool hasProposals(const exec_space& space);
  // Sends what the corrections of this step have noted on its way to the host.
  void sendNotes(const exec_space& space);
  // The number of forces that no longer fit the fixed point, of the notes sent since the last call.
  // Waits for the device if there are any.
  std::int64_t takeInvalid(const exec_space& space);

  // dt_ref must be >= every later time step. It sets the stiffness of contacts that become active
  // later; active contacts are never stiffened.
  void setReferenceStep(double dt) { _config.reference_step = dt; }

  // Ends a step of length `dt`: its interactions become the history.
  void advance(double dt) {
    std::swap(_history, _next);
    _previous_dt = dt;
  }

  const ContactForces& forces() const { return _forces; }
  bool hasForces() const { return !_are_nodes_zero; } // in the present step
  const ContactHistory& history() const { return _history; }
  const ContactHistory& next() const { return _next; } // of the present step, until advance()
  // For restart files: the history, without joints; see contact_records.hpp.
  ContactCarry carry(const exec_space& space, const View<const global_id*>& node_ids,
                     bool has_forces) const {
    return {recordsOf(space, node_ids, _history, _last), _previous_dt, has_forces, {}};
  }
  void restore(const exec_space& space, const View<const global_id*>& node_ids,
               const ContactCarry& carry, const std::function<ContactPoint(int row)>& pointOf) {
    setHistory(space, node_ids, carry.records, _config.friction > 0, pointOf, _history, _last);
    _previous_dt = carry.previous_dt;
  }

private:
  // Sets what is left of the functor and selects.
  template <class Select>
  void launch(const exec_space& space, Select& functor);
  // The contacts of all rows from functor.first_row on.
  template <class Select>
  void selectRows(const exec_space& space, const Select& functor);
  // The same by lists of rows (row_lists.hpp).
  template <class Kinematics>
  void selectListedRows(const exec_space& space, const SelectInteractions<Kinematics>& functor);
  // Clears what the kernels of a step count, record and add to.
  void clearStep(const exec_space& space, const FaceAccess& faces);
  PairForces pairForces(const exec_space& space, const FaceAccess& faces) const;
  int turn() const { return static_cast<int>(_num_proposing % num_turns); } // of _num_corrected
  // Memory for the interactions of a step, the contacts of its crowded rows and its tested pairs.
  bool hasRoomFor(const ContactSums& sums) const;
  void makeRoomFor(const exec_space& space, const ContactSums& sums);

  EnforcementConfig _config;
  Quantum _quantum;
  LimbScale _energy_scale;
  double _previous_dt = 0; // of the last step, time; 0 before the first
  int _face_corners = 4;
  View<unsigned char*> _is_corrected; // [as interactions] the last round was to change it
  View<int*> _corrected; // [place] those of this round, on devices
  View<std::int64_t[num_turns]> _num_corrected;
  ContactHistory _history, _next; // of the last step and of the present one, swapped by advance()
  View<int*> _status; // see recordIn()
  View<double*> _gap;
  View<std::int64_t*> _counts; // the memory of those below, which are zeroed together
  View<std::int64_t> _next_count;
  LateSum<ContactSums> _sums; // of the present step
  View<CorrectionNotes> _notes;
  Kokkos::View<CorrectionNotes, staging_space> _sent_notes;
  bool _awaits_notes = false; // takeInvalid() has not read them
  std::int64_t _num_proposing = 0; // first passes so far
  LastContacts _last;
  SteadyRows _steady_rows; // of node-to-face contacts
  RowWorkspace _workspace; // empty until a row is crowded
  // Empty unless selectListedRows() is used; see ListRows.
  HistoryRows _persistent_rows;
  View<int*> _persistent_face;
  RowList _other_rows;
  TestedPairs _tested; // likewise
  ContactForces _forces;
  NodeOwners _owners; // of _forces, if several threads select node-to-face contacts
  ContactForces _proposals; // magnitudes
  bool _are_nodes_zero = true; // of _forces
};

template <class Kinematics>
std::function<ContactSums()>
InteractionSet::select(const exec_space& space, const Kinematics& kinematics,
                       const FaceAccess& faces, const CandidatePairs& pairs, const IdleState& idle,
                       double dt, int first_row) {
  SelectInteractions<Kinematics> functor;
  functor.first_row = first_row;
  functor.idle = idle;
  auto& step = functor.step;
  step.law.config = _config;
  step.law.dt = dt;
  step.law.previous_dt = _previous_dt > 0 ? _previous_dt : dt;
  step.energy_scale = _energy_scale;
  step.kinematics = kinematics;
  step.faces = faces;
  step.number = ++_last.num_steps;
  step.last_contact = _last.step;
  step.pairs = pairs;
  step.steady = _steady_rows.flags(pairs, step.number);
  step.previous = _history;
  step.next_count = _next_count;
  // Memory that is not used costs less than a repeated step. At first a guess: in flush joints of
  // matching meshes each contact has four candidates. Tested pairs are not guessed: later steps
  // have few.
  const bool guesses = _next.interactions.size() == 0 && _face_corners == 4;
  ContactSums likely;
  likely.interactions = maxOf(_history.count, guesses ? pairs.count / 4 : 0);
  makeRoomFor(space, likely);
  launch(space, functor);
  return [this, space, functor]() mutable {
    while (true) {
      const ContactSums sums = _sums.read(space);
      _next.count = sums.interactions;
      _are_nodes_zero = sums.interactions == 0;
      if (hasRoomFor(sums))
        return sums;
      // the contact history is unchanged, so the step can be repeated
      makeRoomFor(space, sums);
      launch(space, functor);
    }
  };
}

template <class Select>
void InteractionSet::launch(const exec_space& space, Select& functor) {
  auto& step = functor.step;
  if (_workspace.contacts.extent(0) > 0)
    Kokkos::deep_copy(space, _workspace.num_reserved, std::int64_t(0));
  clearStep(space, step.faces);
  step.next = _next;
  step.workspace = _workspace;
  if constexpr (std::decay_t<decltype(step)>::has_tested_pairs) {
    growTo(space, _tested.place, static_cast<std::int64_t>(step.pairs.faces.extent(0)));
    step.tested = _tested;
  }
  step.add = pairForces(space, step.faces);
  step.add.owners = _owners;
  _are_nodes_zero = false; // until the sums tell
  selectRows(space, functor);
  _sums.send(space);
}

template <class Select>
void InteractionSet::selectRows(const exec_space& space, const Select& functor) {
  if constexpr (!fills_lanes) {
    selectListedRows(space, functor);
  } else {
    const std::int64_t num_rows = functor.step.pairs.num_rows;
    const std::int64_t begin = functor.first_row / Select::rows_at_once;
    const std::int64_t end = dividedUp(num_rows, Select::rows_at_once);
    _sums.add("contact::selectInteractions", space, begin, end, functor);
    if (_owners.areKnown())
      addOthers(space, _owners, _forces.nodes);
  }
}

template <class Kinematics>
void InteractionSet::selectListedRows(const exec_space& space,
                                      const SelectInteractions<Kinematics>& functor) {
  const std::int64_t num_rows = functor.step.pairs.num_rows;
  const bool lists_persistent =
      Kinematics::projects_persistent_contacts && functor.step.previous.count >= least_history;
  growTo(space, _persistent_rows.rows, num_rows);
  growTo(space, _persistent_face, functor.step.previous.interactions.size());
  growTo(space, _other_rows.rows, num_rows);
  Kokkos::parallel_for("contact::selectInteractions::list",
                       range_policy(space, functor.first_row, num_rows),
                       ListRows<Kinematics>{functor, _persistent_rows, _persistent_face,
                                            _other_rows, lists_persistent});
  if constexpr (Kinematics::projects_persistent_contacts)
    if (lists_persistent) {
      const auto persist = [&](auto has_friction) {
        _sums.add<3>("contact::selectInteractions::persist", space, 0,
                     functor.step.previous.count, // rows are not more
                     PersistRows<Kinematics, decltype(has_friction)::value>{
                         functor, _persistent_rows, _persistent_face, _other_rows});
      };
      if (functor.step.law.config.friction > 0)
        persist(std::true_type());
      else
        persist(std::false_type());
    }
  if constexpr (EnforcementStep<Kinematics>::has_tested_pairs) {
    const std::int64_t num_threads = concurrency(space);
    Kokkos::parallel_for("contact::selectInteractions::testPairs", rangePolicy(space, num_threads),
                         TestListedPairs<Kinematics>{functor.step, _other_rows, num_threads});
  }
  _sums.add("contact::selectInteractions", space, 0, num_rows,
            SelectListedRows<Kinematics>{functor, _other_rows});
}

} // namespace brickwall::contact
