// The corrected force against the energy balance of its step; the factor of the fading force
// against the closed form of its work.
#include "contact/enforcement/law/energy_neutral.hpp"

#include <gtest/gtest.h>

#include <random>

namespace brickwall::contact::testing {
namespace {

struct Case {
  Interaction pair;
  KickedPair motion;
  KickedFading fading;
  double work_to_end;

  // Energy that the fading force may return after the normal force has done its work, F (d- +
  // d+)/2.
  double left() const {
    return pair.stored + 0.5 * pair.force * (motion.closing + motion.next_closing);
  }
  // Work of `factor` times the fading force over the kick: its own share of the motion after the
  // kick grows with it.
  double workOf(double factor) const {
    const double before = factor * fading.before;
    const double after = factor * (fading.after + (factor - 1) * fading.gain);
    return 0.5 * (before + after);
  }
  double factor() const { return neutralFading(pair, pair.force, motion, fading, work_to_end); }
};

// Random values; `share` of the work until the end is done in the next step.
Case randomCase(std::mt19937& random, double share) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  Case c;
  c.pair.force = 1 + uniform(random);
  c.pair.stored = 0.5 + 0.5 * uniform(random);
  c.motion.closing = uniform(random);
  c.motion.next_closing = c.motion.closing - 0.2;
  c.motion.next_drift = 1 + 0.2 * uniform(random);
  c.motion.mobility = 0.1;
  c.fading.before = uniform(random);
  c.fading.gain = 0.3 + 0.2 * uniform(random);
  c.fading.after = c.fading.before + c.fading.gain;
  c.fading.next_drift = c.motion.next_drift;
  c.work_to_end = c.fading.after * c.fading.next_drift / share;
  return c;
}

// Sums and products of numbers up to 4, and a root of one of them; the divisor gain is >= 0.1.
constexpr double round_off = 1e-13;

// A contact with the present force F0 = k p, in a step of unit length.
struct Spring {
  SpringState<double> state;
  KickedPair motion;

  double force() const { return neutralForce(state, motion); }
  double nextClosing(double force) const {
    return motion.next_closing + (state.force - force) * motion.mobility;
  }
  double nextDepth(double force) const { return state.depth + nextClosing(force); }
  // U after the kick
  double storedAfter(double force) const {
    return state.stored + 0.5 * force * (motion.closing + nextClosing(force));
  }
};

// k tau up to 4: several contacts of the largest stable stiffness that act together. The last
// penetration `before` is 0 at activation.
Spring randomSpring(std::mt19937& random, bool is_new) {
  std::uniform_real_distribution<double> uniform(0, 1);
  Spring s;
  const double stiffness = 1 + uniform(random), depth = 0.1 + uniform(random);
  const double before = is_new ? 0 : 0.1 + uniform(random);
  s.state.is_new = is_new;
  s.state.depth = depth;
  s.state.offset = 0;
  s.state.stored = 0.5 * stiffness * before * depth;
  s.state.force = s.state.first_force = stiffness * depth;
  s.motion.mobility = (0.1 + 3.9 * uniform(random)) / stiffness;
  s.motion.closing = depth - before + (is_new ? uniform(random) : 0); // part of it becomes e
  s.motion.next_drift = 1;
  const double by_others = 2 * uniform(random);
  s.motion.next_closing = s.motion.closing + by_others - s.state.force * s.motion.mobility;
  return s;
}

TEST(NeutralForce, StoresTheEnergyOfTheSpringInTheFirstStep) {
  std::mt19937 random(4);
  for (int trial = 0; trial < 1000; ++trial) {
    const Spring s = randomSpring(random, true);
    const double force = s.force();
    EXPECT_GT(force, 0);
    EXPECT_LE(force, s.state.first_force);
    EXPECT_GE(s.nextDepth(force), -round_off);
    EXPECT_NEAR(s.storedAfter(force), 0.5 * s.state.first_force * s.nextDepth(force), round_off);
  }
}

TEST(NeutralForce, ReturnsTheStoredEnergyInTheLastStepOnly) {
  std::mt19937 random(5);
  int num_last = 0, num_others = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    const Spring s = randomSpring(random, false);
    const double force = s.force();
    if (s.nextDepth(s.state.first_force) > 0) { // exact without a correction
      EXPECT_NEAR(force, s.state.first_force, round_off);
      ++num_others;
    } else {
      EXPECT_LE(s.nextDepth(force), round_off);
      EXPECT_NEAR(s.storedAfter(force), 0, round_off);
      ++num_last;
    }
  }
  EXPECT_GT(num_others, 100);
  EXPECT_GT(num_last, 50);
}

