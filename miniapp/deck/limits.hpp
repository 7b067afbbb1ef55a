// Limits of a run, gauge by gauge: a stop limit ends the run with FAIL, a warn limit is reported
// once.
#pragma once

#include <array>
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

// Name of a gauge in [limits] and in messages, and its limits where the deck gives none (infinite:
// no limit).
struct GaugeRule {
  const char* key;
  const char* words;
  const char* help; // its reference value
  double stop;
  double warn;
};
extern const std::array<GaugeRule, num_gauges> gauge_rules;

// [limits] and [limits.warn]
struct LimitsConfig {
  GaugeValues stop = defaults(&GaugeRule::stop), warn = defaults(&GaugeRule::warn);
  std::optional<double> wall_time; // s; the run then ends with its output written

  static GaugeValues defaults(double GaugeRule::*limit);
};

class LimitWatch {
public:
  explicit LimitWatch(const LimitsConfig& limits) : _limits(limits) {}

  // After a step: the new warnings. NaN is beyond any limit.
  std::vector<std::string> newWarnings(const GaugeValues& values, std::int64_t step, double time);
  // Throws PhysicsError where a stop limit is exceeded, the same on all ranks for equal values.
  void stopBeyondLimits(const GaugeValues& values, std::int64_t step, double time) const;

  // Keeps a warning of another part of the program.
  void keep(const std::string& warning) { _warnings.push_back(warning); }
  const std::vector<std::string>& warnings() const { return _warnings; } // all so far

  // Limits that have been reported, for restart files; the warnings are those of the earlier run.
  using Reported = std::array<bool, num_gauges>;
  const Reported& reported() const { return _is_reported; }
  void restore(const Reported& reported, const std::vector<std::string>& warnings) {
    _is_reported = reported;
    _warnings = warnings;
  }

private:
  LimitsConfig _limits;
  Reported _is_reported = {};
  std::vector<std::string> _warnings;
};

} // namespace brickwall::miniapp
