#include "contact/enforcement/selection/interaction_set.hpp"

#include "contact/enforcement/law/correct_springs.hpp"
#include "contact/enforcement/law/pair_forces.hpp"

namespace brickwall::contact {
namespace {

template <class ViewType>
void zeroRows(const exec_space& space, const std::string& label, const ViewType& values,
              std::int64_t rows) {
  const auto width = static_cast<std::int64_t>(values.extent(1));
  Kokkos::parallel_for(
      label, rangePolicy(space, rows), KOKKOS_LAMBDA(const std::int64_t i) {
        for (std::int64_t w = 0; w < width; ++w)
          values(i, w) = 0;
      });
}

// Clears entry i of each.
struct ClearStep {
  View<int*> row_count, status;
  View<double*> gap;
  View<std::int64_t*> counts, words;
  View<std::int64_t* [3]> forces;
  View<std::int64_t* [12]> ghost_forces;
  std::int64_t num_ghosts;

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t i) const {
    const auto at = static_cast<std::size_t>(i);
    if (at < row_count.extent(0))
      row_count(i) = 0;
    if (at < status.extent(0)) {
      status(i) = 0;
      gap(i) = -0.0;
    }
    if (i < num_ghosts)
      for (int w = 0; w < 12; ++w)
        ghost_forces(i, w) = 0;
    if (at < forces.extent(0))
      for (int d = 0; d < 3; ++d)
        forces(i, d) = 0;
    if (at < counts.extent(0))
      counts(i) = 0;
    if (at < words.extent(0))
      words(i) = 0;
  }
};

ContactHistory emptyHistory(const exec_space& space, const std::string& label, int num_nodes) {
  ContactHistory history;
  history.interactions = StructArray<Interaction>(label + "::interactions");
  history.friction = StructArray<FrictionSpring>(label + "::friction");
  history.fading = StructArray<FadingForce>(label + "::fading");
  history.row_begin = allocate<View<int*>>(space, label + "::row_begin", num_nodes);
  history.row_count = View<int*>(label + "::row_count", num_nodes);
  return history;
}

// Three blocks of threads a multiprocessor of a device, each with 170 registers a thread.
using CorrectionPolicy = Kokkos::RangePolicy<exec_space, Kokkos::IndexType<std::int64_t>,
                                             Kokkos::LaunchBounds<128, 3>, launch_by_argument>;

// Interactions that one thread corrects at once; their data are prefetched together.
constexpr int pairs_at_once = simd_width > 1 ? 64 : 1;

// Prefetches what the correction of these pairs reads and adds to.
KOKKOS_FORCEINLINE_FUNCTION void prefetchPairs(const ContactHistory& pairs,
                                               const CorrectPair& correct, const PairForces& add,
                                               const std::int64_t* numbers, int count) {
  const FaceAccess& faces = correct.faces;
  for (int w = 0; w < count; ++w) {
    pairs.interactions.prefetch(numbers[w]);
    faces.prefetchNumbers(pairs.interactions(numbers[w]).face_index);
  }
  for (int w = 0; w < count; ++w) {
    const Interaction& pair = pairs.interactions(numbers[w]);
    prefetchRow(correct.accelerations.nodes, pair.point.node[0]);
    faces.prefetchCorners(pair.face_index, correct.accelerations.nodes);
    if (correct.isProposal()) // it adds for few pairs
      continue;
    prefetchRow(correct.responses.nodes, pair.point.node[0]);
    faces.prefetchCorners(pair.face_index, correct.responses.nodes);
    add.prefetchTarget(pair.point.node[0], pair.face_index);
  }
}

// Whether the acceleration of any node of the pair has changed. Changes of ghosts are unknown and
// assumed.
KOKKOS_INLINE_FUNCTION bool hasChanged(const Interaction& pair, const FaceAccess& faces,
                                       const View<const unsigned char*>& has_changed) {
  unsigned any = !faces.isOwn(pair.face_index);
  forEachNodeOf(pair.point, pair.face_index, faces.surface,
                [&](int node) { any |= has_changed(node); });
  return any != 0;
}

// Counts of a part of a pass.
struct Corrections {
  std::int64_t changed = 0;
  std::int64_t invalid = 0; // forces that do not fit the fixed point