// The present damping force, any multiple of the critical one.
TEST(MeanDamping, IsItsRateTimesTheMeanApproachThatItLeaves) {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int trial = 0; trial < 1000; ++trial) {
    const KickedPair motion = {uniform(random), uniform(random), 1, 1.1 + uniform(random)};
    const double present = uniform(random), rate = std::pow(10, 3 * uniform(random));
    const double force = meanDamping(present, rate, motion);
    const double next_closing = motion.next_closing + (present - force) * motion.mobility;
    EXPECT_NEAR(force, rate * 0.5 * (motion.closing + next_closing), round_off * rate);
  }
}

// Contacts with random levers on common nodes of unit mass, and any damping: in the first round, with
// the mobilities of eq. (36), their damping forces take energy.
TEST(MeanDamping, OfContactsThatShareNodesTakesEnergy) {
  constexpr int num_contacts = 5, num_nodes = 4;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int trial = 0; trial < 1000; ++trial) {
    double lever[num_contacts][num_nodes], alone[num_contacts], force[num_contacts];
    KickedPair motion[num_contacts];
    double rate[num_contacts];
    const auto mobility = [&](int i, int j, bool of_magnitudes) {
      double sum = 0;
      for (int m = 0; m < num_nodes; ++m)
        sum += of_magnitudes ? std::fabs(lever[i][m] * lever[j][m]) : lever[i][m] * lever[j][m];
      return sum;
    };
    for (int i = 0; i < num_contacts; ++i) {
      for (double& of_node : lever[i])
        of_node = uniform(random);
      motion[i] = {uniform(random), uniform(random), 1, mobility(i, i, false)};
      rate[i] = std::pow(10, 3 * uniform(random));
      alone[i] = meanDamping(0, rate[i], motion[i]);
    }
    for (int i = 0; i < num_contacts; ++i) {
      KickedPair together = motion[i];
      double response = 0;
      for (int j = 0; j < num_contacts; ++j)
        response += mobility(i, j, true) * std::fabs(alone[j]);
      together.mobility = std::max(motion[i].mobility, response / std::fabs(alone[i]));
      force[i] = meanDamping(0, rate[i], together);
    }
    double taken = 0, scale = 0;
    for (int i = 0; i < num_contacts; ++i) {
      double mean = 0.5 * (motion[i].closing + motion[i].next_closing);
      scale += std::fabs(force[i] * mean);
      for (int j = 0; j < num_contacts; ++j)
        mean -= 0.5 * mobility(i, j, false) * force[j];
      taken += force[i] * mean;
    }
    EXPECT_GE(taken, -round_off * scale);
  }
}

TEST(NeutralFading, ReturnsExactlyTheRemainingEnergyInTheLastStep) {
  std::mt19937 random(1);
  int with_load = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    Case c = randomCase(random, 0.9);
    if (c.fading.after <= 0) // it does not move towards the end
      continue;
    if (c.left() > 0) {
      EXPECT_NEAR(c.workOf(c.factor()), c.left(), round_off);
      EXPECT_GT(c.factor(), 0);
      ++with_load;
    } else {
      EXPECT_EQ(c.factor(), 0);
    }
  }
  EXPECT_GT(with_load, 200);
}

TEST(NeutralFading, NeverReturnsMoreThanTheRemainingEnergyBefore) {
  std::mt19937 random(2);
  int limited = 0, whole = 0, closing = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    Case c = randomCase(random, 0.3);
    if (c.fading.after <= 0)
      continue;
    const double factor = c.factor(), wanted = c.workOf(1), left = std::max(c.left(), 0.0);
    if (wanted <= 0) { // it takes energy from the bodies
      EXPECT_EQ(factor, 1);
      ++closing;
    } else if (wanted <= left) { // load remains
      EXPECT_EQ(factor, 1);
      ++whole;
    } else {
      EXPECT_LT(factor, 1);
      EXPECT_NEAR(c.workOf(factor), left, round_off);
      ++limited;
    }
  }
  EXPECT_GT(limited, 50);
  EXPECT_GT(whole, 50);
  EXPECT_GT(closing, 5);
}

TEST(NeutralFading, LeavesTheForceUnchangedIfItMovesNothing) {
  std::mt19937 random(3);
  for (const double share : {0.3, 0.9}) {
    Case c = randomCase(random, share);
    c.fading.gain = 0; // no fading force, or prescribed motion on both sides
    EXPECT_EQ(c.factor(), 1);
  }
}

} // namespace
} // namespace brickwall::contact::testing
