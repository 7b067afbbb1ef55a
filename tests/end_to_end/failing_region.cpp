// A Kokkos Tools library for lone_failures.py: on one rank, the first region, kernel or allocation
// of a name after a number of steps throws std::bad_alloc, as if memory had run out there.
// Environment:
// BRICKWALL_FAULT_RANK, BRICKWALL_FAULT_STEP; BRICKWALL_FAULT_NAME, or BRICKWALL_FAULT_LIST, a file
// to which the names from that step on are written instead. With BRICKWALL_FAULT_ALLOCATION = N,
// the N-th `new` of the main thread after that name throws; the library is to be preloaded then.
// A line on standard error says that the name has come up.
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <new>
#include <set>
#include <string>
#include <unistd.h>

namespace {

std::string variable(const char* name) {
  const char* const value = std::getenv(name);
  return value ? value : "";
}

const std::string fault_name = variable("BRICKWALL_FAULT_NAME");
const std::string list_file = variable("BRICKWALL_FAULT_LIST");
const int first_step = std::atoi(variable("BRICKWALL_FAULT_STEP").c_str());
const bool is_chosen = variable("OMPI_COMM_WORLD_RANK") == variable("BRICKWALL_FAULT_RANK");
const int first_allocation = std::atoi(variable("BRICKWALL_FAULT_ALLOCATION").c_str());
int steps = 0;
int allocations_left = 0; // until one fails; 0: none does
bool has_failed = false;
std::set<std::string> names;

void meet(const char* name) {
  if (!is_chosen || steps < first_step || has_failed)
    return;
  if (!list_file.empty()) {
    names.insert(name);
  } else if (fault_name == name) {
    has_failed = true;
    allocations_left = first_allocation;
    constexpr char text[] = "failing_region: the name has come up\n";
    [[maybe_unused]] const auto written = write(STDERR_FILENO, text, sizeof text - 1);
    if (allocations_left == 0)
      throw std::bad_alloc();
  }
}

} // namespace

void* operator new(std::size_t bytes) {
  if (allocations_left > 0 && gettid() == getpid() && --allocations_left == 0)
    throw std::bad_alloc();
  if (void* const memory = std::malloc(bytes > 0 ? bytes : 1))
    return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}

struct SpaceHandle {
  char name[64];
};

extern "C" {
void kokkosp_push_profile_region(const char* name) {
  steps += std::strcmp(name, "miniapp::step") == 0;
  meet(name);
}
void kokkosp_begin_parallel_for(const char* name, std::uint32_t, std::uint64_t*) {
  meet(name);
}
void kokkosp_begin_parallel_reduce(const char* name, std::uint32_t, std::uint64_t*) {
  meet(name);
}
void kokkosp_begin_parallel_scan(const char* name, std::uint32_t, std::uint64_t*) {
  meet(name);
}
void kokkosp_allocate_data(SpaceHandle, const char* name, const void*, std::uint64_t) {
  meet(name);
}
void kokkosp_finalize_library() {
  if (!is_chosen || list_file.empty())
    return;
  std::ofstream file(list_file);
  for (const std::string& name : names)
    file << name << '\n';
}
}
