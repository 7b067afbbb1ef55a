// The callbacks of Kokkos are plain functions, so that a pointer in this file holds the installed
// recorder.
#include "miniapp/timing/phase_recorder.hpp"

#include "contact/base/backend.hpp"
#include "contact/base/mpi.hpp"

#include <algorithm>

namespace brickwall::miniapp {

struct PhaseRecorder::State {
  struct Watch {
    std::string region;
    StepSamples samples;
  };

  State(MPI_Comm comm, Timing timing) : comm(comm), regions(comm, timing) {}

  static StepStatistics statistics(MPI_Comm comm, const std::vector<Watch>& watches,
                                   const std::string& region) {
    for (const Watch& watch : watches)
      if (watch.region == region)
        return watch.samples.statistics(comm);
    throw Error(ExitCode::internal, "PhaseRecorder: region \"" + region + "\" is not watched");
  }

  MPI_Comm comm = MPI_COMM_NULL;
  Kokkos::Tools::Experimental::EventSet earlier_tools;
  RegionTree regions;
  std::vector<Watch> watches, cpu_watches;
  std::vector<StepSamples> timer_watches, timer_cpu_watches; // none, or one for each of the 13
  RegionTree::TimerSums timer_sums; // at the end of the last step
};

namespace {

PhaseRecorder::State* installed = nullptr;

void pushRegion(const char* name) {
  if (installed->earlier_tools.push_region)
    installed->earlier_tools.push_region(name);
  installed->regions.push(name);
}
void popRegion() {
  installed->regions.pop();
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

// Collective. All names of any rank, in the same order on all ranks: first those of rank 0, then
// those that the next rank adds, and so on.
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
    const int sender = allReduce(comm, missing.empty() ? none : rankOf(comm), MPI_MIN);
    if (sender == none)
      return known;
    for (const std::string& name : splitNames(broadcast(comm, missing, sender)))
      known.push_back(name);
  }
}

} // namespace

PhaseRecorder::PhaseRecorder(MPI_Comm comm, Timing timing) : _state(new State(comm, timing)) {
  if (installed) {
    delete _state;
    throw Error(ExitCode::internal,
                "PhaseRecorder: found a second recorder, expected one at a time");
  }
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
  _state->regions.reset();
  for (auto* watches : {&_state->watches, &_state->cpu_watches})
    for (State::Watch& watch : *watches)
      watch.samples.reset();
  for (auto* watches : {&_state->timer_watches, &_state->timer_cpu_watches})
    for (StepSamples& samples : *watches)
      samples.reset();
}

double PhaseRecorder::seconds(const std::string& region) const {
  return _state->regions.seconds(region);
}
std::int64_t PhaseRecorder::calls(const std::string& region) const {
  return _state->regions.calls(region);
}

double PhaseRecorder::busySeconds(const std::string& region) const {
  return _state->regions.busySeconds(region);
}

void PhaseRecorder::watch(const std::string& region, std::int64_t expected_steps) {
  _state->watches.push_back({region, StepSamples(expected_steps, seconds(region))});
}

void PhaseRecorder::watchCpu(const std::vector<std::string>& regions, std::int64_t expected_steps) {
  _state->regions.countCpu(regions);
  for (const std::string& region : regions)
    _state->cpu_watches.push_back({region, StepSamples(expected_steps)});
}

void PhaseRecorder::watchSearchTimers(std::int64_t expected_steps) {
  _state->regions.sumTimers(_state->timer_sums);
  for (const double seconds : _state->timer_sums.seconds)
    _state->timer_watches.emplace_back(expected_steps, seconds);
  for (const double seconds : _state->timer_sums.cpu_seconds)
    _state->timer_cpu_watches.emplace_back(expected_steps, seconds);
}

void PhaseRecorder::endStep() {
  for (State::Watch& watch : _state->watches)
    watch.samples.endStep(seconds(watch.region));
  for (State::Watch& watch : _state->cpu_watches)
    watch.samples.endStep(_state->regions.busyCpuSeconds(watch.region));
  if (_state->timer_watches.empty())
    return;
  _state->regions.sumTimers(_state->timer_sums);
  for (std::size_t timer = 0; timer < _state->timer_watches.size(); ++timer) {
    _state->timer_watches[timer].endStep(_state->timer_sums.seconds[timer]);
    _state->timer_cpu_watches[timer].endStep(_state->timer_sums.cpu_seconds[timer]);
  }
}

StepStatistics PhaseRecorder::secondsPerStep(const std::string& region) const {
  return State::statistics(_state->comm, _state->watches, region);
}
StepStatistics PhaseRecorder::busyCpuPerStep(const std::string& region) const {
  return State::statistics(_state->comm, _state->cpu_watches, region);
}

std::vector<PhaseSteps> PhaseRecorder::searchTimersPerStep() const {
  std::vector<PhaseSteps> timers;
  for (std::size_t timer = 0; timer < _state->timer_watches.size(); ++timer)
    timers.push_back({searchTimerNames()[timer],
                      _state->timer_watches[timer].statistics(_state->comm),
                      _state->timer_cpu_watches[timer].statistics(_state->comm)});
  return timers;
}

std::vector<PhaseTime> PhaseRecorder::phases() const {
  std::vector<PhaseTime> times;
  for (const std::string& name : agreeOnNames(_state->comm, _state->regions.names()))
    times.push_back(reduceTime(_state->comm, name, calls(name), seconds(name)));
  std::stable_sort(times.begin(), times.end(),
                   [](const PhaseTime& a, const PhaseTime& b) { return a.mean > b.mean; });
  return times;
}

std::vector<PhaseTime> PhaseRecorder::searchTimers() const {
  RegionTree::TimerSums own;
  _state->regions.sumTimers(own);
  std::vector<PhaseTime> times;
  for (std::size_t i = 0; i < own.seconds.size(); ++i)
    times.push_back(reduceTime(_state->comm, searchTimerNames()[i], own.calls[i], own.seconds[i]));
  return times;
}

} // namespace brickwall::miniapp
