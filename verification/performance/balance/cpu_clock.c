/* A library for LD_PRELOAD: the steady clock of a program is the CPU time of the calling thread, so
   that ranks which share cores measure their own work (balance_study.py --cpu-time). */
#define _GNU_SOURCE
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

int clock_gettime(clockid_t id, struct timespec* time) {
  return (int)syscall(SYS_clock_gettime, id == CLOCK_MONOTONIC ? CLOCK_THREAD_CPUTIME_ID : id, time);
}
