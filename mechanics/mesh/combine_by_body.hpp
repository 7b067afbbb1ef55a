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
  const Communicator comm(of_host);
  const int size = sizeOf(comm);
  std::vector<std::vector<T>> questions(size);
  for (const T& value : values)
    questions[value.body % size].push_back(value);
  auto received = exchangeByRank(comm, questions);
  std::unordered_map<global_id, T> combined;
  for (const auto& list : received)
    for (const T& value : list) {
      const auto [entry, is_new] = combined.emplace(value.body, value);
      if (!is_new)
        combine(entry->second, value);
    }
  for (auto& list : received)
    for (T& value : list)
      value = combined.at(value.body);
  const auto answers = exchangeByRank(comm, received);
  std::vector<std::size_t> next(size, 0);
  std::vector<T> result;
  for (const T& value : values) {
    const auto rank = static_cast<std::size_t>(value.body % size);
    result.push_back(answers[rank][next[rank]++]);
  }
  return result;
}

} // namespace brickwall::mechanics
