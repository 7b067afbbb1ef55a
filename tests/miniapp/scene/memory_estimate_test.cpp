// The estimate of `brickwall check` beside measured memory (miniapp/scene/memory_estimate.hpp).
#include "miniapp/scene/memory_estimate.hpp"

#include <gtest/gtest.h>

#include <initializer_list>

namespace brickwall::miniapp {
namespace {

// 435 bricks of 2n x n x n elements: W(n) of verification/performance/README.md.
SceneSize wall(std::int64_t n, bool has_contact = true) {
  return {435 * 2 * n * n * n,
          435 * (2 * n + 1) * (n + 1) * (n + 1),
          435 * 10 * n * n,
          435 * 16 * n,
          false,
          has_contact};
}

struct Measured {
  std::int64_t n;
  bool has_contact;
  int ranks;
  double megabytes;
};

// Pressed walls with output: memory in use of the fullest GPU. With contact on one H200,
// 2026-11-29; without on one and two H100, 2026-11-26.
TEST(MemoryEstimateTest, IsWithin15PercentOfThatOfGpus) {
  for (const Measured& run :
       {Measured{2, true, 1, 1261}, Measured{8, true, 1, 2052}, Measured{16, true, 1, 4740},
        Measured{32, true, 1, 19811}, Measured{32, false, 1, 12064}, Measured{32, false, 2, 6531},
        Measured{40, false, 2, 11686}}) {
    const MemoryEstimate memory = estimateMemory(wall(run.n, run.has_contact), run.ranks, true);
    EXPECT_NEAR(1e-6 * memory.of_device, run.megabytes, 0.15 * run.megabytes)
        << "W(" << run.n << ") on " << run.ranks;
  }
}

// The same on a processor, one rank: largest memory of the process.
TEST(MemoryEstimateTest, IsWithin15PercentOfThatOfProcessors) {
  for (const Measured& run : {Measured{2, true, 1, 79}, Measured{4, true, 1, 184},
                              Measured{8, true, 1, 672}, Measured{16, true, 1, 3401}}) {
    const MemoryEstimate memory = estimateMemory(wall(run.n, run.has_contact), run.ranks, false);
    EXPECT_NEAR(1e-6 * memory.of_rank, run.megabytes, 0.15 * run.megabytes) << "W(" << run.n << ")";
  }
}

} // namespace
} // namespace brickwall::miniapp
