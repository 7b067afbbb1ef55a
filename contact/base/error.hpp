// The errors of the program and the exit code each leads to. Only main turns them into a message
// and a code.
#pragma once

#include <stdexcept>
#include <string>

namespace brickwall {

enum class ExitCode { success = 0, internal = 1, bad_input = 2, physics = 3, output = 4 };

class Error : public std::runtime_error {
public:
  Error(ExitCode code, const std::string& message) : std::runtime_error(message), _code(code) {}
  ExitCode code() const { return _code; }

private:
  ExitCode _code;
};

// Faulty deck, command line or mesh file; the message names the value found and the value expected.
// Exit code 2.
struct InputError : Error {
  explicit InputError(const std::string& message) : Error(ExitCode::bad_input, message) {}
};
// Failure of the computation: inverted element, NaN, overflow, energy limit. Exit code 3.
struct PhysicsError : Error {
  explicit PhysicsError(const std::string& message) : Error(ExitCode::physics, message) {}
};
// A result could not be written. Exit code 4.
struct OutputError : Error {
  explicit OutputError(const std::string& message) : Error(ExitCode::output, message) {}
};

// The error class that belongs to `code`.
[[noreturn]] inline void throwError(ExitCode code, const std::string& message) {
  switch (code) {
  case ExitCode::bad_input:
    throw InputError(message);
  case ExitCode::physics:
    throw PhysicsError(message);
  case ExitCode::output:
    throw OutputError(message);
  default:
    throw Error(code, message);
  }
}

} // namespace brickwall
