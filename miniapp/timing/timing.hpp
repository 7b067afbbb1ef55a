// How the phases of the search are timed.
#pragma once

namespace brickwall::miniapp {

enum class Timing {
  normal, // no synchronisation beyond that of the algorithm
  // Fences and barriers at the beginning of each phase of the search, which separate waiting from
  // work.
  paper
};

inline const char* nameOf(Timing timing) {
  return timing == Timing::paper ? "paper" : "normal";
}

} // namespace brickwall::miniapp
