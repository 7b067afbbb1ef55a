// Limits of a run: warnings, stops, messages.
#include "contact/base/error.hpp"
#include "miniapp/deck/limits.hpp"

#include <gtest/gtest.h>

namespace {

using namespace brickwall;
using namespace brickwall::miniapp;

GaugeValues only(Gauge gauge, double value) {
  GaugeValues values{};
  values[gauge] = value;
  return values;
}

TEST(Limits, AreSilentUpToTheLimitAndWarnOnceBeyondIt) {
  for (int g = 0; g < num_gauges; ++g) {
    LimitsConfig limits;
    limits.warn[g] = 0.25;
    LimitWatch watch(limits);
    EXPECT_TRUE(watch.newWarnings(only(Gauge(g), 0.25), 3, 0.5).empty());
    const auto reported = watch.newWarnings(only(Gauge(g), 0.26), 4, 0.75);
    ASSERT_EQ(reported.size(), 1u);
    EXPECT_EQ(reported[0], std::string(gauge_rules[g].words) +
                               " 0.26 in step 4 (time 0.75) exceeds limits.warn." +
                               gauge_rules[g].key + " = 0.25");
    EXPECT_TRUE(watch.newWarnings(only(Gauge(g), 0.9), 5, 1.0).empty());
    EXPECT_EQ(watch.warnings(), reported);
  }
}

TEST(Limits, StopTheRun) {
  LimitsConfig limits;
  limits.stop.fill(HUGE_VAL);
  limits.stop[gauge_contact] = 0.2;
  const LimitWatch watch(limits);
  EXPECT_NO_THROW(watch.stopBeyondLimits(only(gauge_energy, 1e300), 1, 0)); // no limit of its own
  try {
    watch.stopBeyondLimits(only(gauge_contact, 0.3), 2, 0.5);
    FAIL() << "nothing thrown";
  } catch (const PhysicsError& error) {
    EXPECT_STREQ(error.what(),
                 "contact error 0.3 in step 2 (time 0.5) exceeds limits.contact_error = 0.2");
  }
  EXPECT_NO_THROW(watch.stopBeyondLimits(only(gauge_contact, 0.2), 2, 0.5));
}

TEST(Limits, TakeWhatIsNotANumberAsBeyondAll) {
  LimitsConfig limits;
  limits.warn[gauge_hourglass] = 1e9;
  LimitWatch watch(limits);
  EXPECT_EQ(watch.newWarnings(only(gauge_hourglass, std::nan("")), 1, 0).size(), 1u);
  limits.stop[gauge_hourglass] = 1e9;
  EXPECT_THROW(LimitWatch(limits).stopBeyondLimits(only(gauge_hourglass, std::nan("")), 1, 0),
               PhysicsError);
}

} // namespace
