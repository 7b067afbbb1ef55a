#include "miniapp/scene/force_range.hpp"

#include "contact/base/error.hpp"
#include "contact/base/fixed_point.hpp"
#include "contact/base/mpi.hpp"
#include "mechanics/element/hex8_geometry.hpp"

#include <algorithm>
#include <sstream>

namespace brickwall::miniapp {

namespace {

// (lambda + 2 mu) h^2 of this rank's weakest element of each block and of its strongest element.
struct ForceRange {
  std::vector<double> weakest; // [block]
  double strongest = 0;
};
ForceRange forceRangeOf(const io::MeshPart& part,
                        const std::vector<mechanics::Material>& materials) {
  ForceRange range;
  // elem_block ascends (MeshPart)
  for (std::size_t block = 0; block < part.blocks.size(); ++block) {
    const auto [first, last] =
        std::equal_range(part.elem_block.begin(), part.elem_block.end(), static_cast<int>(block));
    const double modulus = materials[block].lambda() + 2 * materials[block].mu();
    double weakest = HUGE_VAL, strongest = 0;
    Kokkos::parallel_reduce(
        "miniapp::checkForceRange",
        Kokkos::RangePolicy<host_exec_space, Kokkos::IndexType<std::int64_t>>(
            first - part.elem_block.begin(), last - part.elem_block.begin()),
        [&](const std::int64_t elem, double& least, double& most) {
          mechanics::CornerCoordinates X;
          for (int corner = 0; corner < 8; ++corner) {
            const std::size_t node = part.elem_nodes[8 * elem + corner];
            for (int d = 0; d < 3; ++d)
              X[corner][d] = part.coordinates[3 * node + d];
          }
          const double h = mechanics::longestEdge(X), force = modulus * h * h;
          least = std::min(least, force);
          most = std::max(most, force);
        },
        Kokkos::Min<double>(weakest), Kokkos::Max<double>(strongest));
    range.weakest.push_back(weakest);
    range.strongest = std::max(range.strongest, strongest);
  }
  return range;
}

} // namespace

std::vector<std::string> checkForceRange(MPI_Comm comm, const io::MeshPart& part,
                                         const std::vector<mechanics::Material>& materials) {
  ForceRange range = forceRangeOf(part, materials);
  allReduce(comm, range.weakest.data(), static_cast<int>(range.weakest.size()), MPI_MIN);
  range.strongest = allReduce(comm, range.strongest, MPI_MAX);
  std::vector<std::string> warnings;
  if (!(range.strongest > 0))
    return warnings;
  const double quantum = Quantum::forForceScale(range.strongest).value;
  for (std::size_t block = 0; block < range.weakest.size(); ++block) {
    const double rounding = quantum / range.weakest[block];
    if (!(rounding > coarse_forces))
      continue;
    std::ostringstream text;
    text.precision(2);
    text << "element block '" << part.blocks[block].name
         << "': the relative resolution of the forces of its weakest element at a strain of one, "
            "(lambda + 2 mu) h^2, is only "
         << rounding << ", because one quantum serves all blocks and the strongest element is "
         << range.strongest / range.weakest[block] << " times as strong";
    if (rounding > too_coarse_forces)
      throw InputError(text.str() +
                       "; expected at most 1e-6: make the strong elements smaller or softer, or "
                       "prescribe the motion of a small part of that body");
    warnings.push_back(text.str());
  }
  return warnings;
}

} // namespace brickwall::miniapp
