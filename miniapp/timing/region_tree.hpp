// The tree of profiling regions that one rank has opened, with calls, seconds and CPU seconds of
// each; the same name under two parents is two nodes. PhaseRecorder (phase_recorder.hpp) fills it.
#pragma once

#include "miniapp/timing/timing.hpp"

#include <mpi.h>

#include <cstdint>
#include <string>
#include <vector>

namespace brickwall::miniapp {

// Names of the 13 timers of the global search, in the order of the paper.
const std::vector<std::string>& searchTimerNames();
// The region of a timer: "contact::search::node_boxes" of "node boxes".
std::string searchTimerRegion(std::string timer);

class RegionTree {
public:
  // With Timing::paper the outermost phases of the search fence, and all ranks of `comm` wait for
  // each other at their beginning, in a region "contact::search::waiting".
  RegionTree(MPI_Comm comm, Timing timing);

  void push(const char* name);
  void pop();
  // Forgets all calls and seconds; open regions count from this point.
  void reset();

  // Starts to count the CPU seconds of all threads of this process in regions of these names (with
  // Timing::paper in all regions). Costs a system call at both ends of each such region. None of
  // them may be open.
  void countCpu(const std::vector<std::string>& regions);

  // Sums over the regions of that name on this rank, not counting twice those inside another region
  // of that name.
  double seconds(const std::string& region) const;
  std::int64_t calls(const std::string& region) const;
  // The same of the seconds, less those in waits for other ranks inside.
  double busySeconds(const std::string& region) const;
  // The same of CPU seconds, less those in "contact::search::waiting" inside: a rank that waits for
  // others keeps its core busy.
  double busyCpuSeconds(const std::string& region) const;

  // Own time of each of the 13 timers, without that of nested timers; the last, "other", is the
  // rest of "contact::search" without the local search: the sum is the time of the global search.
  // CPU seconds as far as they are counted.
  struct TimerSums {
    std::vector<double> seconds, cpu_seconds;
    std::vector<std::int64_t> calls;
  };
  void sumTimers(TimerSums& sums) const;

  // All names in the order of first opening.
  std::vector<std::string> names() const;

private:
  struct Node {
    std::string name;
    int parent = -1, first_child = -1, next_sibling = -1;
    int timer = -1; // index among the 13; -1: none
    bool is_waiting = false;
    bool is_meeting_point = false; // with Timing::paper, outside of any other search timer
    bool counts_cpu = false;
    std::int64_t calls = 0;
    double seconds = 0;
    double cpu_seconds = 0;
  };
  struct Open {
    int node;
    double begin, cpu_begin;
  };

  int current() const { return _open.empty() ? 0 : _open.back().node; }
  int child(int parent, const char* name);
  double cpuSeconds(const std::string& region) const; // waiting included
  bool isWithin(int node, const std::string& region) const;
  bool isInsideSearchTimer(int node) const;
  bool countsCpu(const Node& node) const;
  void meet(int parent);
  template <class Take>
  void forOutermost(const std::string& region, Take&& take) const;

  MPI_Comm _comm;
  Timing _timing;
  bool _counts_cpu = false;
  std::vector<std::string> _cpu_regions;
  std::vector<Node> _nodes{Node()}; // node 0 is the root
  std::vector<Open> _open;
};

} // namespace brickwall::miniapp
