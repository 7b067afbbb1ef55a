// Persistent contacts computed in SIMD lanes (write_interactions.hpp, correct_springs.hpp)
// against the same contacts computed one by one: the same bits of the contact history, of forces
// and of sums. Friction too small for a quantum selects the second path: it changes no force, but
// contacts with friction are not computed in lanes.
#include "contact/base/mpi.hpp"
#include "contact/enforcement/law/persistent_contact.hpp"
#include "contact/surface/construct_boxes.hpp"
#include "contact/surface/features/feature_edges.hpp"
#include "tests/contact/enforcement/support/resultant.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <tuple>

namespace brickwall::contact::testing {
namespace {

// A block on another one, whose mesh has `below` faces a side; the upper one's has 8.
Scene twoBlocks(int below, unsigned seed) {
  Scene scene;
  scene.addBox({-1, -1, -1}, {8, 8, 1}, {below, below, 1});
  scene.addBox({0, 0, 0.001}, {6, 6, 1}, {6, 6, 1});
  // Some nodes are so light that the stiffness cap applies, which falls where a contact moves on to
  // lighter ones.
  std::mt19937 random(seed);
  for (double& mass : scene.mass)
    mass *= random() % 3 == 0 ? 0.3 : 1;
  return scene;
}

// Motion of the upper block in a step: inwards; sideways beyond edges of the lower one; out, in
// again and back.
constexpr int num_steps = 36;
Vec3 motionAt(int step) {
  if (step < 4)
    return {0, 0, -0.004};
  if (step < 20)
    return {0.11, 0.07, step % 4 < 2 ? 0.0015 : -0.002};
  if (step < 22)
    return {0, 0, 0.03};
  if (step < 26)
    return {0, 0, -0.017};
  return {-0.13, 0.02, step % 2 == 0 ? -0.001 : 0.001};
}

// Stripes, so that neighbours are on different ranks.
int rankOfElement(int element) {
  return element / 9 % sizeOf(MPI_COMM_WORLD);
}

// [face id] mask of true edges.
std::map<global_id, unsigned char> faceEdges(const Scene& scene) {
  const ScenePart whole(scene, MPI_COMM_SELF, onOneRank, 0);
  const FeatureEdges features = findFeatureEdges(MPI_COMM_SELF, whole.surface());
  const auto ids = toHost(whole.surface().face_ids);
  std::map<global_id, unsigned char> edges;
  for (int face = 0; face < whole.surface().num_faces; ++face)
    edges[ids(face)] = features.face_edges[face];
  return edges;
}

// This rank's part of a scene with its contacts.
class Run {
public:
  Run(const Scene& scene, const EnforcementConfig& config)
      : _scheme(config.scheme), _part(scene, MPI_COMM_WORLD, rankOfElement, 0.3),
        _face_edges(faceEdges(scene)), _surface(_part.surface()) {
    _surface.face_attributes = withTrueEdges(_surface.face_attributes, _surface.face_ids);
    _enforcement = std::make_unique<Enforcement>(
        exec_space(), MPI_COMM_WORLD, _surface, _part.nodeMass(), config, quantum(), energyScale());
  }
  void step(const Scene& scene, const std::vector<Vec3>& accelerations) {
    _part.update(scene);
    _surface.coordinates_old = _part.surface().coordinates_old;
    _surface.coordinates_new = _part.surface().coordinates_new;
    GhostFaces ghosts = _part.ghosts();
    ghosts.attributes = withTrueEdges(ghosts.attributes, ghosts.face_ids);
    const NeutralInput input = _part.neutralInput(scene, accelerations);
    sums = _enforcement
               ->enforce(exec_space(), _surface, ghosts, _part.pairs(), dt,
                         _scheme == Scheme::energy_neutral ? &input : nullptr)
               .nodes;
    forces = _part.total(*_enforcement, scene.x_new.size(), scene);
    const ContactHistory& history = _enforcement->history();
    const auto all = toHost(history.interactions);
    interactions.assign(all.data(), all.data() + history.count);
    status = _enforcement->status();
    gap = _enforcement->gap();
  }

