// Contacts corrected in SIMD lanes against the same contacts corrected one by one: the same bits of
// forces, and sums of forces that are those of the interactions, in any state of these.
#include "contact/base/to_device.hpp"
#include "contact/enforcement/law/correct_springs.hpp"

#include <gtest/gtest.h>

#include <numeric>
#include <random>
#include <vector>

namespace brickwall::contact::testing {
namespace {

constexpr int num_nodes = 40, num_faces = 15, num_pairs = 203; // not a multiple of the lanes

// Random contacts of random nodes with random faces, some of which are ghosts.
class RandomContacts {
public:
  explicit RandomContacts(unsigned seed, double force_scale = 1) : _random(seed) {
    SweptBoxes& surface = _faces.surface;
    surface.num_nodes = num_nodes;
    surface.num_faces = num_faces - 3;
    const View<int* [4]> face_to_nodes("face_to_nodes", surface.num_faces);
    const auto host_nodes = Kokkos::create_mirror_view(face_to_nodes);
    for (int face = 0; face < surface.num_faces; ++face)
      for (int j = 0; j < 4; ++j)
        host_nodes(face, j) = static_cast<int>(_random() % num_nodes);
    Kokkos::deep_copy(face_to_nodes, host_nodes);
    surface.face_to_nodes = face_to_nodes;
    _pairs.interactions = StructArray<Interaction>("interactions", num_pairs);
    _pairs.count = num_pairs;
    std::vector<Interaction> contacts;
    for (int i = 0; i < num_pairs; ++i)
      contacts.push_back(randomContact(force_scale));
    _pairs.interactions.assign(contacts);
    _accelerations = randomValues<View<double* [3]>>(num_nodes, 3);
    _ghost_accelerations = randomValues<View<double* [12]>>(3, 12);
    _responses = randomValues<View<double* [3]>>(num_nodes, 3);
    _ghost_responses = randomValues<View<double* [12]>>(3, 12);
  }

  CorrectPair propose() const {
    return {_faces, {_accelerations, _ghost_accelerations}, {}, 0.9, 1.1, 0, 0};
  }
  CorrectPair correct() const {
    CorrectPair correct = propose();
    correct.responses = {_responses, _ghost_responses};
    return correct;
  }
  PairForces add() const {
    PairForces add;
    add.faces = _faces;
    add.target.nodes = View<std::int64_t* [3]>("nodes", num_nodes);
    add.target.ghost_corners = View<std::int64_t* [12]>("ghost_corners", 3);
    add.inverse_quantum = 1e14;
    return add;
  }
  const ContactHistory& pairs() const { return _pairs; }

private:
  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(_random);
  }
  Interaction randomContact(double force_scale) {
    Interaction pair;
    pair.node = static_cast<int>(_random() % num_nodes);
    pair.point = atNode(pair.node);
    pair.face_index = static_cast<int>(_random() % num_faces);
    pair.depth = uniform(-0.1, 1);
    pair.offset = uniform(-0.2, 0.2);
    pair.stiffness = force_scale * uniform(0.5, 2);
    pair.first_force = pair.stiffness * pair.depth;
    pair.force = _random() % 2 ? pair.first_force : uniform(0, 1) * pair.first_force;
    pair.damping = pair.first_damping = _random() % 3 ? 0 : force_scale * uniform(-0.1, 0.1);
    pair.stored = force_scale * uniform(-0.1, 0.5);
    pair.closing = uniform(-1, 1);
    pair.is_new = _random() % 2;
    pair.inverse_mass = _random() % 9 ? uniform(0.1, 3) / force_scale : 0; // both prescribed
    pair.normal = {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
    const double xi = uniform(-1, 1), eta = _random() % 4 ? uniform(-1, 1) : 1;
    pair.weight[0] = 0.25 * (1 - xi) * (1 - eta);
    pair.weight[1] = 0.25 * (1 + xi) * (1 - eta);
    pair.weight[2] = 0.25 * (1 + xi) * (1 + eta);
    pair.weight[3] = 0.25 * (1 - xi) * (1 + eta);
    return pair;
  }
  template <class ViewType>
  ViewType randomValues(int rows, int columns) {
    const ViewType values("values", rows);
    const auto host = Kokkos::create_mirror_view(values);
    for (int i = 0; i < rows; ++i)
      for (int c = 0; c < columns; ++c)
        host(i, c) = uniform(-2, 2);
    Kokkos::deep_copy(values, host);
    return values;
  }

  std::mt19937 _random;
  FaceAccess _faces = {{}, GhostFaces::none()};
  ContactHistory _pairs;
  View<double*[3]> _accelerations, _responses;
  View<double*[12]> _ghost_accelerations, _ghost_responses;
};

struct PassOutcome {
  ContactHistory pairs;
  ContactForces forces;
  View<unsigned char*> is_changed{"is_changed", num_pairs};
  View<std::int64_t> num_changed{"num_changed"};
  int num_left = 0;

