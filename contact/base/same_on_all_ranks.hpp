// Values that must be the same on all ranks: what a host gives to a collective constructor.
#pragma once

#include "contact/base/mpi.hpp"

#include <cstdio>
#include <string>
#include <vector>

namespace brickwall {

struct NamedValue {
  NamedValue(const char* label, const std::string& value) : name(label), text(value) {}
  NamedValue(const char* label, double value) : name(label) {
    char digits[32];
    std::snprintf(digits, sizeof digits, "%.17g", value); // other doubles have other digits
    text = digits;
  }

  std::string name, text;
};

// Collective; each rank gives the same names in the same order. Throws InputError on all ranks,
// naming `function`, the lowest rank with a value other than rank 0's, and both values.
inline void requireSame(MPI_Comm comm, const std::string& function,
                        const std::vector<NamedValue>& values) {
  std::string texts;
  for (const NamedValue& value : values)
    texts += value.text + '\n';
  const std::string of_root = broadcast(comm, texts);
  rethrowOnAllRanks(comm, [&] {
    std::size_t begin = 0;
    for (const NamedValue& value : values) {
      const std::size_t end = of_root.find('\n', begin);
      const std::string expected = of_root.substr(begin, end - begin);
      if (value.text != expected)
        throw InputError(function + ": " + value.name + " is " + value.text + " on rank " +
                         std::to_string(rankOf(comm)) + " and " + expected +
                         " on rank 0; it must be the same on all ranks");
      begin = end + 1;
    }
  });
}

} // namespace brickwall
