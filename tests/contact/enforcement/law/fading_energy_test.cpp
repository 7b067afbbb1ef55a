// Energy in the spring of a contact at the half step, with and without fading.
#include "contact/enforcement/node_face/node_face_kinematics.hpp"
#include "contact/surface/features/feature_edges.hpp"
#include "tests/contact/enforcement/support/resultant.hpp"

#include <gtest/gtest.h>

namespace brickwall::contact::testing {
namespace {

TEST(SpringEnergy, IsHalfTheProductOfStiffnessAndBothDepthsWithoutFading) {
  ContactState<double> state;
  state.last_stiffness = state.stiffness = 0.3;
  state.last_fade_weight = state.fade_weight = 1.0;
  for (const double depth : {0.1, 0.7, 1e-9})
    for (const double next_depth : {0.2, 0.0, -0.1}) {
      state.last_depth = depth;
      state.depth = next_depth;
      EXPECT_EQ(ContactLaw::springEnergy(state), 0.5 * 0.3 * depth * next_depth);
    }
}

// A fixed plate [-1, 1] x [-1, 1] with true edges, whose top is one face of half-length 1 or more
// along x, in the middle higher by `ridge`, and a cube with one corner down. The node there has the mass 1, its spring the stiffness
// 1.
class CornerOnPlate {
public:
  CornerOnPlate(const Vec3& start, int faces = 1, double ridge = 0, Scheme scheme = Scheme::penalty)
      : _scene(sceneAt(start, faces, ridge)), _tip(_scene.nodeAt(1, start)),
        _part((_scene.mass[_tip] = 1, _scene), MPI_COMM_SELF, onOneRank, 0.5),
        _surface(_part.surface()) {
    _surface.face_attributes = withTrueEdges(_surface);
    EnforcementConfig config;
    config.scheme = scheme;
    config.reference_step = 0.5;
    config.penalty = config.reference_step * config.reference_step; // k = s m/dt_ref^2
    config.edge_tolerance = 0.2; // fades out from 1.04 on, over 0.16 or a multiple of the depth
    config.max_activation_depth = 0.05; // only the face on top
    _enforcement = std::make_unique<Enforcement>(exec_space(), MPI_COMM_SELF, _surface,
                                                 _part.nodeMass(), config, _quantum, _scale);
  }

  // The cube moves in a step of this length.
  void move(const Vec3& by, double step) {
    _scene.step();
    _scene.move(1, by);
    _part.update(_scene);
    _surface.coordinates_old = _part.surface().coordinates_old;
    _surface.coordinates_new = _part.surface().coordinates_new;
    const NeutralInput input = _part.neutralInput(_scene, std::vector<Vec3>(_scene.x_new.size()));
    sums =
        _enforcement->enforce(exec_space(), _surface, _part.ghosts(), _part.pairs(), step, &input)
            .nodes;
    EXPECT_EQ(sums.problem(), "");
    EXPECT_LE(sums.interactions, 1);
  }
  Vec3 position() const { return _scene.x_new[_tip]; }
  Vec3 force() const {
    const auto quanta = _part.total(*_enforcement, _scene.x_new.size(), _scene)[_tip];
    Vec3 f;
    for (int d = 0; d < 3; ++d)
      f[d] = _quantum.value * static_cast<double>(quanta[d]);
    return f;
  }
  Interaction contact() const { return toHost(_enforcement->history().interactions)(0); }
  double stored() const { return sums.terms.sum[spring_stored].value(_scale); }

  ContactSums sums;

private:
  static Scene sceneAt(const Vec3& start, int faces, double ridge) {
    Scene scene;
    scene.addBrick({2, 2, 2}, {faces, 1, 1}, 1, [&](const Vec3& p) {
      return Vec3{p.x - 1, p.y - 1, p.z - 2 + (p.x == 1 && p.z == 2 ? ridge : 0)};
    });
    scene.fix(0);
    scene.addBrick({0.6, 0.6, 0.6}, {1, 1, 1}, 1, [&](const Vec3& p) {
      return start + Vec3{(p.x - p.y) / std::sqrt(2.0), (p.x + p.y - 2 * p.z) / std::sqrt(6.0),
                          (p.x + p.y + p.z) / std::sqrt(3.0)};
    });
    for (Scene::Face& face : scene.faces)
      face.surface_mass = 1e6; // the mass of the node determines the stiffness
    return scene;
  }
  static AttributeWords withTrueEdges(const Surface& surface) {
    const FeatureEdges features = findFeatureEdges(MPI_COMM_SELF, surface);
    const AttributeWords known("test::attributes", surface.num_faces, words_of<FaceAttributes>);
    const auto host = Kokkos::create_mirror_view(known);
    Kokkos::deep_copy(host, surface.face_attributes);
    for (int f = 0; f < surface.num_faces; ++f)
      attributesAt<FaceAttributes>(host, f).feature_edges = features.face_edges[f];
    Kokkos::deep_copy(known, host);
    return known;
  }