  explicit PassOutcome(const RandomContacts& contacts) : pairs(contacts.pairs()) {}
};

PassOutcome inLanes(const RandomContacts& contacts, bool proposes) {
  PassOutcome outcome(contacts);
  const PairForces add = contacts.add();
  outcome.forces = add.target;
  const CorrectPair correct = proposes ? contacts.propose() : contacts.correct();
  const auto pairs = outcome.pairs;
  const auto is_changed = outcome.is_changed;
  const auto num_changed = outcome.num_changed;
  Kokkos::parallel_reduce(
      "inLanes", rangePolicy(exec_space(), 1),
      KOKKOS_LAMBDA(const std::int64_t, int& left) {
        std::int64_t numbers[num_pairs];
        for (int i = 0; i < num_pairs; ++i)
          numbers[i] = num_pairs - 1 - i;
        left += correctSprings(pairs, pairs.interactions, correct, add, numbers, num_pairs,
                               is_changed, num_changed());
      },
      outcome.num_left);
  return outcome;
}

PassOutcome oneByOne(const RandomContacts& contacts, bool proposes) {
  PassOutcome outcome(contacts);
  const PairForces add = contacts.add();
  outcome.forces = add.target;
  const CorrectPair correct = proposes ? contacts.propose() : contacts.correct();
  const auto pairs = outcome.pairs;
  const auto is_changed = outcome.is_changed;
  Kokkos::parallel_for(
      "oneByOne", rangePolicy(exec_space(), num_pairs), KOKKOS_LAMBDA(const std::int64_t i) {
        const CorrectPair::Correction corrected = correct.correctionOf(pairs, i);
        const Interaction& pair = pairs.interactions(i);
        is_changed(i) = corrected.changes(pair);
        if (!is_changed(i))
          return;
        if (proposes) {
          add.addMagnitude(pair, corrected.force - pair.force);
          return;
        }
        PairQuanta<double> quanta;
        add.round(pairs, i, quanta);
        add.add(pair, quanta, -1);
        correct.apply(corrected, pairs, i);
        add.round(pairs, i, quanta);
        add.add(pair, quanta, 1);
      });
  return outcome;
}

template <class ViewType>
void expectEqual(const ViewType& a, const ViewType& b) {
  const auto host_a = toHost(a), host_b = toHost(b);
  for (std::size_t i = 0; i < a.extent(0); ++i)
    for (std::size_t c = 0; c < a.extent(1); ++c)
      EXPECT_EQ(host_a(i, c), host_b(i, c)) << i << " " << c;
}

// Adds the magnitudes of all forces, from both ends of the list in turns, so that threads meet at
// nodes, `times` times.
ContactForces addedBy(const RandomContacts& contacts, const PairForces& add, int times) {
  const ContactHistory pairs = contacts.pairs();
  for (int time = 0; time < times; ++time) {
    Kokkos::parallel_for(
        "addedBy", rangePolicy(exec_space(), num_pairs), KOKKOS_LAMBDA(const std::int64_t i) {
          const Interaction& pair = pairs.interactions(i % 2 == 0 ? i : num_pairs - 1 - i);
          add.addMagnitude(pair, pair.first_force);
        });
    if (add.owners.areKnown())
      addOthers(exec_space(), add.owners, add.target.nodes);
  }
  return add.target;
}

TEST(NodeOwners, SumsEqualThoseOfAtomicAdditions) {
  const RandomContacts contacts(4);
  PairForces by_owners = contacts.add();
  by_owners.owners = NodeOwners("owners", num_nodes);
  const ContactForces expected = addedBy(contacts, contacts.add(), 2);
  const ContactForces sums = addedBy(contacts, by_owners, 2);
  expectEqual(sums.nodes, expected.nodes);
  expectEqual(sums.ghost_corners, expected.ghost_corners);
  for (const std::size_t d : {0, 1, 2})
    EXPECT_NE(toHost(sums.nodes)(0, d), 0);
}

TEST(CorrectSprings, EqualScalarCorrections) {
  for (const unsigned seed : {1u, 2u, 3u})
    for (const bool proposes : {true, false}) {
      const PassOutcome lanes = inLanes(RandomContacts(seed), proposes);
      const PassOutcome one = oneByOne(RandomContacts(seed), proposes);
      EXPECT_EQ(lanes.num_left, 0);
      const auto pairs = toHost(lanes.pairs.interactions), of_one = toHost(one.pairs.interactions);
      const auto changed = toHost(lanes.is_changed), of_one_changed = toHost(one.is_changed);
      int num_changed = 0;
      for (int i = 0; i < num_pairs; ++i) {
        EXPECT_EQ(pairs(i).force, of_one(i).force) << i;
        EXPECT_EQ(pairs(i).damping, of_one(i).damping) << i;
        if (proposes) {
          EXPECT_EQ(changed(i), of_one_changed(i)) << i;
        }
        num_changed += of_one_changed(i);
      }
      EXPECT_GT(num_changed, num_pairs / 4);
      EXPECT_LT(num_changed, num_pairs);
      EXPECT_EQ(toHost(lanes.num_changed)(), num_changed);
      expectEqual(lanes.forces.nodes, one.forces.nodes);
      expectEqual(lanes.forces.ghost_corners, one.forces.ghost_corners);
    }
}

// What each pair proposes, and its response to what all propose.
void respond(const PassOutcome& proposed, const CorrectPair& propose, const CorrectPair& correct,
             const View<double*>& changes, const View<double*>& responses) {
  const auto all = proposed.pairs;
  Kokkos::parallel_for(
      "responses", rangePolicy(exec_space(), num_pairs), KOKKOS_LAMBDA(const std::int64_t i) {
        changes(i) = propose.correctionOf(all, i).force - all.interactions(i).force;
        responses(i) = correct.responseOf(all.interactions(i));
      });
}

// Eq. (36) of theory.md, with unit masses.
TEST(CorrectSprings, ResponsesBoundWhatAllProposalsDoTogether) {
  const RandomContacts contacts(5);
  const PassOutcome proposed = inLanes(contacts, true);
  const auto pairs = toHost(proposed.pairs.interactions);
  const auto quanta = toHost(proposed.forces.nodes);
  const auto of_ghosts = toHost(proposed.forces.ghost_corners);
  const View<double* [3]> nodes("nodes", num_nodes);
  const View<double* [12]> ghosts("ghosts", 3);
  const auto to_nodes = toHost(nodes);
  const auto to_ghosts = toHost(ghosts);
  for (int d = 0; d < 3; ++d)
    for (int node = 0; node < num_nodes; ++node)
      to_nodes(node, d) = 1e-14 * static_cast<double>(quanta(node, d));
  for (int c = 0; c < 12; ++c)
    for (int ghost = 0; ghost < 3; ++ghost)
      to_ghosts(ghost, c) = 1e-14 * static_cast<double>(of_ghosts(ghost, c));
  Kokkos::deep_copy(nodes, to_nodes);
  Kokkos::deep_copy(ghosts, to_ghosts);
  const CorrectPair propose = contacts.propose();
  CorrectPair correct = propose;
  correct.responses = {nodes, ghosts};
  const View<double*> device_changes("changes", num_pairs),
      device_responses("responses", num_pairs);
  respond(proposed, propose, correct, device_changes, device_responses);
  const auto changes = toHost(device_changes), responses = toHost(device_responses);
  const auto corners = toHost(propose.faces.surface.face_to_nodes);
  // G: the effect of a unit force on each node and on each ghost's corner, along each axis
  const auto effectOf = [&](int i) {
    std::vector<double> effect(3 * (num_nodes + 12));
    const double along[3] = {pairs(i).normal.x, pairs(i).normal.y, pairs(i).normal.z};
    for (int d = 0; d < 3; ++d) {
      effect[3 * pairs(i).node + d] += along[d];
      for (int j = 0; j < 4; ++j) {
        const int face = pairs(i).face_index, ghost = face - (num_faces - 3);
        const int at = ghost < 0 ? corners(face, j) : num_nodes + 4 * ghost + j;
        effect[3 * at + d] -= pairs(i).weight[j] * along[d];
      }
    }
    return effect;
  };
  for (int i = 0; i < num_pairs; ++i) {
    const std::vector<double> effect = effectOf(i);
    double together = 0;
    for (int j = 0; j < num_pairs; ++j) {
      const std::vector<double> other = effectOf(j);
      for (std::size_t k = 0; k < effect.size(); ++k)
        together += effect[k] * other[k] * changes(j);
    }
    EXPECT_GE(responses(i), std::fabs(together) - 1e-10) << i;
    const double alone = std::inner_product(effect.begin(), effect.end(), effect.begin(), 0.0) *
                         std::fabs(changes(i));
    EXPECT_GE(responses(i), alone - 1e-10) << i;
  }
}

TEST(CorrectPair, AllowsForTheDampingOfContactsThatSettle) {
  Interaction pair;
  pair.force = 2;
  CorrectPair::Correction corrected;
  corrected.force = 1.5;
  corrected.damping = 0.25;
  EXPECT_EQ(corrected.normalChange(pair), 0.5);
  pair.settles = true;
  EXPECT_EQ(corrected.normalChange(pair), 0.75);
}

TEST(CorrectPair, MakesNoChangeBelowItsLeastShareOfTheUncorrectedForce) {
  Interaction pair;
  pair.first_force = pair.force = 2;
  const auto changesBy = [&](double share) {
    CorrectPair::Correction corrected;
    corrected.force = pair.force - share * pair.first_force;
    corrected.damping = pair.damping;
    return corrected.changes(pair);
  };
  EXPECT_FALSE(changesBy(0.9 * CorrectPair::least_change));
  EXPECT_TRUE(changesBy(1.1 * CorrectPair::least_change));
  EXPECT_TRUE(changesBy(-1.1 * CorrectPair::least_change));
  EXPECT_TRUE(changesBy(std::nan("")));
}

TEST(CorrectSprings, LeavesForcesUnchangedThatDoNotFit) {
  const RandomContacts contacts(4, 500);
  const auto before = toHost(RandomContacts(4, 500).pairs().interactions);
  const PassOutcome lanes = inLanes(contacts, false);
  EXPECT_GT(lanes.num_left, num_pairs / 2);
  EXPECT_LT(lanes.num_left, num_pairs); // some forces are almost zero
  const auto pairs = toHost(lanes.pairs.interactions);
  int num_same = 0;
  for (int i = 0; i < num_pairs; ++i)
    num_same += pairs(i).force == before(i).force && pairs(i).damping == before(i).damping;
  EXPECT_GE(num_same, lanes.num_left);
}

} // namespace
} // namespace brickwall::contact::testing
