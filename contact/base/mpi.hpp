// Checked MPI: error codes become exceptions, ranks agree on failures, typed reductions.
#pragma once

#include "contact/base/error.hpp"
#include "contact/base/fixed_point.hpp"
#include "contact/base/region.hpp"
#include "contact/base/tags.hpp"

#include <mpi.h>

#include <algorithm>
#include <climits>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <new>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace brickwall {

inline void checkMpi(int code, const char* call) {
  if (code == MPI_SUCCESS)
    return;
  char text[MPI_MAX_ERROR_STRING];
  int length = 0;
  MPI_Error_string(code, text, &length);
  throw Error(ExitCode::internal, std::string(call) + " failed: " + std::string(text, length));
}

inline int rankOf(MPI_Comm comm) {
  int rank = 0;
  checkMpi(MPI_Comm_rank(comm, &rank), "MPI_Comm_rank");
  return rank;
}
inline int sizeOf(MPI_Comm comm) {
  int size = 1;
  checkMpi(MPI_Comm_size(comm, &size), "MPI_Comm_size");
  return size;
}

// Collective. Returns when all ranks have called it.
inline void barrier(MPI_Comm comm) {
  const Region region(waiting_region);
  checkMpi(MPI_Barrier(comm), "MPI_Barrier");
}

// A communicator with the ranks of a host's communicator and messages of its own: no receive of the
// host takes a message sent here, nor the other way round, whatever their tags. Copies share it;
// the last one frees it, on all ranks. MPI_COMM_NULL until it is made from a host's communicator.
class Communicator {
public:
  Communicator() = default;
  // Collective.
  explicit Communicator(MPI_Comm of_host) : _comm(new MPI_Comm(MPI_COMM_NULL), freeComm) {
    const Region region(waiting_region);
    checkMpi(MPI_Comm_dup(of_host, _comm.get()), "MPI_Comm_dup");
  }
  operator MPI_Comm() const { return _comm ? *_comm : MPI_COMM_NULL; }

private:
  static void freeComm(MPI_Comm* comm) {
    int is_finalized = 0;
    MPI_Finalized(&is_finalized);
    // MPI_Comm_free is collective: a rank that an exception unwinds would wait for others, which
    // may not have it. The communicator then lives as long as MPI.
    if (*comm != MPI_COMM_NULL && !is_finalized && std::uncaught_exceptions() == 0)
      MPI_Comm_free(comm);
    delete comm;
  }

  std::shared_ptr<MPI_Comm> _comm;
};

// `n` as an MPI count, which is int. Throws an error that names the size if it does not fit.
inline int checkedInt(std::int64_t n, const char* what) {
  if (n < 0 || n > INT_MAX)
    throw Error(ExitCode::internal, std::string(what) + ": " + std::to_string(n) +
                                        " does not fit a 32-bit count; use more ranks");
  return static_cast<int>(n);
}

template <class T>
MPI_Datatype mpiType() {
  if constexpr (std::is_same_v<T, double>)
    return MPI_DOUBLE;
  else if constexpr (std::is_same_v<T, float>)
    return MPI_FLOAT;
  else if constexpr (std::is_same_v<T, int>)
    return MPI_INT;
  else if constexpr (std::is_same_v<T, std::int64_t>)
    return MPI_INT64_T;
  else if constexpr (std::is_same_v<T, char> || std::is_same_v<T, unsigned char>)
    return MPI_BYTE;
  else
    static_assert(sizeof(T) == 0, "no MPI type for T");
}

// Collective. Reduces `n` values in place over all ranks.
template <class T>
void allReduce(MPI_Comm comm, T* values, int n, MPI_Op op) {
  const Region region(waiting_region);
  checkMpi(MPI_Allreduce(MPI_IN_PLACE, values, n, mpiType<T>(), op, comm), "MPI_Allreduce");
}
template <class T>
T allReduce(MPI_Comm comm, T value, MPI_Op op) {
  allReduce(comm, &value, 1, op);
  return value;
}
// Collective. Adds the limbs of all ranks exactly.
template <int N>
void allReduce(MPI_Comm comm, LimbSums<N>& sums) {
  sums.carry();
  allReduce(comm, sums.data(), LimbSums<N>::size(), MPI_SUM);
}

// Waits until all messages are done, and empties the list.
inline void waitAll(std::vector<MPI_Request>& requests) {
  if (requests.empty())
    return;
  const Region region(waiting_region);
  checkMpi(MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE),
           "MPI_Waitall");
  requests.clear();
}

