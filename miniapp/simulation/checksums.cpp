// Numbers that tell whether two runs have the same bits.
#include "contact/base/hash.hpp"
#include "contact/base/mpi.hpp"
#include "contact/enforcement/reports/history_checksum.hpp"
#include "miniapp/simulation/simulation.hpp"

namespace brickwall::miniapp {

namespace {

struct HashNode {
  View<const global_id*> ids;
  View<const unsigned char*> is_owned;
  View<const double*[3]> displacement, velocity;
  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t node, std::uint64_t& sum) const {
    if (!is_owned(node))
      return;
    Hash hash;
    hash.take(ids(node));
    for (int i = 0; i < 3; ++i) {
      hash.take(displacement(node, i));
      hash.take(velocity(node, i));
    }
    sum += hash.value();
  }
};

} // namespace

Checksums Simulation::checksums() const {
  const auto& mesh = _scene.mesh;
  std::uint64_t nodes = 0, contacts = 0;
  Kokkos::parallel_reduce(
      "miniapp::checksums::nodes", rangePolicy(_space, mesh.num_nodes),
      HashNode{mesh.node_ids, mesh.node_is_owned, _state.displacement, _state.velocity},
      Kokkos::Sum<std::uint64_t>(nodes));
  _space.fence();
  std::int64_t interactions = 0;
  const auto add = [&](const View<const global_id*>& ids, const contact::ContactHistory& history) {
    contacts += contact::historyChecksum(_space, ids, history);
    interactions += history.count;
  };
  if (_coupling)
    add(_coupling->surface().node_ids, _enforcement->history());
  if (_edges)
    add(_edges->nodeIds(), _edges->history());
  // Signed sums wrap in MPI as unsigned ones do.
  std::int64_t sums[3] = {static_cast<std::int64_t>(nodes), static_cast<std::int64_t>(contacts),
                          interactions};
  allReduce(_comm, sums, 3, MPI_SUM);
  return {static_cast<std::uint64_t>(sums[0]), static_cast<std::uint64_t>(sums[1]), sums[2]};
}

} // namespace brickwall::miniapp
