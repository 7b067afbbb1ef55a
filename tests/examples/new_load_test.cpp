// Worked example of CONTRIBUTING.md, "Adding a load": a pulse of force on chosen nodes.
#include "contact/base/sum_over.hpp"
#include "contact/base/to_device.hpp"
#include "mechanics/loads/pulse_shape.hpp"
#include "tests/mechanics/support/block_mesh.hpp"

#include <gtest/gtest.h>

namespace brickwall::mechanics {
namespace {

// Adds the force to one node at a time; counts what does not fit the fixed-point range.
struct AddNodalForce {
  View<const int*> nodes;
  ForceColumns forces;
  Vec3 quanta;

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t i, std::int64_t& misfits) const {
    for (int d = 0; d < 3; ++d) {
      forces(nodes(i), 3 * external_force + d) += roundToFixed(quanta[d]);
      misfits += !fitsFixedPoint(quanta[d]);
    }
  }
};

// A force on each of some nodes of this rank; a node that ranks share is given to one of them, and
// SharedNodeSum adds the parts.
class NodalForce {
public:
  NodalForce(const exec_space& space, const std::vector<int>& nodes, const Vec3& peak,
             const PulseShape& shape)
      : _nodes(toDevice(space, "example::NodalForce::nodes", nodes)), _peak(peak), _shape(shape) {}
  // The mean over the span of the kick, so that the impulse is exact for any length of the steps.
  std::int64_t add(const exec_space& space, const TimeSpan& span, const NodalForces& forces) const {
    const Vec3 quanta = forces.quantum.inverse * _shape.mean(span) * _peak;
    return sumOver<std::int64_t>("example::NodalForce::add", space, 0,
                                 static_cast<std::int64_t>(_nodes.extent(0)),
                                 AddNodalForce{_nodes, forces.values, quanta});
  }

private:
  View<int*> _nodes;
  Vec3 _peak; // force
  PulseShape _shape;
};

// The impulse of a half sine is 2 T/pi, here within kicks of 0.3 T, on 27 nodes. The sum here
// rounds 108 times to 2^-53 of at most 8.6: 1.1e-13.
TEST(ExampleLoad, ImpulseIsExactForLongSteps) {
  const exec_space space;
  const testing::BlockMesh blocks =
      testing::makeBlocks(space, testing::world, {testing::cube(2)}, {testing::steelLike()});
  const auto owned = toHost(blocks.mesh.node_is_owned);
  std::vector<int> nodes;
  for (int node = 0; node < blocks.mesh.num_nodes; ++node)
    if (owned(node))
      nodes.push_back(node);
  const NodalForce load(space, nodes, {0, 0, -0.5}, {PulseKind::half_sine, 1.0});
  double impulse = 0; // on this rank
  std::int64_t misfits = 0;
  for (int kick = 0; kick < 4; ++kick) {
    const NodalForces forces = testing::zeroedForces(blocks.mesh, Quantum::forForceScale(1.0));
    misfits += load.add(space, {0.3 * kick, 0.3 * (kick + 1)}, forces);
    const auto values = toHost(forces.values);
    for (int node = 0; node < blocks.mesh.num_nodes; ++node)
      impulse += 0.3 * forces.quantum.value * values(node, 3 * external_force + 2);
  }
  EXPECT_EQ(misfits, 0);
  const double exact = -0.5 * 2 / M_PI * allReduce(testing::world, double(nodes.size()), MPI_SUM);
  EXPECT_NEAR(allReduce(testing::world, impulse, MPI_SUM), exact, 1.1e-13);
}

} // namespace
} // namespace brickwall::mechanics
