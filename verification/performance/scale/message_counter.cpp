// A library to preload (LD_PRELOAD) that counts what each rank sends over MPI: messages, their
// bytes and reductions. scale_study.py takes the difference of two runs that differ in their steps.
// When MPI ends, rank 0 writes the sums and the largest rank as JSON to the file
// BRICKWALL_MESSAGE_COUNTS.
#include <mpi.h>

#include <cstdio>
#include <cstdlib>

namespace {

long long counts[4]; // messages, bytes, reductions, other collectives

void countMessage(int count, MPI_Datatype type) {
  int size = 0;
  PMPI_Type_size(type, &size);
  ++counts[0];
  counts[1] += static_cast<long long>(count) * size;
}

void write() {
  const char* const path = std::getenv("BRICKWALL_MESSAGE_COUNTS");
  if (!path)
    return;
  long long sums[4], largest[4];
  int rank = 0, size = 1;
  PMPI_Comm_rank(MPI_COMM_WORLD, &rank);
  PMPI_Comm_size(MPI_COMM_WORLD, &size);
  PMPI_Reduce(counts, sums, 4, MPI_LONG_LONG, MPI_SUM, 0, MPI_COMM_WORLD);
  PMPI_Reduce(counts, largest, 4, MPI_LONG_LONG, MPI_MAX, 0, MPI_COMM_WORLD);
  std::FILE* const file = rank == 0 ? std::fopen(path, "w") : nullptr;
  if (!file)
    return;
  std::fprintf(file, "{\"ranks\": %d", size);
  const char* const names[] = {"messages", "bytes", "reductions", "collectives"};
  for (int i = 0; i < 4; ++i)
    std::fprintf(file, ", \"%s\": {\"sum\": %lld, \"max\": %lld}", names[i], sums[i], largest[i]);
  std::fprintf(file, "}\n");
  std::fclose(file);
}

} // namespace

extern "C" {
int MPI_Isend(const void* data, int count, MPI_Datatype type, int to, int tag, MPI_Comm comm,
              MPI_Request* request) {
  countMessage(count, type);
  return PMPI_Isend(data, count, type, to, tag, comm, request);
}
int MPI_Start(MPI_Request* request) { // of a persistent send or receive: bytes are not known here
  ++counts[0];
  return PMPI_Start(request);
}
int MPI_Allreduce(const void* from, void* to, int count, MPI_Datatype type, MPI_Op op,
                  MPI_Comm comm) {
  ++counts[2];
  return PMPI_Allreduce(from, to, count, type, op, comm);
}
int MPI_Allgather(const void* from, int n, MPI_Datatype type, void* to, int m, MPI_Datatype of,
                  MPI_Comm comm) {
  ++counts[3];
  return PMPI_Allgather(from, n, type, to, m, of, comm);
}
int MPI_Alltoall(const void* from, int n, MPI_Datatype type, void* to, int m, MPI_Datatype of,
                 MPI_Comm comm) {
  ++counts[3];
  return PMPI_Alltoall(from, n, type, to, m, of, comm);
}
int MPI_Barrier(MPI_Comm comm) {
  ++counts[3];
  return PMPI_Barrier(comm);
}
int MPI_Finalize() {
  write();
  return PMPI_Finalize();
}
}
