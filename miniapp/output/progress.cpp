#include "miniapp/output/progress.hpp"

#include "miniapp/output/report.hpp"

#include <unistd.h>

#include <cmath>
#include <cstdlib>

namespace brickwall::miniapp {

namespace {

bool isSet(const char* variable) {
  const char* value = std::getenv(variable);
  return value != nullptr && *value != '\0';
}

// h:mm:ss, or m:ss below an hour.
std::string clockText(double seconds) {
  const auto whole = static_cast<std::int64_t>(std::llround(seconds));
  return whole >= 3600 ? format("%lld:%02lld:%02lld", whole / 3600, whole / 60 % 60, whole % 60)
                       : format("%lld:%02lld", whole / 60, whole % 60);
}

} // namespace

std::string progressLine(const ProgressState& state) {
  const double rate = ratio(static_cast<double>(state.step - state.first_step), state.seconds);
  std::string line =
      format("step %lld of %lld  time %.4g  %.0f %%", state.step, state.steps, state.time,
             100 * ratio(static_cast<double>(state.step), static_cast<double>(state.steps)));
  if (rate > 0)
    line += format("  %.3g steps/s  ", rate) +
            clockText(static_cast<double>(state.steps - state.step) / rate) + " left";
  return line + format("  energy error %.1e  ", state.energy_error) +
         counted(state.contacts, "contact");
}

Progress::Style Progress::chooseStyle(bool quiet) {
  const char* live = std::getenv("BRICKWALL_LIVE");
  if (quiet)
    return Style::none;
  return isatty(STDERR_FILENO) != 0 || (live != nullptr && std::string(live) == "1") ? Style::live
                                                                                     : Style::lines;
}

void Progress::show(const ProgressState& state) {
  const double interval = _style == Style::live ? 0.2 : 5;
  if (_style == Style::none || state.seconds - _last < interval)
    return;
  _last = state.seconds;
  const std::string line = progressLine(state);
  if (_style == Style::lines) {
    std::printf("%s\n", line.c_str());
    std::fflush(stdout);
    return;
  }
  // Carriage return, the line (bold unless NO_COLOR is set), and the rest of the former line
  // erased; not wrapped on a narrow terminal.
  const bool is_plain = isSet("NO_COLOR");
  std::fprintf(stderr,
               is_plain ? "\r\033[?7l%s\033[K\033[?7h" : "\r\033[?7l\033[1m%s\033[0m\033[K\033[?7h",
               line.c_str());
  std::fflush(stderr);
  _is_shown = true;
}

void Progress::clear() {
  if (!_is_shown)
    return;
  std::fputs("\r\033[K", stderr);
  std::fflush(stderr);
  _is_shown = false;
}

} // namespace brickwall::miniapp
