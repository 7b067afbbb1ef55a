// A copy of a surface in another decomposition: faces, and the nodes at their corners, are on ranks
// that balance search and enforcement, whichever ranks hold the elements (K. Brown, S. Attaway, S.
// Plimpton, B. Hendrickson, Parallel strategies for crash and impact simulations, Computer Methods
// in Applied Mechanics and Engineering 184, 2000).
#pragma once

#include "contact/surface/id_holders.hpp"
#include "contact/surface/surface.hpp"
#include "contact/surface/surface_transfer.hpp"

#include <mpi.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

namespace brickwall::contact {

class SecondarySurface {
public:
  // Collective; `comm` is copied. Face f of `primary` goes to rank_of_face[f], with its attributes;
  // its nodes go along, and one of the ranks that then share a node owns it. Coordinates are not
  // copied. Nodes are in the order of their ids, faces in that of candidates. `is_shared` [primary
  // node]: other ranks may have the node in `primary`; empty: all may, which takes longer.
  SecondarySurface(const exec_space& space, MPI_Comm comm, const SweptBoxes& primary,
                   const std::vector<int>& rank_of_face, const std::vector<char>& is_shared = {});

  // This rank's part, without coordinates.
  const Surface& surface() const { return _surface; }

  // Records of primary faces at the ranks that have the faces: `face` of each changes from the
  // primary to the local number. Collective.
  template <class Record>
  std::vector<Record> forwardRecords(const Communicator& comm,
                                     const std::vector<Record>& of_primary) const {
    // [primary face] its rank, and its place among those sent
    std::vector<std::pair<int, int>> place;
    for (std::size_t q = 0; q < _sent_faces.size(); ++q)
      for (std::size_t i = 0; i < _sent_faces[q].size(); ++i) {
        const auto face = static_cast<std::size_t>(_sent_faces[q][i]);
        place.resize(std::max(place.size(), face + 1));
        place[face] = {static_cast<int>(q), static_cast<int>(i)};
      }
    std::vector<std::vector<Record>> sent(_sent_faces.size());
    for (Record record : of_primary) {
      const auto [rank, index] = place[record.face];
      record.face = index;
      sent[rank].push_back(record);
    }
    std::vector<Record> all;
    const auto received = exchangeByRank(comm, std::move(sent));
    for (std::size_t q = 0; q < received.size(); ++q)
      for (Record record : received[q]) {
        record.face = _face_of[q][record.face];
        all.push_back(record);
      }
    return all;
  }

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
  // Between the copies of the nodes that several ranks have.
  SurfaceTransfer& shared() { return _shared; }
  // Values [node][W], equal on all copies of a node, to all primary copies of it. Collective.
  template <class SourceView, class TargetView>
  void giveBack(const exec_space& space, const SourceView& values, const TargetView& of_primary) {
    _to_primary.forward(space, values, of_primary);
  }

  // Selects nodes by flags [node] that are equal on all copies of a node, and sets the flags of
  // primary nodes. forwardSelected() and giveBackSelected() do the same as forward() and giveBack()
  // for these nodes only, until the next selection. Collective.
  void selectNodes(const exec_space& space, const SurfaceTransfer::Flags& flags,
                   const SurfaceTransfer::Flags& of_primary) {
    Kokkos::deep_copy(space, of_primary, static_cast<unsigned char>(0));
    _to_primary.forwardFlags(space, flags, of_primary);
    _to_primary.select(space, flags, of_primary);
    _to_secondary.select(space, of_primary, flags);
  }
  template <class SourceView, class TargetView>
  void forwardSelected(const exec_space& space, const SourceView& of_primary,
                       const TargetView& values) {
    _to_secondary.forwardSelected(space, of_primary, values);
  }
  template <class SourceView, class TargetView>
  void giveBackSelected(const exec_space& space, const SourceView& values,
                        const TargetView& of_primary) {
    _to_primary.forwardSelected(space, values, of_primary);
  }

private:
  Surface _surface;
  SurfaceTransfer _to_secondary; // to each copy of a node from one primary copy
  SurfaceTransfer _to_primary; // to each primary copy of a node from one copy
  SurfaceTransfer _shared; // between the copies of nodes that several ranks have
  std::vector<std::vector<int>> _sent_faces; // [rank] primary faces
  std::vector<std::vector<int>> _face_of; // [rank] local numbers of the faces that it has sent
};

// For each record the rank that lists its id in `held`, which one rank at most does, gets it.
// Records whose id nobody lists are dropped. `idOf` gives the id of a record. Collective; for
// set-up.
template <class Record, class IdOf>
std::vector<Record> sendToHolders(const Communicator& comm, const std::vector<Record>& records,
                                  const std::vector<global_id>& held, const IdOf& idOf) {
  const auto num_here = static_cast<std::int64_t>(records.size());
  if (allReduce(comm, num_here, MPI_SUM) == 0)
    return {};
  const int num_ranks = sizeOf(comm);
  const IdHolders holder_of(comm, held);
  std::vector<std::vector<Record>> asked(num_ranks), forwarded(num_ranks);
  for (const Record& record : records)
    asked[idOf(record) % num_ranks].push_back(record);
  for (const auto& some : exchangeByRank(comm, std::move(asked)))
    for (const Record& record : some)
      if (const int holder = holder_of(idOf(record)); holder != IdHolders::none)
        forwarded[holder].push_back(record);
  return joined(exchangeByRank(comm, std::move(forwarded)));
}

} // namespace brickwall::contact
