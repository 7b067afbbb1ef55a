// The nodes that the interactions of a step act on. In most steps they are few, and the kernels
// that correct and sum forces and pass them to the mesh visit only these.
#pragma once

#include "contact/enforcement/law/contact_history.hpp"
#include "contact/surface/face_access.hpp"

#include <string>

namespace brickwall::contact {

// The surface nodes that a kernel visits: all of them, or those of a list.
struct NodeList {
  std::int64_t count = 0;
  View<const int*> nodes; // [place], each node once, in any order; null: nodes 0 .. count - 1

  static NodeList allOf(std::int64_t num_nodes) { return {num_nodes, {}}; }
  bool isAll() const { return nodes.data() == nullptr; }
  KOKKOS_INLINE_FUNCTION int operator()(std::int64_t place) const {
    return nodes.data() == nullptr ? static_cast<int>(place) : nodes(place);
  }
};

// values = 0 at the listed nodes.
void zeroListed(const exec_space& space, const std::string& label, const NodeList& list,
                const View<std::int64_t* [3]>& values);

// flags [node] = 1 at the listed nodes, 0 at others.
void flagListed(const exec_space& space, const NodeList& list, const View<unsigned char*>& flags);

// flags [ghost] = 1 at the ghosts of interactions, 0 at others.
void flagGhostsInUse(const exec_space& space, const FaceAccess& faces, const ContactHistory& pairs,
                     const View<unsigned char*>& flags);

class TouchedNodes {
public:
  TouchedNodes() = default;
  TouchedNodes(const std::string& label, int num_nodes);

  // Empties the list.
  void clear(const exec_space& space);
  // Lists all nodes.
  void listAll(const exec_space& space);
  // Adds the nodes of the `pairs.count` first interactions of `pairs`: pushing points and all
  // corners of own faces of `surface`, each mapped by `to_node` if that is given. If they may be
  // many, all nodes are listed.
  void add(const exec_space& space, const SweptBoxes& surface, const ContactHistory& pairs,
           const View<const int*>& to_node = {});
  // Adds `nodes`, and the corners of the `count` first of `faces`; likewise.
  void addNodes(const exec_space& space, const View<const int*>& nodes);
  void addCorners(const exec_space& space, const View<const int*>& faces, std::int64_t count,
                  const View<const int* [4]>& face_to_nodes);

  const NodeList& list() const { return _list; }

private:
  void finishInsertion(const exec_space& space);

  int _num_nodes = 0;
  View<int*> _nodes; // [place]
  View<int*> _is_listed; // [node] 1: it is in _nodes
  View<int> _count;
  int _num_listed = 0; // in _nodes
  NodeList _list;
};

} // namespace brickwall::contact