  ContactSums sums;
  std::vector<std::array<std::int64_t, 3>> forces; // of all ranks
  std::vector<Interaction> interactions; // of this rank, in the order of memory
  View<const int*> status;
  View<const double*> gap;

private:
  AttributeWords withTrueEdges(const ConstAttributeWords& attributes,
                               const View<const global_id*>& face_ids) const {
    const AttributeWords known("test::attributes", attributes.extent(0), attributes.extent(1));
    const auto host = Kokkos::create_mirror_view(known);
    Kokkos::deep_copy(host, attributes);
    const auto ids = toHost(face_ids);
    for (std::size_t f = 0; f < host.extent(0); ++f)
      attributesAt<FaceAttributes>(host, f).feature_edges = _face_edges.at(ids(f));
    Kokkos::deep_copy(known, host);
    return known;
  }

  Scheme _scheme;
  ScenePart _part;
  std::map<global_id, unsigned char> _face_edges;
  Surface _surface;
  std::unique_ptr<Enforcement> _enforcement;
};

using Key = std::pair<int, global_id>; // node, side
std::map<Key, Interaction> byNode(const std::vector<Interaction>& interactions) {
  std::map<Key, Interaction> sorted;
  for (const Interaction& pair : interactions)
    sorted[{pair.node, pair.side}] = pair;
  EXPECT_EQ(sorted.size(), interactions.size());
  return sorted;
}

auto numbersOf(const Interaction& i) {
  return std::make_tuple(i.offset, i.depth, i.stiffness, i.fade_weight, i.stored, i.force,
                         i.damping, i.closing, i.first_force, i.first_damping, i.inverse_mass,
                         i.normal.x, i.normal.y, i.normal.z, i.weight[0], i.weight[1], i.weight[2],
                         i.weight[3], i.point.share);
}
auto namesOf(const Interaction& i) {
  return std::make_tuple(i.side, i.face, i.node, i.face_index, i.point.node[0], i.point.node[1],
                         i.is_retained, i.is_new);
}

void expectSame(const Run& a, const Run& b) {
  EXPECT_EQ(a.forces, b.forces);
  const auto of_a = byNode(a.interactions), of_b = byNode(b.interactions);
  ASSERT_EQ(of_a.size(), of_b.size());
  for (auto i = of_a.begin(), j = of_b.begin(); i != of_a.end(); ++i, ++j) {
    EXPECT_EQ(namesOf(i->second), namesOf(j->second)) << "of node " << i->first.first;
    EXPECT_EQ(numbersOf(i->second), numbersOf(j->second)) << "of node " << i->first.first;
  }
  const auto status_a = toHost(a.status), status_b = toHost(b.status);
  const auto gap_a = toHost(a.gap), gap_b = toHost(b.gap);
  for (std::size_t node = 0; node < status_a.extent(0); ++node) {
    EXPECT_EQ(status_a(node), status_b(node)) << node;
    EXPECT_EQ(gap_a(node), gap_b(node)) << node;
  }
}
void expectSameSums(const ContactSums& a, const ContactSums& b) {
  EXPECT_EQ(a.penetrating, b.penetrating);
  EXPECT_EQ(a.interactions, b.interactions);
  EXPECT_EQ(a.active, b.active);
  EXPECT_EQ(a.lost, b.lost);
  EXPECT_EQ(a.failures(), 0);
  EXPECT_EQ(b.failures(), 0);
  EXPECT_EQ(a.max_penetration, b.max_penetration);
  EXPECT_EQ(a.deepest, b.deepest);
  for (const int term : {spring_stored, spring_work, damping_work}) {
    const LimbSum &of_a = a.terms.sum[term], &of_b = b.terms.sum[term];
    EXPECT_EQ(std::make_tuple(of_a.high, of_a.low, of_a.tail),
              std::make_tuple(of_b.high, of_b.low, of_b.tail));
  }
}

// Events of contacts, to ensure that each is tested.
struct Counts {
  std::int64_t steady = 0, softened = 0; // continued on their face; of these, with less stiffness
  std::int64_t moved = 0, fading = 0,
               activations = 0; // transferred to another face; beyond a true edge

