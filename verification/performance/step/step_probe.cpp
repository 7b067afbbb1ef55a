// A Kokkos Tools library for step_study.py: kernel launches in the steps of a run, and the CPU time
// of its phases on the thread that launches. Other processes disturb that time less than wall-clock
// time, and waits for other threads are not in it if they sleep (OMP_WAIT_POLICY=passive). Rank 0
// writes JSON to the file BRICKWALL_STEP_PROBE. The first step, which allocates memory, is not
// counted, nor is anything between steps. With BRICKWALL_STEP_PROBE_ONLY=1 phases are not timed,
// which takes less time.
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <map>
#include <string>
#include <vector>

namespace {

double cpuSeconds() {
  timespec time;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

struct OpenRegion {
  std::string name; // empty if it is not timed
  double begin;
};
std::vector<OpenRegion> open_regions;
std::map<std::string, double> phases; // CPU seconds of regions in steps
double setup = 0; // CPU seconds until the first step, without output
const bool only_steps = std::getenv("BRICKWALL_STEP_PROBE_ONLY") != nullptr;
bool is_in_step = false;
int steps = -1; // all but the first
std::array<long, 3> launches; // of parallel_for, parallel_reduce, parallel_scan

void count(int kind) {
  launches[kind] += is_in_step && steps >= 0;
}

} // namespace

extern "C" {
void kokkosp_push_profile_region(const char* name) {
  const bool is_step = std::strcmp(name, "miniapp::step") == 0;
  const bool is_timed = is_step || !only_steps;
  open_regions.push_back({is_timed ? name : "", is_timed ? cpuSeconds() : 0});
  if (!is_step)
    return;
  is_in_step = true;
  if (steps < 0)
    setup += open_regions.back().begin;
}
void kokkosp_pop_profile_region() {
  const auto& [name, begin] = open_regions.back();
  if (name.empty()) {
    open_regions.pop_back();
    return;
  }
  const double seconds = cpuSeconds() - begin;
  if (is_in_step && steps >= 0)
    phases[name] += seconds;
  if (name == "miniapp::output" && steps < 0)
    setup -= seconds;
  if (name == "miniapp::step") {
    is_in_step = false;
    ++steps;
  }
  open_regions.pop_back();
}
void kokkosp_begin_parallel_for(const char*, std::uint32_t, std::uint64_t*) {
  count(0);
}
void kokkosp_begin_parallel_reduce(const char*, std::uint32_t, std::uint64_t*) {
  count(1);
}
void kokkosp_begin_parallel_scan(const char*, std::uint32_t, std::uint64_t*) {
  count(2);
}
void kokkosp_finalize_library() {
  const char* const path = std::getenv("BRICKWALL_STEP_PROBE");
  const char* const rank = std::getenv("OMPI_COMM_WORLD_RANK");
  const bool writes = path && (!rank || std::strcmp(rank, "0") == 0);
  std::FILE* const file = writes ? std::fopen(path, "w") : nullptr;
  if (!file)
    return;
  std::fprintf(file, "{\"steps\": %d, \"launches\": [%ld, %ld, %ld], \"setup\": %.9g", steps,
               launches[0], launches[1], launches[2], setup);
  for (const auto& [name, seconds] : phases)
    std::fprintf(file, ",\n \"%s\": %.9g", name.c_str(), seconds);
  std::fprintf(file, "}\n");
  std::fclose(file);
}
}
