// Combines values that several ranks hold for the same body (or any other numbered entity), for
// set-up.
#pragma once

#include "contact/base/mpi.hpp"

#include <unordered_map>
#include <vector>

namespace brickwall::mechanics {

// Each rank sends one value per body to the body's rendezvous rank (body modulo ranks), which
// combines them; the combined values come back in the order sent. T has a member `body` >= 0.
// `combine(T& to, const T& from)` must not depend on the order. Collective.
template <class T, class CombineTwo>
std::vector<T> combineByBody(MPI_Comm of_host, const std::vector<T>& values, CombineTwo combine) {
  const auto combineAll = [&](std::vector<std::vector<T>> values_of_ranks) {
    std::unordered_map<global_id, T> combined;
    for (const auto& list : values_of_ranks)
      for (const T& value : list) {
        const auto [entry, is_new] = combined.emplace(value.body, value);
        if (!is_new)
          combine(entry->second, value);
      }
    for (auto& list : values_of_ranks)
      for (T& value : list)
        value = combined.at(value.body);
    return values_of_ranks;
  };
  return answersByKey(
      Communicator(of_host), values, [](const T& value) { return value.body; }, combineAll);
}

} // namespace brickwall::mechanics
