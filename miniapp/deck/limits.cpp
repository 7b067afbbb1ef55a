#include "miniapp/deck/limits.hpp"

#include "contact/base/error.hpp"

#include <cmath>
#include <cstdio>

namespace brickwall::miniapp {

// The runs of verification/ and inputs/ have energy and contact errors up to 5e-4, momentum errors
// up to 6e-15, angular momentum errors up to 5e-10 (at strains of 1e-6, where forces are rounded to
// 2^-54 of those at a strain of one), hourglass shares up to 0.25 with two elements or more through
// the thickness and 1 with one element that bends, and penetrations up to 0.003.
const std::array<GaugeRule, num_gauges> gauge_rules = {{
    {"energy_error", "energy error", "error of the energy balance over the peak energy", 0.1, 0.02},
    {"momentum_error", "momentum error",
     "error of the momentum balance over the sum of the magnitudes of the loads' impulses", 1e-6,
     1e-10},
    {"angular_momentum_error", "angular momentum error",
     "error of the balance about the origin over the moments of the impulses; not judged for "
     "linear "
     "materials, which resist rotation",
     1e-3, 1e-6},
    {"contact_error", "contact error",
     "energy that contact stores and dissipates less its work, over the peak energy", HUGE_VAL,
     0.02},
    {"hourglass_share", "hourglass share", "peak hourglass energy over peak internal energy",
     HUGE_VAL, 0.5},
    {"penetration", "penetration", "largest penetration over the square root of the face area",
     HUGE_VAL, 0.1},
}};

GaugeValues LimitsConfig::defaults(double GaugeRule::*limit) {
  GaugeValues values;
  for (int g = 0; g < num_gauges; ++g)
    values[g] = gauge_rules[g].*limit;
  return values;
}

namespace {

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

// NaN is beyond any limit.
bool isBeyond(double value, double limit) {
  return limit < HUGE_VAL && !(value <= limit);
}

std::string exceeds(const GaugeRule& gauge, const char* block, double value, double limit,
                    std::int64_t step, double time) {
  return std::string(gauge.words) + " " + number(value) + " in step " + std::to_string(step) +
         " (time " + number(time) + ") exceeds " + block + "." + gauge.key + " = " + number(limit);
}

} // namespace

std::vector<std::string> LimitWatch::newWarnings(const GaugeValues& values, std::int64_t step,
                                                 double time) {
  std::vector<std::string> found;
  for (int g = 0; g < num_gauges; ++g)
    if (!_is_reported[g] && isBeyond(values[g], _limits.warn[g])) {
      found.push_back(
          exceeds(gauge_rules[g], "limits.warn", values[g], _limits.warn[g], step, time));
      _is_reported[g] = true;
    }
  _warnings.insert(_warnings.end(), found.begin(), found.end());
  return found;
}

void LimitWatch::stopBeyondLimits(const GaugeValues& values, std::int64_t step, double time) const {
  for (int g = 0; g < num_gauges; ++g)
    if (isBeyond(values[g], _limits.stop[g]))
      throw PhysicsError(exceeds(gauge_rules[g], "limits", values[g], _limits.stop[g], step, time));
}

} // namespace brickwall::miniapp
