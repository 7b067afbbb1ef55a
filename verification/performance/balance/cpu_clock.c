/* A library for LD_PRELOAD: the steady clock of a program is the CPU time of the calling thread outside
   of MPI, so that ranks which share cores measure their own work (balance_study.py --cpu-time). */
#define _GNU_SOURCE
#include <mpi.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

static __thread long long in_mpi; /* ns of this thread */

static long long now(void) {
  struct timespec time;
  syscall(SYS_clock_gettime, CLOCK_THREAD_CPUTIME_ID, &time);
  return 1000000000LL * time.tv_sec + time.tv_nsec;
}

int clock_gettime(clockid_t id, struct timespec* time) {
  if (id != CLOCK_MONOTONIC)
    return (int)syscall(SYS_clock_gettime, id, time);
  const long long outside = now() - in_mpi;
  time->tv_sec = outside / 1000000000LL;
  time->tv_nsec = outside % 1000000000LL;
  return 0;
}

/* Calls that wait for other ranks, of the program and of Zoltan. */
#define WRAP(name, parameters, arguments)                                                                              \
  int MPI_##name parameters {                                                                                          \
    const long long begin = now();                                                                                     \
    const int code = PMPI_##name arguments;                                                                            \
    in_mpi += now() - begin;                                                                                           \
    return code;                                                                                                       \
  }

WRAP(Allreduce, (const void* a, void* b, int n, MPI_Datatype t, MPI_Op o, MPI_Comm c), (a, b, n, t, o, c))
WRAP(Reduce, (const void* a, void* b, int n, MPI_Datatype t, MPI_Op o, int r, MPI_Comm c), (a, b, n, t, o, r, c))
WRAP(Scan, (const void* a, void* b, int n, MPI_Datatype t, MPI_Op o, MPI_Comm c), (a, b, n, t, o, c))
WRAP(Bcast, (void* a, int n, MPI_Datatype t, int r, MPI_Comm c), (a, n, t, r, c))
WRAP(Barrier, (MPI_Comm c), (c))
WRAP(Allgather, (const void* a, int n, MPI_Datatype t, void* b, int m, MPI_Datatype u, MPI_Comm c), (a, n, t, b, m, u, c))
WRAP(Alltoall, (const void* a, int n, MPI_Datatype t, void* b, int m, MPI_Datatype u, MPI_Comm c), (a, n, t, b, m, u, c))
WRAP(Comm_dup, (MPI_Comm c, MPI_Comm* d), (c, d))
WRAP(Comm_split, (MPI_Comm c, int colour, int key, MPI_Comm* d), (c, colour, key, d))
WRAP(Comm_free, (MPI_Comm* c), (c))
WRAP(Send, (const void* a, int n, MPI_Datatype t, int r, int tag, MPI_Comm c), (a, n, t, r, tag, c))
WRAP(Rsend, (const void* a, int n, MPI_Datatype t, int r, int tag, MPI_Comm c), (a, n, t, r, tag, c))
WRAP(Recv, (void* a, int n, MPI_Datatype t, int r, int tag, MPI_Comm c, MPI_Status* s), (a, n, t, r, tag, c, s))
WRAP(Mprobe, (int r, int tag, MPI_Comm c, MPI_Message* m, MPI_Status* s), (r, tag, c, m, s))
WRAP(Wait, (MPI_Request* r, MPI_Status* s), (r, s))
WRAP(Waitall, (int n, MPI_Request r[], MPI_Status s[]), (n, r, s))
WRAP(Waitany, (int n, MPI_Request r[], int* i, MPI_Status* s), (n, r, i, s))
