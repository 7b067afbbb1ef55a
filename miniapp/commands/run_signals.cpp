#include "miniapp/commands/run_signals.hpp"

#include <array>
#include <atomic>
#include <csignal>

namespace brickwall::miniapp {

namespace {

// The handler may run on any thread.
std::atomic<int> stop_signal{0}, wants_checkpoint{0};
static_assert(std::atomic<int>::is_always_lock_free, "signal handlers may use it");

void onStop(int signal) {
  stop_signal = signal;
}
void onCheckpoint(int) {
  wants_checkpoint = 1;
}

struct Handled {
  int signal;
  const char* name;
  void (*handler)(int);
  bool only_once; // then the default action, which ends the process
};
const std::array<Handled, 4> handled = {{{SIGUSR1, "SIGUSR1", onCheckpoint, false},
                                         {SIGUSR2, "SIGUSR2", onStop, false},
                                         {SIGTERM, "SIGTERM", onStop, false},
                                         {SIGINT, "SIGINT", onStop, true}}};
std::array<struct sigaction, handled.size()> former;

} // namespace

RunSignals::RunSignals() {
  stop_signal = 0;
  wants_checkpoint = 0;
  for (std::size_t i = 0; i < handled.size(); ++i) {
    struct sigaction action = {};
    action.sa_handler = handled[i].handler;
    action.sa_flags = static_cast<int>(SA_RESTART | (handled[i].only_once ? SA_RESETHAND : 0u));
    sigaction(handled[i].signal, &action, &former[i]);
  }
}

RunSignals::~RunSignals() {
  for (std::size_t i = 0; i < handled.size(); ++i)
    sigaction(handled[i].signal, &former[i], nullptr);
}

std::string RunSignals::stop() const {
  const int signal = stop_signal;
  for (const Handled& of : handled)
    if (of.signal == signal)
      return of.name;
  return "";
}

bool RunSignals::takeCheckpoint() {
  return wants_checkpoint.exchange(0) != 0;
}

} // namespace brickwall::miniapp
