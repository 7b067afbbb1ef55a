// A directory spread over the ranks: rows and questions for an id meet on the rank that its hash
// names.
#include "io/mesh/rows_by_id.hpp"

#include "contact/base/hash.hpp"
#include "contact/base/mpi.hpp"

#include <algorithm>
#include <utility>

namespace brickwall::io {
namespace {

struct Directory {
  std::vector<global_id> ids; // ascending
  std::vector<const std::int64_t*> rows; // their words
};

Directory sortedDirectory(const std::vector<std::vector<global_id>>& ids,
                          const std::vector<std::vector<std::int64_t>>& words, int width) {
  std::vector<std::pair<global_id, const std::int64_t*>> entries;
  for (std::size_t q = 0; q < ids.size(); ++q)
    for (std::size_t i = 0; i < ids[q].size(); ++i)
      entries.emplace_back(ids[q][i], words[q].data() + i * static_cast<std::size_t>(width));
  std::stable_sort(entries.begin(), entries.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  Directory directory;
  for (const auto& entry : entries) {
    directory.ids.push_back(entry.first);
    directory.rows.push_back(entry.second);
  }
  return directory;
}

} // namespace

RowsById fetchRows(MPI_Comm of_host, const RowsById& held, const std::vector<global_id>& wanted) {
  const Communicator comm(of_host);
  const int size = sizeOf(comm);
  const auto rankFor = [&](global_id id) {
    return static_cast<std::size_t>(hashOfWord(static_cast<std::uint64_t>(id)) %
                                    static_cast<std::uint64_t>(size));
  };
  const auto width = static_cast<std::size_t>(held.width);
  std::vector<std::vector<global_id>> ids(size), questions(size);
  std::vector<std::vector<std::int64_t>> words(size), counts(size), replies(size);
  for (std::size_t i = 0; i < held.ids.size(); ++i) {
    const std::size_t q = rankFor(held.ids[i]);
    ids[q].push_back(held.ids[i]);
    words[q].insert(words[q].end(), held.row(i), held.row(i) + width);
  }
  for (const global_id id : wanted)
    questions[rankFor(id)].push_back(id);
  ids = exchangeByRank(comm, ids);
  words = exchangeByRank(comm, words);
  questions = exchangeByRank(comm, questions);
  const Directory directory = sortedDirectory(ids, words, held.width);
  for (std::size_t q = 0; q < questions.size(); ++q)
    for (const global_id id : questions[q]) {
      const auto range = std::equal_range(directory.ids.begin(), directory.ids.end(), id);
      counts[q].push_back(range.second - range.first);
      for (auto at = range.first; at != range.second; ++at) {
        const std::int64_t* row =
            directory.rows[static_cast<std::size_t>(at - directory.ids.begin())];
        replies[q].insert(replies[q].end(), row, row + width);
      }
    }
  counts = exchangeByRank(comm, counts);
  replies = exchangeByRank(comm, replies);
  RowsById found;
  found.width = held.width;
  std::vector<std::size_t> next_count(size, 0), next_word(size, 0);
  for (const global_id id : wanted) {
    const std::size_t q = rankFor(id);
    const auto count = static_cast<std::size_t>(counts[q][next_count[q]++]);
    found.ids.insert(found.ids.end(), count, id);
    const auto begin = replies[q].begin() + static_cast<std::ptrdiff_t>(next_word[q]);
    next_word[q] += count * width;
    found.words.insert(found.words.end(), begin,
                       begin + static_cast<std::ptrdiff_t>(count * width));
  }
  return found;
}

} // namespace brickwall::io
