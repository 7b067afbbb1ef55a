// What the fuzz targets have in common: each source *_target.cpp defines LLVMFuzzerTestOneInput,
// which libFuzzer or driver.cpp calls with one input after another.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace brickwall::fuzz {

// What the bytes of an input choose, one after another; the first of all when there are no more.
class Choices {
public:
  Choices(const std::uint8_t* data, std::size_t size) : _next(data), _end(data + size) {}
  bool any() const { return _next != _end; }
  std::size_t below(std::size_t limit) { return any() ? *_next++ % limit : 0; }

private:
  const std::uint8_t *_next, *_end;
};

// Ends the process if a property does not hold; the engine then keeps the input.
inline void demand(bool holds, const std::string& property) {
  if (holds)
    return;
  std::fprintf(stderr, "not so: %s\n", property.c_str());
  std::abort();
}

// A message for people: not empty, and without bytes that a terminal would take for commands.
inline void demandMessage(const std::string& message) {
  demand(!message.empty(), "a refused input is explained");
  for (const char c : message)
    demand(static_cast<unsigned char>(c) >= 32 || c == '\n' || c == '\t',
           "a message is printable: " + message);
}

} // namespace brickwall::fuzz