  KOKKOS_INLINE_FUNCTION void note(CorrectionNotes& notes, std::int64_t pass) const {
    if (changed > 0 && notes.last_proposing != pass)
      Kokkos::atomic_fetch_max(&notes.last_proposing, pass);
    if (invalid > 0)
      Kokkos::atomic_add(&notes.invalid, invalid);
  }
};

// Proposes the change of an interaction, or applies it.
KOKKOS_INLINE_FUNCTION void correctOne(const ContactHistory& pairs, const CorrectPair& correct,
                                       const PairForces& add, std::int64_t i,
                                       const View<unsigned char*>& is_corrected,
                                       Corrections& corrections) {
  const Interaction& pair = pairs.interactions(i);
  const CorrectPair::Correction corrected = correct.correctionOf(pairs, i);
  const bool changes = corrected.changes(pair);
  corrections.changed += changes;
  if (changes)
    correct.mark(pair);
  if (correct.isProposal()) {
    is_corrected(i) = changes;
    if (changes)
      add.addMagnitude(pair, corrected.normalChange(pair));
    return;
  }
  if (!changes)
    return;
  PairQuanta<double> quanta;
  add.round(pairs, i, quanta);
  const bool did_fit = quanta.fits;
  if (did_fit)
    add.add(pair, quanta, -1);
  correct.apply(corrected, pairs, i);
  add.round(pairs, i, quanta);
  if (quanta.fits)
    add.add(pair, quanta, 1);
  else
    corrections.invalid += did_fit; // otherwise it has been counted before
}

// Where pairs are taken one by one, the first pass lists those that are to change for the second.
// Few pairs are looked at again sooner than listed.
struct CorrectedList {
  static constexpr std::int64_t least_pairs = 1 << 18;
  View<int*> numbers; // [place] of interactions
  View<std::int64_t[num_turns]> counts;
  int turn = 0;

  KOKKOS_INLINE_FUNCTION void emptyNext() const { counts((turn + 1) % num_turns) = 0; }
  KOKKOS_INLINE_FUNCTION void add(std::int64_t number) const {
    numbers(reservePlaces(&counts(turn), 1)) = static_cast<int>(number);
  }
};

// A pass over all interactions. The first lists those that `has_changed` asks for, or all if it is
// empty, and flags which are to change; the second takes these. Kernel functor, for pairs_at_once.
struct CorrectAll {
  ContactHistory pairs;
  PairForces add;
  CorrectPair correct;
  View<const unsigned char*> has_changed;
  View<unsigned char*> is_corrected;
  std::int64_t pass; // number of the first one
  View<CorrectionNotes> notes;
  CorrectedList list = {};
  std::int64_t num_threads = 0; // of the second pass over a list, otherwise 0

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t part) const {
    Corrections corrections;
    if constexpr (pairs_at_once == 1)
      correctSingly(part, corrections);
    else
      correctListed(part * pairs_at_once, minOf((part + 1) * pairs_at_once, pairs.count),
                    corrections);
    corrections.note(notes(), pass);
  }

private:
  KOKKOS_INLINE_FUNCTION bool isListed(std::int64_t i) const {
    const bool lists_all = correct.isProposal() && has_changed.extent(0) == 0;
    return lists_all || is_corrected(i) ||
           (correct.isProposal() && hasChanged(pairs.interactions(i), correct.faces, has_changed));
  }
  // One interaction, or every num_threads-th of the list.
  KOKKOS_INLINE_FUNCTION void correctSingly(std::int64_t i, Corrections& corrections) const {
    if (correct.isProposal() && i == 0)
      list.emptyNext();
    const std::int64_t own = i;
    const bool takes_list = num_threads > 0;
    const std::int64_t end = takes_list ? list.counts(list.turn) : pairs.count;
    for (; i < end; i += takes_list ? num_threads : pairs.count) {
      const std::int64_t number = takes_list ? list.numbers(i) : i;
      if (takes_list || isListed(number))
        correctListed(number, corrections);
    }
    if (correct.isProposal() && corrections.changed > 0 && pairs.count >= list.least_pairs)
      list.add(own);
  }
  KOKKOS_INLINE_FUNCTION void correctListed(std::int64_t i, Corrections& corrections) const {
    const Interaction& pair = pairs.interactions(i);
    startLoads();
    const auto pairOf = [&](std::int64_t) -> const Interaction& { return pair; };
    std::int64_t number = i;
    if (pair.first_force == 0)
      is_corrected(i) = 0;
    else if (!hasOnlySpring(pair, add) || correctSprings(pairs, pairOf, correct, add, &number, 1,
                                                         is_corrected, corrections.changed) > 0)
      correctOne(pairs, correct, add, i, is_corrected, corrections);
  }
  // Those of [begin, end), with springs in SIMD lanes.
  KOKKOS_INLINE_FUNCTION void correctListed(std::int64_t begin, std::int64_t end,
                                            Corrections& corrections) const {
    std::int64_t listed[pairs_at_once];
    int num_listed = 0;
    if (correct.isProposal() && has_changed.extent(0) > 0)
      for (std::int64_t i = begin; i < end; ++i) {
        pairs.interactions.prefetch(minOf(i + pairs_ahead, pairs.count - 1), &Interaction::node);
        correct.faces.prefetchNumbers(pairs.interactions(i).face_index);
      }
    for (std::int64_t i = begin; i < end; ++i)
      if (isListed(i))
        listed[num_listed++] = i;
    prefetchPairs(pairs, correct, add, listed, num_listed);
    std::int64_t springs[pairs_at_once];
    int num_springs = 0, num_others = 0;
    for (int w = 0; w < num_listed; ++w) {
      const Interaction& pair = pairs.interactions(listed[w]);
      if (pair.first_force == 0)
        is_corrected(listed[w]) = 0;
      else if (hasOnlySpring(pair, add))
        springs[num_springs++] = listed[w];
      else
        listed[num_others++] = listed[w];
    }
    const int num_left = correctSprings(pairs, pairs.interactions, correct, add, springs,
                                        num_springs, is_corrected, corrections.changed);
    for (int w = 0; w < num_others; ++w)
      correctOne(pairs, correct, add, listed[w], is_corrected, corrections);
    for (int w = 0; w < num_left; ++w)
      correctOne(pairs, correct, add, springs[w], is_corrected, corrections);
  }
};