  void add(const std::vector<Interaction>& last, const Run& lanes) {
    const auto before = byNode(last);
    for (const Interaction& now : lanes.interactions) {
      activations += now.is_new;
      fading += now.fade_weight < 1;
      const auto found = before.find({now.node, now.side});
      if (now.is_new || found == before.end())
        continue;
      const bool persists = found->second.face == now.face;
      moved += !persists;
      steady += persists;
      softened += persists && now.stiffness < found->second.stiffness;
    }
  }
};
Counts onAllRanks(Counts counts) {
  std::int64_t all[] = {counts.steady, counts.softened, counts.moved, counts.fading,
                        counts.activations};
  allReduce(MPI_COMM_WORLD, all, 5, MPI_SUM);
  return {all[0], all[1], all[2], all[3], all[4]};
}

// Collective; false on all ranks if any rank finds a difference. Adds to `counts`.
bool compareWays(Scheme scheme, int below, unsigned seed, Counts& counts) {
  EnforcementConfig together = config(), one_by_one = config();
  together.scheme = one_by_one.scheme = scheme;
  one_by_one.friction = 1e-300;
  Scene scene = twoBlocks(below, seed);
  Run a(scene, together), b(scene, one_by_one);
  std::mt19937 random(seed);
  const auto anyVector = [&](double most) {
    std::uniform_real_distribution<double> any(-most, most);
    const double x = any(random), y = any(random);
    return Vec3{x, y, any(random)};
  };
  for (int step = 0; step < num_steps; ++step) {
    scene.step();
    scene.move(1, motionAt(step));
    std::vector<Vec3> accelerations;
    for (Vec3& x : scene.x_new) {
      x += anyVector(5e-4);
      accelerations.push_back(anyVector(2));
    }
    const std::vector<Interaction> last = a.interactions;
    a.step(scene, accelerations);
    b.step(scene, accelerations);
    expectSameSums(a.sums, b.sums);
    expectSame(a, b);
    counts.add(last, a);
    const int failed = ::testing::Test::HasFailure() ? 1 : 0;
    if (allReduce(MPI_COMM_WORLD, failed, MPI_MAX) > 0) {
      ADD_FAILURE() << "in step " << step << " of seed " << seed << " on " << below
                    << " faces a side";
      return false;
    }
  }
  return true;
}

void compareWays(Scheme scheme) {
  Counts counts;
  for (unsigned seed = 1; seed <= 5; ++seed)
    for (const int below : {8, 5}) // matching and other meshes
      if (!compareWays(scheme, below, seed, counts))
        return;
  counts = onAllRanks(counts);
  EXPECT_GT(counts.steady, 5000);
  EXPECT_GT(counts.softened, 500);
  EXPECT_GT(counts.moved, 500);
  EXPECT_GT(counts.fading, 100);
  EXPECT_GT(counts.activations, 1000);
}

// Coordinates and tolerances of few digits, so that many bounds are equal, and also off the origin.
TEST(PersistentContacts, NodesWithinReachOfAFaceAreInItsSweptBox) {
  std::mt19937 random(5);
  const auto digit = [&](int num_values) { return 0.25 * static_cast<int>(random() % num_values); };
  int num_within = 0;
  for (int i = 0; i < 100000; ++i) {
    const double tolerance[2] = {digit(4), digit(4)}, far = i % 2 == 0 ? 0 : 1e15;
    const auto place = [&] { return Vec3{far + digit(9), digit(9), digit(9)}; };
    persistent_contact::Gathered<double> gathered;
    const Vec3 x = place();
    const Box node_box = nodeBox(x, x, tolerance[0]);
    Box face_box;
    gathered.node.set(0, x);
    for (int j = 0; j < 4; ++j) {
      const Vec3 corner = place();
      gathered.corner[j].set(0, corner);
      face_box.include(corner);
    }
    face_box.inflate(tolerance[1]);
    if (!isWithin(0.5 * (tolerance[0] + tolerance[1]), gathered))
      continue;
    ++num_within;
    ASSERT_TRUE(node_box.overlaps(face_box)) << i;
  }
  EXPECT_GT(num_within, 10000);
  EXPECT_LT(num_within, 90000);
}

TEST(PersistentContactsSimd, EqualScalarContactsWithPenaltyForces) {
  compareWays(Scheme::penalty);
}

TEST(PersistentContactsSimd, EqualScalarContactsWithCorrectedForces) {
  compareWays(Scheme::energy_neutral);
}

} // namespace
} // namespace brickwall::contact::testing