// A value of one rank each, over the ranks.
struct MaxAndSum {
  double max = 0, sum = 0;
};
// Collective, one reduction. Of each value the largest and the sum over all ranks; `values` of this
// rank, in the same order on all ranks.
inline std::vector<MaxAndSum> maxAndSum(MPI_Comm comm, const std::vector<double>& values) {
  std::vector<MaxAndSum> reduced;
  for (const double value : values)
    reduced.push_back({value, value});
  MPI_Op op = MPI_OP_NULL;
  MPI_Datatype pair = MPI_DATATYPE_NULL;
  checkMpi(MPI_Type_contiguous(2, MPI_DOUBLE, &pair), "MPI_Type_contiguous");
  checkMpi(MPI_Type_commit(&pair), "MPI_Type_commit");
  const auto combine = [](void* from, void* into, int* n, MPI_Datatype*) {
    const auto* a = static_cast<const MaxAndSum*>(from);
    auto* b = static_cast<MaxAndSum*>(into);
    for (int i = 0; i < *n; ++i)
      b[i] = {std::max(a[i].max, b[i].max), a[i].sum + b[i].sum};
  };
  checkMpi(MPI_Op_create(combine, 1, &op), "MPI_Op_create");
  {
    const Region region(waiting_region);
    checkMpi(MPI_Allreduce(MPI_IN_PLACE, reduced.data(), static_cast<int>(reduced.size()), pair, op,
                           comm),
             "MPI_Allreduce");
  }
  MPI_Op_free(&op);
  MPI_Type_free(&pair);
  return reduced;
}

// Collective. Rank `root`'s `n` values at `values` on every rank.
template <class T>
void broadcast(MPI_Comm comm, T* values, std::int64_t n, int root) {
  static_assert(std::is_trivially_copyable_v<T>);
  const int bytes = checkedInt(n * static_cast<std::int64_t>(sizeof(T)), "bytes of a broadcast");
  checkMpi(MPI_Bcast(values, bytes, MPI_BYTE, root, comm), "MPI_Bcast");
}
// Collective. Rank `root`'s text on every rank.
inline std::string broadcast(MPI_Comm comm, std::string text, int root = 0) {
  std::int64_t length = static_cast<std::int64_t>(text.size());
  broadcast(comm, &length, 1, root);
  text.resize(static_cast<std::size_t>(length));
  broadcast(comm, text.data(), length, root);
  return text;
}

// Collective. Runs `work` on this rank; when it throws on any rank, every rank throws the message
// of the lowest such rank, as the same class of error, so that all ranks fail together. `work`
// itself must not call MPI.
inline void rethrowOnAllRanks(MPI_Comm comm, const std::function<void()>& work) {
  std::string message;
  int code = 0;
  try {
    work();
  } catch (const Error& error) {
    message = error.what();
    code = static_cast<int>(error.code());
  } catch (const std::bad_alloc&) {
    message = "out of memory on rank " + std::to_string(rankOf(comm));
    code = static_cast<int>(ExitCode::internal);
  } catch (const std::exception& error) {
    message = error.what();
    code = static_cast<int>(ExitCode::internal);
  }
  const int none = sizeOf(comm);
  const int first = allReduce(comm, code != 0 ? rankOf(comm) : none, MPI_MIN);
  if (first == none)
    return;
  broadcast(comm, &code, 1, first);
  throwError(static_cast<ExitCode>(code), broadcast(comm, message, first));
}

// Collective. Sends `values[q]` to each rank q; returns what each rank sent here, by source rank.
// What goes from this rank to itself is moved, or copied if `values` are not given away.
template <class Values, class T = typename std::decay_t<Values>::value_type::value_type>
std::vector<std::vector<T>> exchangeByRank(const Communicator& comm, Values&& values) {
  static_assert(std::is_trivially_copyable_v<T>);
  const int size = sizeOf(comm), rank = rankOf(comm);
  std::vector<std::int64_t> send_bytes(size), receive_bytes(size);
  for (int q = 0; q < size; ++q)
    send_bytes[q] = static_cast<std::int64_t>(values[q].size() * sizeof(T));
  {
    const Region region(waiting_region);
    checkMpi(
        MPI_Alltoall(send_bytes.data(), 1, MPI_INT64_T, receive_bytes.data(), 1, MPI_INT64_T, comm),
        "MPI_Alltoall");
  }
  std::vector<std::vector<T>> received(size);
  std::vector<MPI_Request> requests;
  // One message may be larger than an int counts: it goes in pieces of at most 1 GiB.
  constexpr std::int64_t piece = std::int64_t(1) << 30;
  const auto forPieces = [&](std::int64_t bytes, auto&& call) {
    for (std::int64_t begin = 0; begin < bytes; begin += piece)
      call(begin, static_cast<int>(std::min(piece, bytes - begin)));
  };
  for (int q = 0; q < size; ++q) {
    if (q == rank)
      continue;
    received[q].resize(static_cast<std::size_t>(receive_bytes[q]) / sizeof(T));
    char* data = reinterpret_cast<char*>(received[q].data());
    forPieces(receive_bytes[q], [&](std::int64_t begin, int n) {
      requests.emplace_back();
      checkMpi(MPI_Irecv(data + begin, n, MPI_BYTE, q, tags::by_rank, comm, &requests.back()),
               "MPI_Irecv");
    });
  }
  for (int q = 0; q < size; ++q) {
    if (q == rank)
      continue;
    const char* data = reinterpret_cast<const char*>(values[q].data());
    forPieces(send_bytes[q], [&](std::int64_t begin, int n) {
      requests.emplace_back();
      checkMpi(MPI_Isend(data + begin, n, MPI_BYTE, q, tags::by_rank, comm, &requests.back()),
               "MPI_Isend");
    });
  }
  if constexpr (std::is_lvalue_reference_v<Values>)
    received[rank] = values[rank];
  else
    received[rank] = std::move(values[rank]);
  waitAll(requests);
  return received;
}
// The same with a communicator of the host, which is copied.
template <class T>
std::vector<std::vector<T>> exchangeByRank(MPI_Comm of_host,
                                           const std::vector<std::vector<T>>& values) {
  return exchangeByRank(Communicator(of_host), values);
}

