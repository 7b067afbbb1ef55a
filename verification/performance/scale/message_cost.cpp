// Prints what messages cost between the ranks that run it, as JSON: latency and time per byte of an
// exchange of two ranks, both directions at once as in the program, and the time of an all-reduce
// of eight words. Median, least and largest of 20 samples. Needs at least two ranks.
#include <mpi.h>

#include <algorithm>
#include <cstdio>
#include <vector>

namespace {

constexpr int samples = 20;

// Seconds of one call, as sorted samples of the means of `calls`, on the slowest rank.
template <class Work>
std::vector<double> timesOf(int calls, const Work& work) {
  std::vector<double> seconds;
  for (int sample = -1; sample < samples; ++sample) { // the first one warms up
    MPI_Barrier(MPI_COMM_WORLD);
    const double begin = MPI_Wtime();
    for (int call = 0; call < calls; ++call)
      work();
    double mean = (MPI_Wtime() - begin) / calls;
    MPI_Allreduce(MPI_IN_PLACE, &mean, 1, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
    if (sample >= 0)
      seconds.push_back(mean);
  }
  std::sort(seconds.begin(), seconds.end());
  return seconds;
}

std::vector<double> exchangeTimes(int bytes, int calls) {
  int rank = 0, size = 1;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  const int peer = rank ^ 1;
  std::vector<char> sent(static_cast<std::size_t>(bytes)), received(sent.size());
  return timesOf(calls, [&] {
    if (peer >= size)
      return;
    MPI_Request requests[2];
    MPI_Irecv(received.data(), bytes, MPI_BYTE, peer, 0, MPI_COMM_WORLD, &requests[0]);
    MPI_Isend(sent.data(), bytes, MPI_BYTE, peer, 0, MPI_COMM_WORLD, &requests[1]);
    MPI_Waitall(2, requests, MPI_STATUSES_IGNORE);
  });
}

void print(const char* name, double median, double least, double largest, const char* end) {
  std::printf("\"%s\": {\"median\": %.4g, \"min\": %.4g, \"max\": %.4g}%s", name, median, least,
              largest, end);
}

} // namespace

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  constexpr int large = 1 << 20;
  const auto small_times = exchangeTimes(8, 2000), large_times = exchangeTimes(large, 20);
  const auto reductions = timesOf(2000, [] {
    double words[8] = {};
    MPI_Allreduce(MPI_IN_PLACE, words, 8, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
  });
  int rank = 0, size = 1;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  if (rank == 0) {
    constexpr int middle = samples / 2, last = samples - 1;
    std::printf("{\"ranks\": %d, ", size);
    print("latency", small_times[middle], small_times[0], small_times[last], ", ");
    print("seconds_per_byte", large_times[middle] / large, large_times[0] / large,
          large_times[last] / large, ", ");
    print("reduction", reductions[middle], reductions[0], reductions[last], "}\n");
  }
  MPI_Finalize();
  return 0;
}