  Scene _scene;
  int _tip;
  ScenePart _part;
  Surface _surface;
  Quantum _quantum = Quantum::forForceScale(1);
  LimbScale _scale = LimbScale::forLargest(1);
  std::unique_ptr<Enforcement> _enforcement;
};

// Beyond the edge w is less than 1, but it is constant while the node moves straight up and down,
// so the energy is k w p p+/2.
TEST(StoredAtHalfStep, IsThatOfASofterSpringAtConstantFadeWeight) {
  CornerOnPlate run({0.9, 0.13, 0.01});
  run.move({0, 0, -0.03}, 1);
  run.move({0.2, 0, 0}, 1);
  const double fade_weight = run.contact().fade_weight;
  // 1.1 is 0.06 of 0.16 beyond 1.04
  EXPECT_NEAR(fade_weight, 0.625 * 0.625 * (3 - 2 * 0.625), 1e-12);
  double depth = 0.02;
  EXPECT_NEAR(run.contact().depth, depth, 1e-15);
  for (const double rise : {-0.001, 0.0005, 0.0015, -0.002, 0.0004}) {
    const double next_depth = depth - rise;
    run.move({0, 0, rise}, 1);
    EXPECT_EQ(run.contact().fade_weight, fade_weight);
    EXPECT_NEAR(run.stored(), 0.5 * fade_weight * depth * next_depth, 1e-15) << rise;
    depth = next_depth;
  }
}

// The top of two faces that meet at x = 0: the node is on the one that covers it, to 0.04
// half-lengths, where fading starts beyond true edges, and its spring is unaffected.
TEST(Transfer, SelectsTheFaceThatCoversTheNodeWithoutEnergy) {
  CornerOnPlate run({-0.1, 0.13, 0.01}, 2);
  run.move({0, 0, -0.03}, 1);
  const global_id left = run.contact().face;
  for (const double x : {0.1, -0.1, 0.021, -0.021}) {
    run.move({x - run.position().x, 0, 0}, 1);
    const Interaction contact = run.contact();
    EXPECT_EQ(contact.face == left, x < 0) << x;
    EXPECT_EQ(contact.is_new, 0);
    EXPECT_NEAR(contact.depth, 0.02, 1e-15);
    EXPECT_NEAR(contact.offset, 0, 1e-15);
    EXPECT_NEAR(run.stored(), 0.5 * 0.02 * 0.02, 1e-15);
    for (const double weight : contact.weight)
      EXPECT_GE(weight, 0);
  }
  // a slide by less across the edge and back keeps the face
  for (const double x : {0.01, -0.01, 0.019}) {
    run.move({x - run.position().x, 0, 0}, 1);
    EXPECT_EQ(run.contact().face, left) << x;
    EXPECT_NEAR(run.stored(), 0.5 * 0.02 * 0.02, 1e-15);
  }
}

// The same where the faces form a flat ridge: the node leaves its face 1e-3 half-lengths beyond the
// edge, where the gap would change otherwise.
TEST(Transfer, LeavesABentFaceAtItsEdge) {
  CornerOnPlate run({-0.1, 0.13, 0.01}, 2, 0.002);
  run.move({0, 0, -0.03}, 1);
  const global_id left = run.contact().face;
  for (const double x : {6e-4, -6e-4, 4e-4}) {
    run.move({x - run.position().x, 0, 0}, 1);
    EXPECT_EQ(run.contact().face == left, x < 5e-4) << x;
  }
}

// The same beyond a true edge, where the spring fades.
TEST(Transfer, SelectsTheFaceThatCoversAFadingNode) {
  CornerOnPlate run({-0.1, 0.9, 0.01}, 2);
  run.move({0, 0, -0.03}, 1);
  run.move({0, 0.2, 0}, 1);
  const Interaction left = run.contact();
  EXPECT_LT(left.fade_weight, 0.9);
  run.move({0.2, 0, 0}, 1);
  EXPECT_NE(run.contact().face, left.face);
  EXPECT_NEAR(run.contact().fade_weight, left.fade_weight, 1e-12);
  EXPECT_NEAR(run.contact().depth, left.depth, 1e-15);
}

// A node that is behind the plane of a face, but beyond its edge and in front of the next face, has
// left the body: no contact begins there, and one that comes there returns its energy and ends.
TEST(Transfer, EndsTheContactOfANodeThatLeavesOverARidge) {
  constexpr double ridge = 0.2; // faces z = 0.2 +- 0.2 x
  CornerOnPlate outside({0.02, 0.13, ridge + 0.01}, 2, ridge);
  outside.move({0, 0, -0.01}, 1);
  EXPECT_EQ(outside.sums.interactions, 0);
  CornerOnPlate run({-0.02, 0.13, ridge}, 2, ridge);
  run.move({0, 0, -0.01}, 1);
  ASSERT_EQ(run.sums.interactions, 1);
  const Interaction left = run.contact();
  run.move({0.06, 0, 0.008},
           1); // 0.01 behind the left face's plane, 0.006 in front of the right face
  ASSERT_EQ(run.sums.interactions, 1);
  EXPECT_TRUE(run.contact().releases());
  EXPECT_EQ(run.contact().face, left.face);
  EXPECT_NEAR(norm(run.contact().normal - left.normal), 0, 1e-15);
}

// A longer last step leaves a part of the stored energy, since the force acts over half of it only.
TEST(Transfer, ContactThatEndsInFrontOfItsFaceReturnsTheRestOfItsEnergy) {
  CornerOnPlate run({0.2, 0.13, 0.001}, 1, 0, Scheme::energy_neutral);
  run.move({0, 0, -0.011}, 1);
  run.move({0, 0, -0.01}, 1);
  run.move({0, 0, 0}, 1);
  const Interaction loaded = run.contact();
  const double velocity = 0.0201 / 2;
  const double rest = loaded.stored - loaded.force * 0.5 * (1 + 2) * 0.5 * velocity;
  ASSERT_GT(rest, 0.2 * loaded.stored);
  run.move({0, 0, 2 * velocity}, 2);
  ASSERT_EQ(run.sums.interactions, 1);
  EXPECT_TRUE(run.contact().releases());
  EXPECT_NEAR(run.stored(), rest, 1e-12 * rest);
  EXPECT_NEAR(run.contact().first_force, std::sqrt(2 * rest), 1e-12); // k p^2/2 = rest, k = 1
  const double force = run.force().z, next = velocity + 2 * force; // of the mass 1
  EXPECT_NEAR(force * 2 * 0.5 * (velocity + next), rest, 1e-9 * rest);
  run.move({0, 0, 2 * next}, 2);
  EXPECT_EQ(run.sums.interactions, 0);
}

// The corner moves down near the true edge and slides over it freely, while the spring oscillates
// once, as sin t. The worst error of kinetic energy + spring energy, relative to the initial normal
// energy.
struct Slide {
  double worst = 0, min_fade_weight = 1;
  bool has_left = false;

