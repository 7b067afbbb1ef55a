// Wall clock time.
#pragma once

#include <chrono>

namespace brickwall::miniapp {

class Stopwatch {
public:
  double seconds() const { // since its construction
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - _start).count();
  }

private:
  std::chrono::steady_clock::time_point _start = std::chrono::steady_clock::now();
};

} // namespace brickwall::miniapp
