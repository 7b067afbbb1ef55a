// Quick tests never reject a pair that the exact tests accept, and reject most distant pairs; data
// of many persistent contacts, and of tested pairs, equal those of each alone bit for bit.
#include "contact/enforcement/edge_edge/edge_edge_kinematics.hpp"
#include "contact/enforcement/node_face/node_face_kinematics.hpp"
#include "tests/contact/enforcement/support/brick_scene.hpp"
#include "tests/contact/enforcement/support/lone_faces.hpp"

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <vector>

namespace brickwall::contact {
namespace {

using testing::LoneFaces;

class Random {
public:
  double operator()(double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(_engine);
  }
  Vec3 vector(double size) {
    return {(*this)(-size, size), (*this)(-size, size), (*this)(-size, size)};
  }

private:
  std::mt19937_64 _engine{7};
};

Vec3 turned(const Vec3& p, const Vec3& axis_angle) {
  const double angle = norm(axis_angle);
  const Vec3 k = (1 / angle) * axis_angle;
  return std::cos(angle) * p + std::sin(angle) * cross(k, p) +
         (1 - std::cos(angle)) * dot(k, p) * k;
}

// Whether EdgeActivationTest accepts the edges of pair_of(pair), each pair in a row of its own.
template <class PairOf>
std::vector<bool> mayPenetrate(const LoneFaces& edges, int num_pairs, const PairOf& pair_of) {
  const FaceAccess faces{edges.surface, GhostFaces()};
  const View<EdgeRecord*> own("own", edges.surface.num_faces);
  for (int e = 0; e < edges.surface.num_faces; ++e)
    for (int j = 0; j < 2; ++j)
      for (int d = 0; d < 3; ++d)
        own(e).end[j][d] = faces.quad(e).corner[j][d];
  const EdgeRecords records{own, {}};
  EdgeEdgeKinematics kinematics;
  kinematics.lateral_tolerance = 0.05;
  std::vector<bool> all;
  constexpr int rows = 32;
  for (int first = 0; first < num_pairs; first += rows) {
    EdgeActivationTest<Lanes> activations{faces, records, kinematics.activationLimits(), 0, {}, {}};
    for (int row = 0; row < rows && first + row < num_pairs; ++row)
      activations.add(row, pair_of(first + row)[0], pair_of(first + row)[1]);
    activations.finish();
    for (int row = 0; row < rows && first + row < num_pairs; ++row)
      all.push_back(activations.rows >> row & 1u);
  }
  return all;
}

TEST(QuickReject, NeverRejectsEdgesThatCross) {
  if (!host_accessible)
    GTEST_SKIP() << "on a host";
  Random random;
  constexpr int n = 40000; // pairs
  LoneFaces edges(2 * n, 2 * n, words_of<EdgeAttributes>);
  const double c = std::sqrt(0.5);
  const Vec3 ridge[4] = {{-0.5, 0, 0}, {0.5, 0, 0}, {0.5, c, -c}, {-0.5, c, -c}};
  for (int pair = 0; pair < n; ++pair) {
    const double spread = pair % 2 ? 0.05 : 0.6, beside = pair % 2 ? 0.7 : 2.5; // near and far
    const Vec3 turn = random.vector(pair % 3 ? 0.3 : 1.5);
    const Vec3 away = {random(-beside, beside), random(-beside, beside), random(-spread, spread)};
    for (int j = 0; j < 4; ++j) {
      edges.set(8 * pair + j, ridge[j], ridge[j]);
      const Vec3 above = {ridge[j].y, ridge[j].x, -ridge[j].z}; // upside down, and across
      const Vec3 x = turned(above, turn) + away;
      edges.set(8 * pair + 4 + j, x, x + Vec3{0, 0, pair % 5 ? 0.7 : 0.0});
    }
    for (int e = 2 * pair; e < 2 * pair + 2; ++e) {
      edges.edge(e).cosine = 0;
      edges.edge(e).sine = 1;
      edges.edge(e).goes_on = pair % 4;
      for (int side = 0; side < 2; ++side) // one pair in four is so narrow that it may be spanned
        edges.edge(e).width[side] = pair % 4 == 1 ? random(0.01, 0.5) : 10;
    }
  }
  EdgeEdgeKinematics kinematics;
  kinematics.lateral_tolerance = 0.05;
  kinematics.edge_tolerance = 0.2;
  kinematics.num_corners = 8 * n;
  const FaceAccess faces{edges.surface, GhostFaces()};
  const std::vector<bool> may_touch = mayPenetrate(edges, n, [](int pair) {
    return std::array<int, 2>{2 * pair, 2 * pair + 1};
  });
  int accepted = 0, spanning = 0, cutting = 0, rejected = 0;
  for (int pair = 0; pair < n; ++pair) {
    const int node = kinematics.num_corners + 2 * pair, other = 2 * pair + 1;
    FaceContact contact;
    contact.previous = -1;
    const bool is_in_contact = kinematics.test(faces, node, other, ContactTest::activate, contact);
    EXPECT_TRUE(!is_in_contact || may_touch[pair]) << pair;
    accepted += is_in_contact;
    if (is_in_contact && pair % 4 == 1) {
      for (int e = 2 * pair; e < 2 * pair + 2; ++e)
        for (int side = 0; side < 2; ++side)
          edges.edge(e).width[side] = 10;
      spanning += !kinematics.test(faces, node, other, ContactTest::activate, contact);
    }
    if (is_in_contact && pair % 4 == 0) { // without free ends
      edges.edge(2 * pair).goes_on = edges.edge(2 * pair + 1).goes_on = 3;
      cutting += !kinematics.test(faces, node, other, ContactTest::activate, contact);
    }
    rejected += !may_touch[pair];
  }
  EXPECT_GT(cutting, 5); // accepted only because they cut off a corner of a side
  EXPECT_GT(accepted, n / 100);
  EXPECT_GT(spanning, 10); // accepted only because they span a side
  EXPECT_GT(rejected, n - 2 * accepted); // few pairs remain for the exact test
}

TEST(QuickReject, RejectsEdgesThatLieFlushOrSideBySide) {
  if (!host_accessible)
    GTEST_SKIP() << "on a host";
  LoneFaces edges(3, 3, words_of<EdgeAttributes>);
  const Vec3 along_x[4] = {{0, 0, 0}, {1, 0, 0}, {1, 1, -1}, {0, 1, -1}};
  for (int j = 0; j < 4; ++j) {
    edges.set(j, along_x[j], along_x[j]);
    edges.set(4 + j, along_x[j] + Vec3{0.3, 0.01, 0}, along_x[j]); // side by side
    const Vec3 across = {along_x[j].y + 0.5, along_x[j].x - 0.5, -along_x[j].z}; // flush
    edges.set(8 + j, across, across);
  }
  for (int e = 0; e < 3; ++e) {
    edges.edge(e).cosine = 0;
    edges.edge(e).sine = 1;
    edges.edge(e).width[0] = std::sqrt(2.0);
    edges.edge(e).width[1] = 1;
  }
  const std::vector<bool> may_touch = mayPenetrate(edges, 2, [](int pair) {
    return std::array<int, 2>{0, 1 + pair};
  });
  EXPECT_FALSE(may_touch[0]);
  EXPECT_FALSE(may_touch[1]);
}

// Warped, flat, with repeated corners, and degenerate faces.
Vec3 cornerOf(int kind, int j, Random& random) {
  static const Vec3 square[4] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  if (kind == 0)
    return square[j];
  if (kind == 1)
    return square[j == 3 ? 2 : j];
  if (kind == 2)
    return square[j % 2];
  return square[j] + random.vector(kind == 3 ? 0.02 : 0.6);
}

TEST(PersistentContacts, ProjectedTogetherEqualThoseProjectedAlone) {
  if (!host_accessible)
    GTEST_SKIP() << "on a host";
  Random random;
  constexpr int n = 4003;
  LoneFaces quads(n, n, words_of<FaceAttributes>);
  View<double*> mass("mass", quads.surface.num_nodes);
  ContactHistory history;
  history.interactions = StructArray<Interaction>("interactions", n);
  std::vector<Interaction> last_contacts(n);
  std::vector<PersistentContact> contacts(n);
  for (int f = 0; f < n; ++f) {
    for (int j = 0; j < 4; ++j) {
      const Vec3 x = cornerOf(f % 5, j, random);
      quads.set(4 * f + j, x, x + random.vector(0.01));
      attributesAt<FaceAttributes>(quads.attributes, f).corner_mass[j] =
          f % 7 ? random(0.5, 2) : HUGE_VAL;
      last_contacts[f].weight[j] = random(0, 1);
    }
    const int node = 4 * n + f;
    const Vec3 x = {random(-0.3, 1.3), random(-0.3, 1.3), random(-0.2, f % 11 ? 0.2 : 3)};
    quads.set(node, x, x + random.vector(0.01));
    mass(node) = random(0.5, 2);
    last_contacts[f].point = atNode(node);
    contacts[f].node = node;
    contacts[f].previous = contacts[f].face = f;
  }
  history.interactions.assign(last_contacts);
  const FaceAccess faces{quads.surface, GhostFaces()};
  projectPersistentContacts(faces, mass, history, n, contacts.data());
  int on_quads = 0, on_others = 0;
  for (const PersistentContact& contact : contacts) {
    const Vec3 x = rowOf(quads.surface.coordinates_new, contact.node);
    const FacePoint point = project(faces.quad(contact.face), x);
    ASSERT_EQ(contact.point.valid, point.valid) << contact.face;
    const Interaction& last = history.interactions(contact.previous);
    const Vec3 last_motion = faces.relativeMotion(last.point, contact.face, last.weight);
    for (int d = 0; d < 3; ++d)
      EXPECT_EQ(contact.last_motion[d], last_motion[d]) << contact.face;
    if (!point.valid)
      continue;
    ++(point.has_parameters ? on_quads : on_others);
    const Vec3 motion = faces.relativeMotion(last.point, contact.face, point.weight);
    double inverse_mass = 1 / mass(contact.node);
    for (int j = 0; j < 4; ++j) {
      EXPECT_EQ(contact.point.weight[j], point.weight[j]) << contact.face;
      if (point.weight[j] != 0)
        inverse_mass += point.weight[j] * point.weight[j] / faces.cornerMass(contact.face, j);
    }
    for (int d = 0; d < 3; ++d) {
      EXPECT_EQ(contact.point.normal[d], point.normal[d]) << contact.face;
      EXPECT_EQ(contact.motion[d], motion[d]) << contact.face;
    }
    EXPECT_EQ(contact.point.gap, point.gap) << contact.face;
    EXPECT_EQ(contact.point.excess, point.excess) << contact.face;
    EXPECT_EQ(contact.point.xi, point.xi) << contact.face;
    EXPECT_EQ(contact.point.eta, point.eta) << contact.face;
    EXPECT_EQ(contact.inverse_mass, inverse_mass) << contact.face;
  }
  EXPECT_GT(on_quads, n / 3);
  EXPECT_GT(on_others, n / 10);
}

TEST(PassedTests, AreThoseThatThePairPassesAlone) {
  if (!host_accessible)
    GTEST_SKIP() << "on a host";
  Random random;
  constexpr int n = 20000; // faces, each with a node; face n + f is the only one of node 8n + f
  LoneFaces quads(2 * n, n, words_of<FaceAttributes>);
  NodeFaceLists around;
  around.offsets = View<int*>("offsets", 9 * n + 1);
  around.rows = View<int*>("rows", n);
  around.corner_share = View<double*>("corner_share", 2 * n);
  View<FaceRecord*> records("records", 2 * n);
  const FaceAccess faces{quads.surface, GhostFaces()};
  const std::int64_t feature_edges[4] = {0xff, 0x0f, 0, 0}; // concave, convex, none twice
  for (int f = 0; f < n; ++f) {
    const int node = 8 * n + f;
    const Vec3 turn = random.vector(f % 3 ? 0.2 : 3);
    for (int j = 0; j < 4; ++j) {
      const Vec3 corner = cornerOf(f % 5, j, random), below = {corner.y, corner.x, 0};
      quads.set(4 * f + j, corner, corner);
      quads.set(4 * (n + f) + j, turned(below, turn), below);
    }
    for (int g = f; g < 2 * n; g += n) {
      attributesAt<FaceAttributes>(quads.attributes, g).feature_edges = feature_edges[f % 4];
      records(g) = {meanPlane(faces.quad(g)), g, g};
      around.corner_share(g) = 0.25;
    }
    const Vec3 x = {random(-0.3, 1.3), random(-0.3, 1.3), random(-0.2, 0.05)};
    quads.set(node, x, x);
    around.rows(f) = n + f;
    around.offsets(node + 1) = f + 1;
  }
  NodeFaceKinematics kinematics;
  kinematics.adjacent_faces = around;
  kinematics.records = records;
  kinematics.num_faces = 2 * n;
  kinematics.num_remote = 0;
  kinematics.lateral_tolerance = 0.05;
  kinematics.edge_tolerance = 0.2;
  kinematics.least_depth = 1e-12;
  int num_passed[8] = {}; // by the bits of both tests
  for (int f = 0; f < n; ++f) {
    const int node = 8 * n + f;
    kinematics.opposed_cosine = f % 2 ? 0.5 : 0.02; // at ContactTest::transfer it is 0.1
    FaceContact stored;
    const unsigned passed = kinematics.passedTests(faces, node, f, stored);
    ASSERT_LT(passed, 8u);
    ++num_passed[passed];
    for (const ContactTest kind : {ContactTest::activate, ContactTest::transfer}) {
      FaceContact contact;
      const bool passes = kinematics.test(faces, node, f, kind, contact);
      ASSERT_EQ((passed & bitOf(kind)) != 0, passes) << f;
      if (!passes)
        continue;
      for (int j = 0; j < 4; ++j)
        EXPECT_EQ(stored.weight[j], contact.weight[j]) << f;
      for (int d = 0; d < 3; ++d)
        EXPECT_EQ(stored.normal[d], contact.normal[d]) << f;
      EXPECT_EQ(stored.place[0], contact.place[0]) << f;
      EXPECT_EQ(stored.place[1], contact.place[1]) << f;
      EXPECT_EQ(stored.depth, contact.depth) << f;
    }
  }
  const unsigned activates = bitOf(ContactTest::activate), transfers = bitOf(ContactTest::transfer);
  EXPECT_GT(num_passed[0], n / 20);
  EXPECT_GT(num_passed[activates], n / 1000);
  EXPECT_GT(num_passed[transfers], n / 100);
  EXPECT_GT(num_passed[activates | transfers], n / 20);
}

template <int width>
void projectOntoSeveralFaces() {
  Random random;
  int on_quads = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    Quad quads[width];
    for (int k = 0; k < width; ++k)
      for (int j = 0; j < 4; ++j)
        quads[k].corner[j] = cornerOf((trial + k) % 7, j, random);
    const Vec3 x = {random(-0.3, 1.3), random(-0.3, 1.3), random(-0.2, 0.2)};
    const int count = trial % (width + 1);
    FacePoint points[width];
    projectAtOnce<width>([&](int k) { return quads[k]; }, count, x, points);
    for (int k = 0; k < count; ++k) {
      const FacePoint alone = project(quads[k], x);
      ASSERT_EQ(points[k].valid, alone.valid) << trial;
      ASSERT_EQ(points[k].has_parameters, alone.has_parameters) << trial;
      on_quads += alone.has_parameters;
      for (int j = 0; j < 4; ++j)
        EXPECT_EQ(points[k].weight[j], alone.weight[j]) << trial;
      for (int d = 0; d < 3; ++d)
        EXPECT_EQ(points[k].normal[d], alone.normal[d]) << trial;
      EXPECT_EQ(points[k].gap, alone.gap) << trial;
      EXPECT_EQ(points[k].excess, alone.excess) << trial;
      EXPECT_EQ(points[k].xi, alone.xi) << trial;
      EXPECT_EQ(points[k].eta, alone.eta) << trial;
    }
  }
  EXPECT_GT(on_quads, 1000);
}

TEST(Projection, OfAPointOntoSeveralFacesEqualsThatOntoEachAlone) {
  if constexpr (host_accessible) // compilers of devices have no packs
    projectOntoSeveralFaces<4>();
  else
    GTEST_SKIP() << "on a host";
}

} // namespace
} // namespace brickwall::contact