void correctAll(const exec_space& space, CorrectAll functor) {
  const bool is_first = functor.correct.isProposal();
  std::int64_t num_parts = dividedUp<std::int64_t>(functor.pairs.count, pairs_at_once);
  if (pairs_at_once == 1 && is_first) {
    num_parts = maxOf<std::int64_t>(num_parts, 1); // one empties the next list
  } else if (pairs_at_once == 1 && functor.pairs.count >= CorrectedList::least_pairs) {
    num_parts = maxOf(1, concurrency(space) / 2048 * 192); // six warps of each multiprocessor
    functor.num_threads = num_parts;
  }
  Kokkos::parallel_for(is_first ? "contact::proposeChanges" : "contact::correctForces",
                       CorrectionPolicy(space, 0, num_parts), functor);
}

} // namespace

InteractionSet::InteractionSet(const exec_space& space, const std::string& label,
                               const SweptBoxes& surface, int num_nodes, int face_corners,
                               const EnforcementConfig& config, const Quantum& quantum,
                               const LimbScale& energy_scale)
    : _config(config), _quantum(quantum), _energy_scale(energy_scale), _face_corners(face_corners),
      _corrected(label + "::corrected", 0), _num_corrected(label + "::num_corrected"),
      _history(emptyHistory(space, label + "::history", surface.num_nodes)),
      _next(emptyHistory(space, label + "::next", surface.num_nodes)),
      _counts(label + "::counts", 5), _next_count(_counts.data()), _sums(label + "::sums"),
      _notes(label + "::notes"),
      _sent_notes(label + "::sent_notes"), _last{View<int*>(label + "::last_contact",
                                                            config.friction > 0 ? surface.num_nodes
                                                                                : 0)},
      _workspace{View<PersistentContact*>(label + "::workspace::persistent", 0),
                 View<FaceContact*>(label + "::workspace::contacts", 0),
                 View<std::int64_t>(label + "::workspace::num_reserved")},
      _persistent_rows{View<int*>(label + "::persistent_rows", 0),
                       View<std::int64_t[2]>(_counts.data() + 1)},
      _persistent_face(label + "::persistent_face", 0),
      _other_rows{View<int*>(label + "::other_rows", 0), View<std::int64_t>(_counts.data() + 3)},
      _tested{View<int*>(label + "::tested_place", 0), View<TestedPair*>(label + "::tested", 0),
              View<std::int64_t>(_counts.data() + 4)} {
  _forces.nodes = View<std::int64_t* [3]>(label + "::node_forces", num_nodes);
  _forces.ghost_corners = View<std::int64_t* [12]>(label + "::ghost_corners", 0);
  if (face_corners == 4)
    _steady_rows = SteadyRows(label, surface.num_nodes);
  if (fills_lanes && face_corners == 4 && concurrency(space) > 1)
    _owners = NodeOwners(label, num_nodes);
  const bool is_corrected = config.scheme == Scheme::energy_neutral;
  _proposals.nodes = View<std::int64_t* [3]>(label + "::proposals", is_corrected ? num_nodes : 0);
  _proposals.ghost_corners = View<std::int64_t* [12]>(label + "::ghost_proposals", 0);
}

