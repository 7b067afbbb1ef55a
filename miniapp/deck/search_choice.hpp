// What the deck says about the search, as the contact library takes it and as reports name it.
#pragma once

#include "contact/surface/search_config.hpp"
#include "miniapp/deck/config.hpp"

namespace brickwall::miniapp {

// By how much boxes of nodes and faces are inflated, length: contact.tolerance of the shortest edge, or more on long faces, so
// that the two together reach half as far again as a node may stand beyond the edge of a face and still touch it.
inline double boxTolerance(const ContactConfig& contact, double shortest_edge,
                           double longest_edge) {
  const double beyond = 0.5 * maxOf(contact.lateral_tolerance, contact.edge_tolerance);
  return maxOf(contact.tolerance * shortest_edge, 0.5 * 1.5 * beyond * longest_edge);
}

// How deep a node may be found in a body that it was not in before: what tolerances of the shortest edge reach.
inline double deepestBirth(const ContactConfig& contact, double shortest_edge) {
  return 2 * contact.tolerance * shortest_edge;
}

// Whether pairs within one body are left out of the search.
inline bool dropsSameBody(const Config& config) {
  const SelfContact self = config.contact.self;
  return !config.contact.enabled || self == SelfContact::never ||
         (self == SelfContact::automatic && config.wall.has_value());
}

inline contact::SearchConfig searchConfig(const Config& config, double tolerance,
                                          bool drop_same_body) {
  contact::SearchConfig search;
  search.method = config.search.method;
  search.node_tolerance = search.face_tolerance = tolerance;
  search.drop_same_body = drop_same_body;
  return search;
}

inline const char* nameOf(SearchMethod method) {
  switch (method) {
  case SearchMethod::cluster:
    return "cluster";
  case SearchMethod::paper:
    return "paper";
  case SearchMethod::reference:
    return "reference";
  }
  return "";
}

} // namespace brickwall::miniapp
