// A copy of a surface in another decomposition: faces, and the nodes at their corners, are on ranks
// that balance search and enforcement, whichever ranks hold the elements (K. Brown, S. Attaway, S.
// Plimpton, B. Hendrickson, Parallel strategies for crash and impact simulations, Computer Methods
// in Applied Mechanics and Engineering 184, 2000).
#pragma once

#include "contact/base/messages/exchange_plan.hpp"
#include "contact/surface/surface.hpp"

#include <mpi.h>

#include <vector>

namespace brickwall::contact {

class SecondarySurface {
public:
  // Collective; `comm` is copied. Face f of `primary` goes to rank_of_face[f], with its attributes;
  // its nodes go along, and one of the ranks that then share a node owns it. Coordinates are not
  // copied.
  SecondarySurface(const exec_space& space, MPI_Comm comm, const SweptBoxes& primary,
                   const std::vector<int>& rank_of_face);

  // This rank's part. Its coordinates are empty; attributes may be changed.
  const Surface& surface() const { return _surface; }
  const AttributeWords& attributes() const { return _attributes; }

  // Values of primary nodes at all copies of the nodes: values [primary node][W] to [node][W].
  // Ranks that share a primary node must hold equal values. Collective.
  template <class SourceView, class TargetView>
  void forward(const exec_space& space, const SourceView& of_primary, const TargetView& values) {
    _to_secondary.forward(space, of_primary, values);
  }
  // Adds up the values of all copies of a node, int64 [node][W], on each of them. Collective.
  template <class ViewType>
  void sumShared(const exec_space& space, const ViewType& values) {
    _shared.sumShared(space, values);
  }
  // Values [node][W], equal on all copies of a node, to all primary copies of it. Collective.
  template <class SourceView, class TargetView>
  void giveBack(const exec_space& space, const SourceView& values, const TargetView& of_primary) {
    _to_primary.forward(space, values, of_primary);
  }

private:
  Surface _surface;
  AttributeWords _attributes;
  ExchangePlan _to_secondary; // to each copy of a node from one primary copy
  ExchangePlan _to_primary; // to each primary copy of a node from one copy
  ExchangePlan _shared; // between the copies of nodes that several ranks have
};

// For each record the rank that lists its id in `held`, which one rank at most does, gets it.
// Records whose id nobody lists are dropped. `idOf` gives the id of a record. Collective; for
// set-up.
template <class Record, class IdOf>
std::vector<Record> sendToHolders(MPI_Comm comm, const std::vector<Record>& records,
                                  const std::vector<global_id>& held, const IdOf& idOf) {
  const int num_ranks = sizeOf(comm);
  // The rank chosen by an id knows its holder.
  std::vector<std::vector<global_id>> listed(num_ranks);
  for (const global_id id : held)
    listed[id % num_ranks].push_back(id);
  std::vector<std::pair<global_id, int>> holders;
  const auto lists = exchangeByRank(comm, listed);
  for (int q = 0; q < num_ranks; ++q)
    for (const global_id id : lists[q])
      holders.emplace_back(id, q);
  std::sort(holders.begin(), holders.end());
  std::vector<std::vector<Record>> asked(num_ranks), forwarded(num_ranks);
  for (const Record& record : records)
    asked[idOf(record) % num_ranks].push_back(record);
  for (const auto& some : exchangeByRank(comm, asked))
    for (const Record& record : some) {
      const global_id id = idOf(record);
      const auto holder = std::lower_bound(holders.begin(), holders.end(), std::make_pair(id, 0));
      if (holder != holders.end() && holder->first == id)
        forwarded[holder->second].push_back(record);
    }
  std::vector<Record> received;
  for (const auto& some : exchangeByRank(comm, forwarded))
    received.insert(received.end(), some.begin(), some.end());
  return received;
}

} // namespace brickwall::contact
