// What a run must keep, gauge by gauge: stop limits end it with FAIL, warn limits are told once each.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace brickwall::miniapp {

enum Gauge : int {
  gauge_energy,
  gauge_momentum,
  gauge_angular_momentum,
  gauge_contact,
  gauge_hourglass,
  gauge_penetration,
  num_gauges
};
using GaugeValues = std::array<double, num_gauges>;

// How a gauge is called in [limits] and in messages, and its limits if the deck says nothing (infinite: none).
struct GaugeRule {
  const char* key;
  const char* words;
  const char* help; // what it is relative to
  const char* stop; // as in a deck; "" for none
  const char* warn;
};
extern const std::array<GaugeRule, num_gauges> gauge_rules;

// [limits] and [limits.warn]
struct LimitsConfig {
  GaugeValues stop = none(), warn = none();
  std::optional<double> wall_time; // s; the run ends in time, with its output written

  static GaugeValues none() {
    GaugeValues values;
    values.fill(HUGE_VAL);
    return values;
  }
};

class LimitWatch {
public:
  explicit LimitWatch(const LimitsConfig& limits) : _limits(limits) {}

  // After a step: the warnings that are new. NaN is beyond any limit.
  std::vector<std::string> newWarnings(const GaugeValues& values, std::int64_t step, double time);
  // Throws PhysicsError where a stop limit is exceeded, the same on all ranks for equal values.
  void stopBeyondLimits(const GaugeValues& values, std::int64_t step, double time) const;

  const std::vector<std::string>& warnings() const { return _warnings; } // all so far

private:
  LimitsConfig _limits;
  std::array<bool, num_gauges> _is_told = {};
  std::vector<std::string> _warnings;
};

} // namespace brickwall::miniapp
