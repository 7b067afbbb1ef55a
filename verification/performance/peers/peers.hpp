// What the peer benchmark asks of a search library: pairs of overlapping node and face boxes. Each library stands in a
// file of its own, built where its CMake option is on, and enters itself into the list of peers.
#pragma once

#include "contact/base/box.hpp"

#include <mpi.h>

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace brickwall::peers {

// This rank's boxes over the step: of its owned nodes, and of its faces. Doubles, tolerances included.
struct SearchBoxes {
  std::vector<Box> node_boxes, face_boxes;
  std::vector<global_id> node_ids, face_ids;
};

using IdPair = std::pair<global_id, global_id>; // node, face

class Peer {
public:
  virtual ~Peer() = default;
  // Takes the boxes over in the library's own types. Not timed. Calls of one object get equal numbers of boxes.
  virtual void prepare(const exec_space& space, MPI_Comm comm, const SearchBoxes& boxes) = 0;
  // Collective. One search, from boxes to the complete list of pairs; timed, fences.
  virtual void search(const exec_space& space, MPI_Comm comm) = 0;
  // Pairs of the last search whose node is this rank's, in any order. Not timed.
  virtual std::vector<IdPair> pairs() const = 0;
  // Whether the search is in double: else it may list pairs that only touch in float, but must miss none.
  virtual bool isExact() const { return true; }
};

// A library in one configuration.
struct PeerKind {
  std::string name;
  bool on_several_ranks = false;
  std::function<std::unique_ptr<Peer>()> make;
};

// All that were built in. Filled before main, by one `const PeerEntry` of namespace scope for each kind.
inline std::vector<PeerKind>& peerKinds() {
  static std::vector<PeerKind> kinds;
  return kinds;
}
struct PeerEntry {
  explicit PeerEntry(PeerKind kind) { peerKinds().push_back(std::move(kind)); }
};

} // namespace brickwall::peers
