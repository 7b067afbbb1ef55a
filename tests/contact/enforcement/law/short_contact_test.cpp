// Recorded energy of contacts of two steps: the work done on them, which they return, and not the
// energy that the spring would hold.
#include "tests/contact/enforcement/support/scene_run.hpp"

#include <gtest/gtest.h>

namespace brickwall::contact::testing {
namespace {

// A block on a plate, moved along z, with accelerations given to enforcement.
class BlockOnPlate {
public:
  explicit BlockOnPlate(Scheme scheme) {
    _scene.addBox({0, 0, -1}, {4, 4, 1}, {4, 4, 1});
    _block = _scene.addBox({0.75, 0.75, 0}, {2, 2, 1}, {2, 2, 1});
    EnforcementConfig c = config();
    c.scheme = scheme;
    _run = alone(_scene, c);
  }
  // Recorded energy of node-to-face contacts at the half step of this motion.
  double move(double by, double next_acceleration) {
    _scene.step();
    _scene.move(_block, {0, 0, by});
    std::vector<Vec3> acceleration(_scene.x_new.size());
    for (std::size_t i = 0; i < acceleration.size(); ++i)
      if (_scene.x_new[i].z >
          -0.5) // of the block, and of the plate's upper side, which stays at z = 0
        acceleration[i].z = _scene.x_new[i].z == 0 ? 0 : next_acceleration;
    _run->part.update(_scene);
    const NeutralInput input = _run->part.neutralInput(_scene, acceleration);
    sums = _run->enforcement
               .enforce(exec_space(), _run->part.surface(), _run->part.ghosts(), _run->part.pairs(),
                        dt, &input)
               .nodes;
    return sums.terms.sum[spring_stored].value(energyScale());
  }
  // Over the present interactions.
  template <class Value>
  double sumOf(const Value& value) const {
    const ContactHistory& h = _run->enforcement.history();
    const auto all = toHost(h.interactions);
    double sum = 0;
    for (std::int64_t i = 0; i < h.count; ++i)
      sum += value(all(i));
    return sum;
  }
  ContactSums sums;

private:
  Scene _scene;
  int _block = 0;
  std::unique_ptr<SceneRun> _run;
};

constexpr double outwards = 5; // 0.05 in a step of 0.1; the contact is 0.02 deep

double forceOf(const Interaction& pair) {
  return std::fabs(pair.force);
}

TEST(ShortContact, StoresNothingIfItsForceDidNoWork) {
  BlockOnPlate scene(Scheme::energy_neutral);
  scene.move(-0.02, outwards);
  ASSERT_EQ(scene.sums.active, 9 + 4);
  EXPECT_EQ(scene.sumOf(forceOf), 0); // its end is in sight, and it has no energy to return
  EXPECT_EQ(scene.move(0.005, outwards), 0); // other forces stopped it
  EXPECT_EQ(scene.sums.active, 9 + 4);
  EXPECT_GT(scene.sumOf([](const Interaction& pair) { return pair.stiffness * pair.depth; }), 0);
}

TEST(ShortContact, StoresTheEnergyOfItsSpringIfItContinues) {
  BlockOnPlate scene(Scheme::energy_neutral);
  scene.move(-0.02, outwards);
  scene.move(0.005, -outwards);
  const auto half = [](const Interaction& pair) { return 0.5 * pair.stiffness * pair.depth; };
  const double held = scene.sumOf(half) * 0.015; // the offset correction may have changed p
  EXPECT_NEAR(scene.move(0, -outwards) / held, 1, 0.2);
}

TEST(ShortContact, StoresTheWorkDoneOnItIfLoadedFromTheFirstStep) {
  BlockOnPlate scene(Scheme::energy_neutral);
  scene.move(-0.02, 0);
  EXPECT_GT(scene.sumOf(forceOf), 0);
  const double stored = scene.move(-0.005, 0);
  const double worked = scene.sumOf([](const Interaction& pair) { return pair.stored; });
  EXPECT_GT(stored, 0);
  EXPECT_LE(stored, worked * (1 + 1e-12));
}

TEST(ShortContact, StoresTheEnergyOfItsSpringWithoutCorrections) {
  BlockOnPlate scene(Scheme::penalty);
  scene.move(-0.02, outwards);
  EXPECT_GT(scene.sumOf(forceOf), 0);
  EXPECT_NEAR(scene.move(0.005, outwards) / scene.sumOf([](const Interaction& pair) {
    return 0.5 * pair.stiffness * 0.02 * 0.015;
  }),
              1, 1e-12);
}

} // namespace
} // namespace brickwall::contact::testing