// The lists one after another.
template <class T>
std::vector<T> joined(const std::vector<std::vector<T>>& lists) {
  std::vector<T> all;
  for (const auto& list : lists)
    all.insert(all.end(), list.begin(), list.end());
  return all;
}

// Collective. The values of all ranks, by rank.
template <class T>
std::vector<T> gatherFromAll(MPI_Comm comm, const std::vector<T>& values) {
  static_assert(std::is_trivially_copyable_v<T>);
  const int size = sizeOf(comm);
  const auto count = static_cast<std::int64_t>(values.size());
  std::vector<std::int64_t> counts_of_ranks(size);
  MPI_Datatype type = MPI_DATATYPE_NULL;
  checkMpi(MPI_Type_contiguous(sizeof(T), MPI_BYTE, &type), "MPI_Type_contiguous");
  checkMpi(MPI_Type_commit(&type), "MPI_Type_commit");
  const Region region(waiting_region);
  checkMpi(MPI_Allgather(&count, 1, MPI_INT64_T, counts_of_ranks.data(), 1, MPI_INT64_T, comm),
           "MPI_Allgather");
  std::vector<int> counts, places;
  std::int64_t total = 0;
  for (const std::int64_t of_rank : counts_of_ranks) { // all ranks find the same sizes
    places.push_back(checkedInt(total, "gathered values"));
    counts.push_back(checkedInt(of_rank, "gathered values"));
    total += of_rank;
  }
  std::vector<T> all(static_cast<std::size_t>(total));
  checkMpi(MPI_Allgatherv(values.data(), counts[rankOf(comm)], type, all.data(), counts.data(),
                          places.data(), type, comm),
           "MPI_Allgatherv");
  MPI_Type_free(&type);
  return all;
}

template <class T>
std::vector<T> sortedDistinct(std::vector<T> values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  return values;
}

// For each of this rank's keys, in their order, the answer of the rank number_of(key) modulo ranks,
// on which equal keys meet. answer(asked) gives there, for the keys `asked` of each rank, as many
// answers. Keys and answers are plain values. Collective; for set-up.
template <class Key, class NumberOf, class Answer>
auto answersByKey(const Communicator& comm, const std::vector<Key>& keys, const NumberOf& number_of,
                  const Answer& answer) {
  const int size = sizeOf(comm);
  std::vector<std::vector<Key>> questions(size);
  for (const Key& key : keys)
    questions[number_of(key) % size].push_back(key);
  const auto answers = exchangeByRank(comm, answer(exchangeByRank(comm, std::move(questions))));
  std::vector<std::size_t> next(size, 0);
  typename std::decay_t<decltype(answers)>::value_type in_order;
  for (const Key& key : keys) {
    const auto rank = static_cast<std::size_t>(number_of(key) % size);
    in_order.push_back(answers[rank][next[rank]++]);
  }
  return in_order;
}

// For each of this rank's keys, in their order, how often the ranks together list it. Keys are plain
// values with an order; number_of(key) >= 0. Collective; for set-up.
template <class Key, class NumberOf>
std::vector<std::int64_t> countOnAllRanks(MPI_Comm of_host, const std::vector<Key>& keys,
                                          const NumberOf& number_of) {
  const auto countEach = [](const std::vector<std::vector<Key>>& asked) {
    std::vector<Key> sorted = joined(asked);
    std::sort(sorted.begin(), sorted.end());
    std::vector<std::vector<std::int64_t>> counts(asked.size());
    for (std::size_t q = 0; q < asked.size(); ++q)
      for (const Key& key : asked[q]) {
        const auto equal = std::equal_range(sorted.begin(), sorted.end(), key);
        counts[q].push_back(equal.second - equal.first);
      }
    return counts;
  };
  return answersByKey(Communicator(of_host), keys, number_of, countEach);
}

} // namespace brickwall
