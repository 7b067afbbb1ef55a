#include "miniapp/scene/conflicting_sets.hpp"

#include "contact/base/mpi.hpp"
#include "miniapp/deck/boundary_conflicts.hpp"
#include "miniapp/scene/entity_names.hpp"
#include "miniapp/scene/scene.hpp"

#include <algorithm>
#include <iterator>

namespace brickwall::miniapp {

namespace {

struct CommonNodes {
  std::int64_t count = 0; // of all ranks
  global_id lowest = -1;
};
CommonNodes commonNodes(MPI_Comm comm, const io::MeshPart& part, const io::NodeSet& a,
                        const io::NodeSet& b) {
  std::vector<int> common; // local indices and ids of nodes have the same order
  std::set_intersection(a.nodes.begin(), a.nodes.end(), b.nodes.begin(), b.nodes.end(),
                        std::back_inserter(common));
  CommonNodes found;
  for (const int node : common)
    found.count += part.node_owner[node] == rankOf(comm);
  found.count = allReduce(comm, found.count, MPI_SUM);
  found.lowest = allReduce(
      comm, common.empty() ? part.num_global_nodes : part.node_ids[common.front()], MPI_MIN);
  return found;
}

} // namespace

void refuseConflictingSets(MPI_Comm comm, const Config& config, const io::MeshPart& part) {
  const std::vector<Boundary> all = boundariesOf(config);
  std::string faults;
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const auto &one = all[j].motion, &other = all[i].motion;
      const std::string components = differingComponents(one, other);
      if (components.empty())
        continue;
      const CommonNodes common =
          commonNodes(comm, part, nodeSetOf(part, one.node_set), nodeSetOf(part, other.node_set));
      if (common.count > 0)
        faults += (faults.empty() ? "" : "\n") + config.deck_path + ": " + all[j].block + " and " +
                  all[i].block + ": found different motions of " + components +
                  " of nodes in both node set \"" + one.node_set + "\" and \"" + other.node_set +
                  "\", " + std::to_string(common.count) + " of them, the first " +
                  EntityNames(comm, part).node(common.lowest) +
                  "; expected one motion of each component";
    }
  if (!faults.empty())
    throw InputError(faults);
}

} // namespace brickwall::miniapp
