// The interface between the peer benchmark and a search library: pairs of overlapping node and face
// boxes. Each library has a file of its own, built if its CMake option is on, and registers itself
// in the list of peers.
#pragma once

#include "contact/base/box.hpp"

#include <mpi.h>

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace brickwall::peers {

// The boxes of this rank's owned nodes and of its faces over the step, in double, tolerances
// included.
struct SearchBoxes {
  std::vector<Box> node_boxes, face_boxes;
  std::vector<global_id> node_ids, face_ids;
};

using IdPair = std::pair<global_id, global_id>; // node, face

class Peer {
public:
  virtual ~Peer() = default;
  // Copies the boxes into the library's own types. Not timed. All calls of one object have the same
  // numbers of boxes.
  virtual void prepare(const exec_space& space, MPI_Comm comm, const SearchBoxes& boxes) = 0;
  // Collective, timed. One search from boxes to the complete list of pairs; fences.
  virtual void search(const exec_space& space, MPI_Comm comm) = 0;
  // The pairs of the last search whose node this rank owns, in any order. Not timed.
  virtual std::vector<IdPair> pairs() const = 0;
  // Whether the search is in double. A search in float may list extra pairs, whose boxes touch in
  // float only, but misses none.
  virtual bool isExact() const { return true; }
};

// A library in one configuration.
struct PeerKind {
  std::string name;
  bool on_several_ranks = false;
  std::function<std::unique_ptr<Peer>()> make;
};

// All peers of this build. Each kind registers itself before main by a `const PeerEntry` of
// namespace scope.
inline std::vector<PeerKind>& peerKinds() {
  static std::vector<PeerKind> kinds;
  return kinds;
}
struct PeerEntry {
  explicit PeerEntry(PeerKind kind) { peerKinds().push_back(std::move(kind)); }
};

} // namespace brickwall::peers
