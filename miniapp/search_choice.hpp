// What the deck says about the search, as the contact library takes it and as reports name it.
#pragma once

#include "contact/search_config.hpp"
#include "miniapp/config.hpp"

namespace brickwall::miniapp {

// Boxes of nodes and faces are inflated by contact.tolerance of `edge`, length.
inline contact::SearchConfig searchConfig(const Config& config, double edge, bool drop_same_body) {
  contact::SearchConfig search;
  search.method = config.search.method;
  search.node_tolerance = search.face_tolerance = config.contact.tolerance * edge;
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
