// See phase_report.hpp. Kokkos' callbacks are plain functions, so the installed recorder is known by one pointer in
// this file; nothing else in the program is global.
#include "miniapp/phase_report.hpp"

#include "contact/base/backend.hpp"
#include "contact/base/mpi.hpp"

#include <algorithm>
#include <chrono>
#include <cstring>

namespace brickwall::miniapp {
namespace {

constexpr const char* search_prefix = "search::";
constexpr std::size_t prefix_length = 8;

double now() {
  using clock = std::chrono::steady_clock;
  return std::chrono::duration<double>(clock::now().time_since_epoch()).count();
}

bool isSearchTimer(const std::string& region) {
  const auto& names = searchTimerNames();
  return region.compare(0, prefix_length, search_prefix) == 0 &&
         std::find(names.begin(), names.end(), region.substr(prefix_length)) != names.end();
}

// The phases that every rank goes through in every search, so that all may meet at their begin.
bool isMeetingPoint(const std::string& region) {
  static const char* const names[] = {"node boxes", "face boxes",       "rank-box exchange",
                                      "partners",   "searches 0 and 1", "node-box exchange",
                                      "search 2",   "migration",        "local search"};
  return region.compare(0, prefix_length, search_prefix) == 0 &&
         std::any_of(std::begin(names), std::end(names), [&](const char* name) {
           return region.compare(prefix_length, std::string::npos, name) == 0;
         });
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

// Regions form a tree: the same name under two parents is two nodes.
struct PhaseRecorder::State {
  struct Node {
    std::string name;
    int parent = -1, first_child = -1, next_sibling = -1;
    bool is_timer = false; // one of the 13
    bool is_meeting_point = false; // with Timing::paper, outside of any other search timer
    std::int64_t calls = 0;
    double seconds = 0;
  };
  struct Open {
    int node;
    double begin;
  };
  struct Watch {
    std::string region;
    double seconds_before = 0;
    std::vector<double> samples;
  };

  MPI_Comm comm = MPI_COMM_NULL;
  Timing timing = Timing::normal;
  Kokkos::Tools::Experimental::EventSet earlier_tools;
  std::vector<Node> nodes{Node()}; // node 0 is the root
  std::vector<Open> open;
  std::vector<Watch> watches;

  int current() const { return open.empty() ? 0 : open.back().node; }

  int child(int parent, const char* name) {
    int last = -1;
    for (int node = nodes[parent].first_child; node >= 0; node = nodes[node].next_sibling) {
      if (std::strcmp(nodes[node].name.c_str(), name) == 0)
        return node;
      last = node;
    }
    const int made = static_cast<int>(nodes.size());
    Node node;
    node.name = name;
    node.parent = parent;
    node.is_timer = isSearchTimer(node.name);
    node.is_meeting_point = isMeetingPoint(node.name) && !isInside(parent, search_prefix);
    nodes.push_back(std::move(node));
    (last >= 0 ? nodes[last].next_sibling : nodes[parent].first_child) = made;
    return made;
  }

  bool isInside(int node, const char* prefix) const {
    for (; node > 0; node = nodes[node].parent)
      if (nodes[node].name.compare(0, std::strlen(prefix), prefix) == 0)
        return true;
    return false;
  }

  // The wait for the slowest rank is a region of its own, "search::waiting", before the phase begins.
  void meet(int parent) {
    Kokkos::fence();
    const int waiting = child(parent, "search::waiting");
    const double begin = now();
    MPI_Barrier(comm);
    nodes[waiting].seconds += now() - begin;
    ++nodes[waiting].calls;
  }

  void push(const char* name) {
    const int parent = current();
    const int node = child(parent, name);
    if (timing == Timing::paper && nodes[node].is_meeting_point)
      meet(parent);
    open.push_back({node, now()});
  }

  void pop() {
    if (open.empty())
      return; // opened before the recorder was there
    Node& node = nodes[open.back().node];
    if (timing == Timing::paper && (node.is_timer || node.is_meeting_point))
      Kokkos::fence();
    node.seconds += now() - open.back().begin;
    ++node.calls;
    open.pop_back();
  }

  // Sums over the nodes of that name that are not inside another of that name.
  template <class Take>
  void forOutermost(const std::string& region, Take&& take) const {
    for (const Node& node : nodes) {
      if (node.parent < 0 || node.name != region)
        continue;
      int outer = node.parent;
      while (outer > 0 && nodes[outer].name != region)
        outer = nodes[outer].parent;
      if (outer <= 0)
        take(node);
    }
  }
  double seconds(const std::string& region) const {
    double sum = 0;
    forOutermost(region, [&](const Node& node) { sum += node.seconds; });
    return sum;
  }
  std::int64_t calls(const std::string& region) const {
    std::int64_t sum = 0;
    forOutermost(region, [&](const Node& node) { sum += node.calls; });
    return sum;
  }

  // Own seconds of each timer: those of timers inside it are taken off.
  void timerSeconds(std::vector<double>& seconds, std::vector<std::int64_t>& calls) const {
    const auto& names = searchTimerNames();
    const auto indexOf = [&](const Node& node) {
      return static_cast<std::size_t>(
          std::find(names.begin(), names.end(), node.name.substr(prefix_length)) - names.begin());
    };
    seconds.assign(names.size(), 0);
    calls.assign(names.size(), 0);
    for (const Node& node : nodes) {
      if (!node.is_timer)
        continue;
      seconds[indexOf(node)] += node.seconds;
      calls[indexOf(node)] += node.calls;
      int outer = node.parent;
      while (outer > 0 && !nodes[outer].is_timer)
        outer = nodes[outer].parent;
      if (outer > 0)
        seconds[indexOf(nodes[outer])] -= node.seconds;
    }
  }
};

namespace {

PhaseRecorder::State* installed = nullptr;

void pushRegion(const char* name) {
  if (installed->earlier_tools.push_region)
    installed->earlier_tools.push_region(name);
  installed->push(name);
}
void popRegion() {
  installed->pop();
  if (installed->earlier_tools.pop_region)
    installed->earlier_tools.pop_region();
}

PhaseTime reduceTime(MPI_Comm comm, const std::string& name, std::int64_t calls, double seconds) {
  PhaseTime time;
  time.name = name;
  time.calls = allReduce(comm, calls, MPI_MAX);
  time.min = allReduce(comm, seconds, MPI_MIN);
  time.max = allReduce(comm, seconds, MPI_MAX);
  time.mean = allReduce(comm, seconds, MPI_SUM) / sizeOf(comm);
  return time;
}

std::vector<std::string> splitNames(const std::string& text) {
  std::vector<std::string> names;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = text.find('\n', begin);
    names.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return names;
}

// Collective. All names that any rank has, in one order on all ranks: first those of rank 0, then of the next rank
// that has more, ...
std::vector<std::string> agreeOnNames(MPI_Comm comm, const std::vector<std::string>& mine) {
  std::vector<std::string> known;
  const auto isKnown = [&](const std::string& name) {
    return std::find(known.begin(), known.end(), name) != known.end();
  };
  const int none = sizeOf(comm);
  while (true) {
    std::string missing;
    for (const std::string& name : mine)
      if (!isKnown(name))
        missing += name + "\n";
    const int teller = allReduce(comm, missing.empty() ? none : rankOf(comm), MPI_MIN);
    if (teller == none)
      return known;
    for (const std::string& name : splitNames(broadcast(comm, missing, teller)))
      known.push_back(name);
  }
}

} // namespace

PhaseRecorder::PhaseRecorder(MPI_Comm comm, Timing timing) : _state(new State) {
  if (installed) {
    delete _state;
    throw Error(ExitCode::internal,
                "PhaseRecorder: found a second recorder, expected one at a time");
  }
  _state->comm = comm;
  _state->timing = timing;
  _state->nodes.reserve(256);
  _state->open.reserve(64);
  _state->earlier_tools = Kokkos::Tools::Experimental::get_callbacks();
  installed = _state;
  Kokkos::Tools::Experimental::set_push_region_callback(pushRegion);
  Kokkos::Tools::Experimental::set_pop_region_callback(popRegion);
}

PhaseRecorder::~PhaseRecorder() {
  Kokkos::Tools::Experimental::set_push_region_callback(_state->earlier_tools.push_region);
  Kokkos::Tools::Experimental::set_pop_region_callback(_state->earlier_tools.pop_region);
  installed = nullptr;
  delete _state;
}

void PhaseRecorder::reset() {
  for (State::Node& node : _state->nodes) {
    node.calls = 0;
    node.seconds = 0;
  }
  const double begin = now();
  for (State::Open& region : _state->open)
    region.begin = begin;
  for (State::Watch& watch : _state->watches) {
    watch.seconds_before = 0;
    watch.samples.clear();
  }
}

double PhaseRecorder::seconds(const std::string& region) const {
  return _state->seconds(region);
}
std::int64_t PhaseRecorder::calls(const std::string& region) const {
  return _state->calls(region);
}

void PhaseRecorder::watch(const std::string& region, std::int64_t expected_steps) {
  State::Watch watch;
  watch.region = region;
  watch.seconds_before = seconds(region);
  constexpr std::int64_t most = 1 << 20; // beyond it the list grows as it must
  watch.samples.reserve(
      static_cast<std::size_t>(std::min(std::max<std::int64_t>(expected_steps, 16), most)));
  _state->watches.push_back(std::move(watch));
}

void PhaseRecorder::endStep() {
  for (State::Watch& watch : _state->watches) {
    const double total = seconds(watch.region);
    watch.samples.push_back(total - watch.seconds_before);
    watch.seconds_before = total;
  }
}

double PhaseRecorder::medianPerStep(const std::string& region) const {
  for (const State::Watch& watch : _state->watches) {
    if (watch.region != region)
      continue;
    std::vector<double> slowest = watch.samples;
    const auto steps = allReduce(_state->comm, static_cast<std::int64_t>(slowest.size()), MPI_MIN);
    if (steps == 0)
      return 0;
    slowest.resize(static_cast<std::size_t>(steps));
    allReduce(_state->comm, slowest.data(), checkedInt(steps, "samples of a region"), MPI_MAX);
    const auto middle = slowest.begin() + steps / 2;
    std::nth_element(slowest.begin(), middle, slowest.end());
    if (steps % 2 == 1)
      return *middle;
    return 0.5 * (*middle + *std::max_element(slowest.begin(), middle));
  }
  throw Error(ExitCode::internal, "PhaseRecorder: region \"" + region + "\" is not watched");
}

std::vector<PhaseTime> PhaseRecorder::phases() const {
  std::vector<std::string> mine;
  for (const State::Node& node : _state->nodes)
    if (node.parent >= 0 && std::find(mine.begin(), mine.end(), node.name) == mine.end())
      mine.push_back(node.name);
  std::vector<PhaseTime> times;
  for (const std::string& name : agreeOnNames(_state->comm, mine))
    times.push_back(reduceTime(_state->comm, name, calls(name), seconds(name)));
  return times;
}

std::vector<PhaseTime> PhaseRecorder::searchTimers() const {
  std::vector<double> own_seconds;
  std::vector<std::int64_t> own_calls;
  _state->timerSeconds(own_seconds, own_calls);
  double rest = seconds("search") - seconds("search::local search");
  for (std::size_t i = 0; i + 1 < own_seconds.size(); ++i)
    rest -= own_seconds[i];
  own_seconds.back() += std::max(0.0, rest); // "other"
  own_calls.back() = std::max(own_calls.back(), calls("search"));
  std::vector<PhaseTime> times;
  for (std::size_t i = 0; i < own_seconds.size(); ++i)
    times.push_back(reduceTime(_state->comm, searchTimerNames()[i], own_calls[i], own_seconds[i]));
  return times;
}

} // namespace brickwall::miniapp