bool InteractionSet::hasRoomFor(const ContactSums& sums) const {
  return sums.interactions <= _next.interactions.size() &&
         sums.workspace <= static_cast<std::int64_t>(_workspace.contacts.extent(0)) &&
         sums.tested <= static_cast<std::int64_t>(_tested.pairs.extent(0));
}

void InteractionSet::makeRoomFor(const exec_space& space, const ContactSums& sums) {
  growTo(space, _workspace.persistent, sums.workspace);
  growTo(space, _workspace.contacts, sums.workspace);
  growTo(space, _tested.pairs, sums.tested);
  growTo(space, _next.interactions, sums.interactions);
  const auto room = _next.interactions.size();
  if (_config.friction > 0)
    growTo(space, _next.friction, room);
  growTo(space, _next.fading, room);
}

// In one kernel, since each launch takes time.
void InteractionSet::clearStep(const exec_space& space, const FaceAccess& faces) {
  growTo(space, _forces.ghost_corners, faces.ghosts.count);
  ClearStep clear{_next.row_count,       _status,           _gap, _counts, _sums.clear(), {},
                  _forces.ghost_corners, faces.ghosts.count};
  if (!_are_nodes_zero)
    clear.forces = _forces.nodes;
  std::int64_t longest = faces.ghosts.count;
  for (const std::size_t extent : {clear.row_count.extent(0), clear.forces.extent(0),
                                   clear.counts.extent(0), clear.words.extent(0)})
    longest = maxOf(longest, static_cast<std::int64_t>(extent));
  Kokkos::parallel_for("contact::InteractionSet::clearStep", rangePolicy(space, longest), clear);
  _are_nodes_zero = true;
}

void InteractionSet::selectNone(const exec_space& space, const FaceAccess& faces) {
  ++_last.num_steps;
  _next.count = 0;
  clearStep(space, faces);
}

void InteractionSet::proposeChanges(const exec_space& space, const FaceAccess& faces,
                                    const StepLengths& steps, const NodeVectors& accelerations,
                                    const View<const unsigned char*>& has_changed,
                                    const View<unsigned char*>& marks) {
  growTo(space, _is_corrected, _next.interactions.size());
  if (pairs_at_once == 1)
    growTo(space, _corrected, _next.interactions.size());
  growTo(space, _proposals.ghost_corners, faces.ghosts.count);
  zeroRows(space, "contact::zeroProposals", _proposals.ghost_corners, faces.ghosts.count);
  PairForces add = pairForces(space, faces);
  add.target = _proposals;
  correctAll(space, {_next,
                     add,
                     correctPair(_config, faces, steps, accelerations, NodeVectors(), marks),
                     has_changed,
                     _is_corrected,
                     ++_num_proposing,
                     _notes,
                     {_corrected, _num_corrected, turn()}});
}

void InteractionSet::correctForces(const exec_space& space, const FaceAccess& faces,
                                   const StepLengths& steps, const NodeVectors& accelerations,
                                   const NodeVectors& responses,
                                   const View<unsigned char*>& marks) {
  correctAll(space, {_next,
                     pairForces(space, faces),
                     correctPair(_config, faces, steps, accelerations, responses, marks),
                     {},
                     _is_corrected,
                     _num_proposing,
                     _notes,
                     {_corrected, _num_corrected, turn()}});
}

bool InteractionSet::hasProposals(const exec_space& space) {
  sendNotes(space);
  space.fence();
  return _sent_notes().last_proposing == _num_proposing;
}

void InteractionSet::sendNotes(const exec_space& space) {
  Kokkos::deep_copy(space, _sent_notes, _notes);
  _awaits_notes = true;
}

std::int64_t InteractionSet::takeInvalid(const exec_space& space) {
  if (!_awaits_notes)
    return 0;
  space.fence();
  _awaits_notes = false;
  const CorrectionNotes notes = _sent_notes();
  if (notes.invalid > 0)
    Kokkos::deep_copy(space, _notes, CorrectionNotes{notes.last_proposing, 0});
  return notes.invalid;
}

PairForces InteractionSet::pairForces(const exec_space& space, const FaceAccess& faces) const {
  return {faces,
          _forces,
          _quantum.inverse,
          _face_corners,
          _config.friction > 0,
          concurrency(space) == 1,
          {}};
}

} // namespace brickwall::contact
