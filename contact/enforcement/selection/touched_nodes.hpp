// The nodes that the interactions of a step act on. In most steps they are few, and what corrects forces, sums them and takes them
// to the mesh visits these alone.
#pragma once

#include "contact/enforcement/law/contact_history.hpp"
#include "contact/enforcement/selection/node_list.hpp"
#include "contact/surface/surface.hpp"

namespace brickwall::contact {

class TouchedNodes {
public:
  TouchedNodes() = default;
  TouchedNodes(const std::string& label, int num_nodes);

  // Lists none.
  void clear(const exec_space& space);
  // Lists all.
  void listAll(const exec_space& space);
  // Adds the nodes of the interactions of `pairs` (its history's `count` first ones): pushing points and all corners of own faces of
  // `surface`, each as to_node(it) if there is such a list, else as it is. Where they may be many, all are listed.
  void add(const exec_space& space, const SweptBoxes& surface, const ContactHistory& pairs,
           const View<const int*>& to_node = {});

  const NodeList& list() const { return _list; }

private:
  int _num_nodes = 0;
  View<int*> _nodes; // [place]
  View<int*> _is_listed; // [node], of those in _nodes
  View<int> _count;
  int _num_listed = 0; // in _nodes
  NodeList _list;
};

} // namespace brickwall::contact