  // Contact begins at t = 0, fading at 0.8, and would end at 2.2, before the node leaves the face
  // at pi.
  Slide(double depth, double fading_way, double step, double longest_step) {
    const double speed = fading_way / 1.4, before = 8 * longest_step;
    CornerOnPlate run({1.04 - (0.8 + before) * speed, 0.13, before * depth});
    Vec3 velocity = {speed, 0, -depth};
    const double start = 0.5 * dot(velocity, velocity), of_fall = 0.5 * depth * depth;
    bool has_touched = false;
    while (!has_left && run.position().x < 2) {
      run.move(step * velocity, step);
      const double energy = 0.5 * dot(velocity, velocity) + run.stored();
      worst = std::max(worst, std::fabs(energy - start) / of_fall);
      if (run.sums.interactions > 0)
        min_fade_weight = std::min(min_fade_weight, run.contact().fade_weight);
      has_left = has_touched && run.sums.interactions == 0;
      has_touched = has_touched || run.sums.interactions > 0;
      velocity += step * run.force();
    }
  }
};

TEST(StoredAtHalfStep, KeepsTheEnergyOfASlideOverATrueEdgeToSecondOrderInTheStep) {
  constexpr double longest = 0.025;
  // The least fade length, 0.8 edge_tolerance; and one that grows with the depth, 4 P
  for (const auto& [depth, way] : {std::make_pair(0.02, 0.16), {0.075, 0.3}}) {
    double error[3];
    for (int i = 0; i < 3; ++i) {
      const Slide slide(depth, way, longest / (1 << i), longest);
      EXPECT_TRUE(slide.has_left);
      EXPECT_LT(slide.min_fade_weight, 0.1); // it faded out
      error[i] = slide.worst;
    }
    const double order[2] = {std::log2(error[0] / error[1]), std::log2(error[1] / error[2])};
    std::printf("  slide off an edge, depth %g: energy %.1e %.1e %.1e, order %.2f %.2f\n", depth,
                error[0], error[1], error[2], order[0], order[1]);
    EXPECT_LT(error[0], 1e-3);
    EXPECT_GT(order[0], 1.9);
    EXPECT_GT(order[1], 1.9);
  }
}

} // namespace
} // namespace brickwall::contact::testing
