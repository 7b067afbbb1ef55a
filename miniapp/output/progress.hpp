// Progress of a run for people: one line that is renewed on a terminal, otherwise a line every few
// seconds.
#pragma once

#include <cstdint>
#include <string>

namespace brickwall::miniapp {

struct ProgressState {
  std::int64_t step = 0, steps = 0; // done, and planned
  std::int64_t first_step = 0; // from which this run started
  double time = 0; // of the simulation
  double seconds = 0; // of wall clock since that step
  double energy_error = 0;
  std::int64_t contacts = 0; // under load
};

// "step 1200 of 2000  time 0.006  60 %  400 steps/s  0:02 left  energy error 1.2e-05  204
// contacts".
std::string progressLine(const ProgressState& state);

class Progress {
public:
  enum class Style {
    none,
    lines, // to standard output
    live // to standard error
  };
  // `live` if standard error is a terminal, or if BRICKWALL_LIVE is 1 (run.sh sets it, since a
  // launcher stands between the program and the terminal); `none` if `quiet`.
  static Style chooseStyle(bool quiet);

  explicit Progress(Style style) : _style(style) {}
  ~Progress() { clear(); }
  // Shows the state, if the time since the last one is long enough.
  void show(const ProgressState& state);
  // Removes the live line. Call before other output.
  void clear();

private:
  Style _style;
  double _last = 0; // s
  bool _is_shown = false;
};

} // namespace brickwall::miniapp
