// Every kernel, View and profiling region of a coupled run carries a label of one scheme, so that a
// profile can be read: library::place, with the function or class that launches, allocates or opens
// it ("contact::constructBoxes::faces").
#include "miniapp/simulation/diagnostics.hpp"
#include "tests/miniapp/simulation/case.hpp"

#include <gtest/gtest.h>

#include <regex>
#include <set>
#include <string>

namespace {

using brickwall::verification::Case;

std::set<std::string> kernels, regions, views;

// Collects labels as long as it lives.
class LabelRecorder {
public:
  LabelRecorder() {
    namespace tools = Kokkos::Tools::Experimental;
    tools::set_begin_parallel_for_callback(noteKernel);
    tools::set_begin_parallel_reduce_callback(noteKernel);
    tools::set_begin_parallel_scan_callback(noteKernel);
    tools::set_push_region_callback([](const char* name) { regions.insert(name); });
    tools::set_allocate_data_callback([](Kokkos_Profiling_SpaceHandle, const char* name,
                                         const void*, std::uint64_t) { views.insert(name); });
  }
  ~LabelRecorder() { Kokkos::Tools::Experimental::set_callbacks({}); }
  LabelRecorder(const LabelRecorder&) = delete;
  LabelRecorder& operator=(const LabelRecorder&) = delete;

private:
  static void noteKernel(const char* name, std::uint32_t, std::uint64_t*) { kernels.insert(name); }
};

// Initialisation and copies of Views, scratch memory of its threads, mirrors of Views without data.
bool isOfKokkos(const std::string& label) {
  return label.empty() || label == "[unlabeled]" || label.compare(0, 6, "Kokkos") == 0;
}

void expectScheme(const char* what, const std::set<std::string>& labels) {
  static const std::regex scheme("(base|contact|mechanics|io|miniapp)(::[A-Za-z0-9_]+)+");
  EXPECT_FALSE(labels.empty());
  for (const std::string& label : labels)
    EXPECT_TRUE(isOfKokkos(label) || std::regex_match(label, scheme))
        << what << " \"" << label << "\"";
}

// Bricks that press each other and slide: faces, edges, friction, viscosity, loads, audits.
const char* const pressed_wall = R"(
[wall]
bricks = [2, 1, 3]
brick = [0.2, 0.1, 0.1]
elements = [4, 2, 2]
[material.brick]
density = 2000
youngs_modulus = 20e9
poissons_ratio = 0.2
[[load.pressure]]
side_set = "top"
peak = 1e6
shape = "step"
[[boundary.fixed]]
node_set = "base"
[gravity]
acceleration = [0, 0, -9.81]
[viscosity]
linear = 0.06
[contact]
friction = 0.3
[time]
end = 1
check_interval = 10
)";

TEST(Labels, OfACoupledRunFollowOneScheme) {
  const LabelRecorder recorder;
  for (const char* search : {"method = \"cluster\"", "method = \"paper\"\naudit = 5"}) {
    Case wall(std::string(pressed_wall) + "[search]\n" + search + "\n");
    wall.simulation.start();
    for (int step = 0; step < 40; ++step)
      wall.simulation.step();
    EXPECT_GT(contactCounts(wall.simulation).active, 0);
    checksums(wall.simulation);
  }
  expectScheme("kernel", kernels);
  expectScheme("region", regions);
  expectScheme("View", views);
}

} // namespace
