#include "miniapp/commands/run_signals.hpp"

#include <array>
#include <csignal>

namespace brickwall::miniapp {

namespace {

volatile std::sig_atomic_t stop_signal = 0, wants_checkpoint = 0;

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
  stop_signal = wants_checkpoint = 0;
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
  for (const Handled& of : handled)
    if (of.signal == stop_signal)
      return of.name;
  return "";
}

bool RunSignals::takeCheckpoint() {
  const bool wants = wants_checkpoint != 0;
  if (wants)
    wants_checkpoint = 0;
  return wants;
}

} // namespace brickwall::miniapp
