// Owners of the nodes to which several threads add forces, so that few additions are atomic. The
// first thread that adds to a block of nodes owns it from then on, and no other thread adds to its
// forces; what the others add is summed beside them by atomic operations, until addOthers().
// Neighbouring nodes have neighbouring numbers, and their rows belong to one thread, so these are
// few, wherever an execution space gives the same rows to the same threads in each step; results do
// not depend on it, since sums are integers.
#pragma once

#include "contact/base/backend.hpp"

namespace brickwall::contact {

struct NodeOwners {
  static constexpr int block_size = 16; // nodes of a block; owners of all blocks fit a cache

  View<int*> owner; // [block] threadNumber(), 0: none yet; empty: all additions are atomic
  View<std::int64_t* [3]> by_others; // [node][xyz], quanta; zero between kernels
  View<unsigned char*> has_others; // [block] by_others is not zero at one of its nodes

  NodeOwners() = default;
  NodeOwners(const std::string& label, int num_nodes)
      : owner(label + "::owner", blockOf(num_nodes) + 1),
        by_others(label + "::by_others", num_nodes),
        has_others(label + "::has_others", blockOf(num_nodes) + 1) {}
  KOKKOS_FORCEINLINE_FUNCTION static int blockOf(int node) { return node / block_size; }

  KOKKOS_FORCEINLINE_FUNCTION bool areKnown() const { return owner.extent(0) > 0; }
  // Whether the thread owns the block, if need be from now on.
  KOKKOS_FORCEINLINE_FUNCTION bool owns(int thread, int block) const {
    const int present = loadShared(owner(block));
    return present == thread ||
           (present == 0 && Kokkos::atomic_compare_exchange(&owner(block), 0, thread) == 0);
  }
};

// Adds by_others of a block of nodes to their forces. Kernel functor of addOthers().
struct AddOthers {
  NodeOwners owners;
  View<std::int64_t* [3]> forces;

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t block) const {
    if (!owners.has_others(block))
      return;
    owners.has_others(block) = 0;
    const std::int64_t first = block * NodeOwners::block_size;
    const std::int64_t end = minOf<std::int64_t>(first + NodeOwners::block_size, forces.extent(0));
    for (std::int64_t node = first; node < end; ++node)
      for (int d = 0; d < 3; ++d) {
        forces(node, d) += owners.by_others(node, d);
        owners.by_others(node, d) = 0;
      }
  }
};

// Adds what threads have added to the nodes of others to the forces, after the kernel.
inline void addOthers(const exec_space& space, const NodeOwners& owners,
                      const View<std::int64_t* [3]>& forces) {
  Kokkos::parallel_for("contact::addOthers",
                       rangePolicy(space, static_cast<std::int64_t>(owners.has_others.extent(0))),
                       AddOthers{owners, forces});
}

} // namespace brickwall::contact
