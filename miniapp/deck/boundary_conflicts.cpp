#include "miniapp/deck/boundary_conflicts.hpp"

#include "contact/base/mpi.hpp"
#include "miniapp/scene/face_name.hpp"
#include "miniapp/scene/scene.hpp"

#include <algorithm>
#include <iterator>
#include <tuple>

namespace brickwall::miniapp {

namespace {

struct Boundary {
  std::string block; // of the deck
  PrescribedVelocityConfig motion;
};

// What is fixed has velocity 0.
std::vector<Boundary> boundariesOf(const Config& config) {
  std::vector<Boundary> all;
  for (const FixedConfig& fixed : config.fixed)
    all.push_back({"boundary.fixed[" + std::to_string(all.size()) + "]",
                   {fixed.node_set, {0, 0, 0}, fixed.components, {}}});
  for (std::size_t i = 0; i < config.prescribed.size(); ++i)
    all.push_back({"boundary.velocity[" + std::to_string(i) + "]", config.prescribed[i]});
  return all;
}

bool isSameCourse(const PulseConfig& a, const PulseConfig& b) {
  return std::tie(a.shape, a.start, a.duration, a.decay) ==
         std::tie(b.shape, b.start, b.duration, b.decay);
}

bool differ(const PrescribedVelocityConfig& a, const PrescribedVelocityConfig& b,
            std::size_t component) {
  if (!a.components[component] || !b.components[component])
    return false;
  if (a.velocity[component] != b.velocity[component])
    return true;
  return a.velocity[component] != 0 && !isSameCourse(a.pulse, b.pulse);
}

std::string differingComponents(const PrescribedVelocityConfig& a,
                                const PrescribedVelocityConfig& b) {
  std::string components;
  for (std::size_t d = 0; d < 3; ++d)
    if (differ(a, b, d))
      components += (components.empty() ? "" : ", ") + std::string(1, "xyz"[d]);
  return components;
}

struct CommonNodes {
  std::int64_t count = 0; // of all ranks
  global_id lowest = -1;
};
CommonNodes commonNodes(MPI_Comm comm, const io::MeshPart& part, const io::NodeSet& a,
                        const io::NodeSet& b) {
  std::vector<int> common; // local nodes ascend as their ids do
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

void complainOfConflicts(const Config& config, io::Deck& deck) {
  const std::vector<Boundary> all = boundariesOf(config);
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const auto &one = all[j].motion, &other = all[i].motion;
      if (one.node_set != other.node_set || one.node_set.empty()) // told already
        continue;
      const std::string components = differingComponents(one, other);
      if (!components.empty())
        deck.complain(all[i].block, "",
                      "another motion of " + components + " of node set \"" + other.node_set +
                          "\" than in " + deck.placeOf(all[j].block),
                      "one motion of each component");
    }
}

void refuseConflictsOfSets(MPI_Comm comm, const Config& config, const io::MeshPart& part) {
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
                  nodeName(common.lowest) + "; expected one motion of each component";
    }
  if (!faults.empty())
    throw InputError(faults);
}

} // namespace brickwall::miniapp
