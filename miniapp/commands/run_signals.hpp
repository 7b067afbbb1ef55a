// Signals that a run obeys between steps. SIGUSR1: write a checkpoint. SIGUSR2, SIGTERM, SIGINT:
// end the run after the step, with output and checkpoint. A second SIGINT ends the program at once.
#pragma once

#include <string>

namespace brickwall::miniapp {

// Handlers of this process while the object lives; one object at a time.
class RunSignals {
public:
  RunSignals();
  ~RunSignals();
  RunSignals(const RunSignals&) = delete;
  RunSignals& operator=(const RunSignals&) = delete;

  // The name of the signal that asks this process to end the run; "" for none.
  std::string stop() const;
  // Whether a SIGUSR1 has come since the last call.
  bool takeCheckpoint();
};

} // namespace brickwall::miniapp
