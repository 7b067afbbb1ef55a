#include "mechanics/mesh/skin_exchange.hpp"

#include <map>

namespace brickwall::mechanics {

std::vector<std::int64_t> countFacesOnAllRanks(MPI_Comm comm, const std::vector<FaceKey>& keys) {
  const int size = sizeOf(comm);
  std::vector<std::vector<FaceKey>> questions(size);
  for (const FaceKey& key : keys)
    questions[key[0] % size].push_back(key);
  const auto received = exchangeByRank(comm, questions);
  std::map<FaceKey, std::int64_t> uses;
  for (const auto& list : received)
    for (const FaceKey& key : list)
      ++uses[key];
  std::vector<std::vector<std::int64_t>> replies(size);
  for (int q = 0; q < size; ++q)
    for (const FaceKey& key : received[q])
      replies[q].push_back(uses.at(key));
  const auto answers = exchangeByRank(comm, replies);
  std::vector<std::size_t> next(size, 0);
  std::vector<std::int64_t> result;
  for (const FaceKey& key : keys) {
    const auto rank = static_cast<std::size_t>(key[0] % size);
    result.push_back(answers[rank][next[rank]++]);
  }
  return result;
}

void spreadToSharers(MPI_Comm comm, const SharedNodeLists& shared, std::vector<char>& flag) {
  std::vector<std::vector<char>> messages(sizeOf(comm));
  for (std::size_t p = 0; p < shared.ranks.size(); ++p)
    for (const int node : shared.nodes[p])
      messages[shared.ranks[p]].push_back(flag[node]);
  const auto received = exchangeByRank(comm, messages);
  for (std::size_t p = 0; p < shared.ranks.size(); ++p)
    for (std::size_t i = 0; i < shared.nodes[p].size(); ++i)
      flag[shared.nodes[p][i]] |= received[shared.ranks[p]][i];
}

} // namespace brickwall::mechanics
