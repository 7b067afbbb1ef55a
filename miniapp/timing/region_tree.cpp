#include "miniapp/timing/region_tree.hpp"

#include "contact/base/backend.hpp"
#include "contact/base/mpi.hpp"
#include "contact/base/region.hpp"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <ctime>
#include <numeric>

namespace brickwall::miniapp {
namespace {

constexpr const char* search_prefix = "contact::search::";
constexpr std::size_t prefix_length = 17;
constexpr const char* meeting_region = "contact::search::waiting";
constexpr const char* local_search_region = "contact::search::local_search";

double now() {
  using clock = std::chrono::steady_clock;
  return std::chrono::duration<double>(clock::now().time_since_epoch()).count();
}

// CPU seconds of all threads of this process so far.
double cpuNow() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

int searchTimerOf(const std::string& region) {
  const auto& names = searchTimerNames();
  const auto found = std::find_if(names.begin(), names.end(), [&](const std::string& name) {
    return searchTimerRegion(name) == region;
  });
  return found == names.end() ? -1 : static_cast<int>(found - names.begin());
}

// The phases that every rank opens in every search, so that all ranks can wait for each other at
// their beginning.
bool isMeetingPoint(const std::string& region) {
  static const char* const names[] = {"node boxes", "face boxes",       "rank-box exchange",
                                      "partners",   "searches 0 and 1", "node-box exchange",
                                      "search 2",   "migration",        "local search"};
  return std::any_of(std::begin(names), std::end(names),
                     [&](const char* name) { return searchTimerRegion(name) == region; });
}

bool isOneOf(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

} // namespace

const std::vector<std::string>& searchTimerNames() {
  static const std::vector<std::string> names = {
      "initialization", "allocation",       "host-device copies",
      "node boxes",     "face boxes",       "rank-box exchange",
      "partners",       "searches 0 and 1", "node-box exchange",
      "search 2",       "waiting",          "migration",
      "other"};
  return names;
}

std::string searchTimerRegion(std::string timer) {
  for (char& character : timer)
    if (character == ' ' || character == '-')
      character = '_';
  return search_prefix + timer;
}

RegionTree::RegionTree(MPI_Comm comm, Timing timing) : _comm(comm), _timing(timing) {
  _nodes.reserve(256);
  _open.reserve(64);
}

int RegionTree::child(int parent, const char* name) {
  int last = -1;
  for (int node = _nodes[parent].first_child; node >= 0; node = _nodes[node].next_sibling) {
    if (std::strcmp(_nodes[node].name.c_str(), name) == 0)
      return node;
    last = node;
  }
  const int made = static_cast<int>(_nodes.size());
  Node node;
  node.name = name;
  node.parent = parent;
  node.timer = searchTimerOf(node.name);
  node.is_waiting = node.name == meeting_region;
  node.is_meeting_point = isMeetingPoint(node.name) && !isInsideSearchTimer(parent);
  node.counts_cpu = countsCpu(node);
  _nodes.push_back(std::move(node));
  (last >= 0 ? _nodes[last].next_sibling : _nodes[parent].first_child) = made;
  return made;
}

// Whether `node` is a region of that name, or inside one.
bool RegionTree::isWithin(int node, const std::string& region) const {
  while (node > 0 && _nodes[node].name != region)
    node = _nodes[node].parent;
  return node > 0;
}

bool RegionTree::isInsideSearchTimer(int node) const {
  while (node > 0 && _nodes[node].name.compare(0, prefix_length, search_prefix) != 0)
    node = _nodes[node].parent;
  return node > 0;
}

bool RegionTree::countsCpu(const Node& node) const {
  return _counts_cpu &&
         (_timing == Timing::paper || node.is_waiting || isOneOf(_cpu_regions, node.name));
}

void RegionTree::countCpu(const std::vector<std::string>& regions) {
  _counts_cpu = true;
  _cpu_regions = regions;
  for (Node& node : _nodes)
    node.counts_cpu = countsCpu(node);
}

// The wait for the slowest rank is a region of its own, before the phase begins.
void RegionTree::meet(int parent) {
  Kokkos::fence();
  const int waiting = child(parent, meeting_region);
  const double begin = now(), cpu_begin = cpuNow();
  barrier(_comm);
  Node& node = _nodes[waiting];
  node.seconds += now() - begin;
  node.cpu_seconds += cpuNow() - cpu_begin;
  ++node.calls;
}

void RegionTree::push(const char* name) {
  const int parent = current();
  const int node = child(parent, name);
  if (_timing == Timing::paper && _nodes[node].is_meeting_point)
    meet(parent);
  _open.push_back({node, now(), _nodes[node].counts_cpu ? cpuNow() : 0});
}

void RegionTree::pop() {
  if (_open.empty())
    return; // opened before the recorder was installed
  Node& node = _nodes[_open.back().node];
  if (_timing == Timing::paper && (node.timer >= 0 || node.is_meeting_point))
    Kokkos::fence();
  node.seconds += now() - _open.back().begin;
  if (node.counts_cpu)
    node.cpu_seconds += cpuNow() - _open.back().cpu_begin;
  ++node.calls;
  _open.pop_back();
}

void RegionTree::reset() {
  for (Node& node : _nodes) {
    node.calls = 0;
    node.seconds = node.cpu_seconds = 0;
  }
  const double begin = now(), cpu_begin = cpuNow();
  for (Open& region : _open)
    region = {region.node, begin, cpu_begin};
}

template <class Take>
void RegionTree::forOutermost(const std::string& region, Take&& take) const {
  for (const Node& node : _nodes)
    if (node.parent >= 0 && node.name == region && !isWithin(node.parent, region))
      take(node);
}

double RegionTree::seconds(const std::string& region) const {
  double sum = 0;
  forOutermost(region, [&](const Node& node) { sum += node.seconds; });
  return sum;
}

double RegionTree::busySeconds(const std::string& region) const {
  double sum = seconds(region);
  for (const Node& node : _nodes)
    if ((node.is_waiting || node.name == waiting_region) && isWithin(node.parent, region))
      sum -= node.seconds;
  return sum;
}

std::int64_t RegionTree::calls(const std::string& region) const {
  std::int64_t sum = 0;
  forOutermost(region, [&](const Node& node) { sum += node.calls; });
  return sum;
}

double RegionTree::cpuSeconds(const std::string& region) const {
  double sum = 0;
  forOutermost(region, [&](const Node& node) { sum += node.cpu_seconds; });
  return sum;
}

double RegionTree::busyCpuSeconds(const std::string& region) const {
  double sum = cpuSeconds(region);
  for (const Node& node : _nodes)
    if (node.is_waiting && isWithin(node.parent, region))
      sum -= node.cpu_seconds;
  return sum;
}

void RegionTree::sumTimers(TimerSums& own) const {
  const std::size_t num_timers = searchTimerNames().size(), other = num_timers - 1;
  own.seconds.assign(num_timers, 0);
  own.cpu_seconds.assign(num_timers, 0);
  own.calls.assign(num_timers, 0);
  for (const Node& node : _nodes) {
    if (node.timer < 0 || isWithin(node.parent, local_search_region))
      continue;
    own.seconds[node.timer] += node.seconds;
    own.cpu_seconds[node.timer] += node.cpu_seconds;
    own.calls[node.timer] += node.calls;
    int outer = node.parent;
    while (outer > 0 && _nodes[outer].timer < 0)
      outer = _nodes[outer].parent;
    if (outer > 0) {
      own.seconds[_nodes[outer].timer] -= node.seconds;
      own.cpu_seconds[_nodes[outer].timer] -= node.cpu_seconds;
    }
  }
  const auto addRest = [&](double whole, double local, std::vector<double>& timers) {
    const double told = std::accumulate(timers.begin(), timers.end() - 1, 0.0);
    timers[other] += std::max(0.0, whole - local - told);
  };
  addRest(seconds("contact::search"), seconds(local_search_region), own.seconds);
  addRest(cpuSeconds("contact::search"), cpuSeconds(local_search_region), own.cpu_seconds);
  own.calls[other] = std::max(own.calls[other], calls("contact::search"));
}

std::vector<std::string> RegionTree::names() const {
  std::vector<std::string> names;
  for (const Node& node : _nodes)
    if (node.parent >= 0 && !isOneOf(names, node.name))
      names.push_back(node.name);
  return names;
}

} // namespace brickwall::miniapp
