// How messages name a face of the skin.
#pragma once

#include "contact/base/backend.hpp"

#include <string>

namespace brickwall::miniapp {

// Faces of the skin are numbered 6 * element + side (mechanics/mesh/skin.hpp).
inline std::string faceName(global_id face) {
  return "face " + std::to_string(face) + " (side " + std::to_string(face % 6 + 1) +
         " of the element with 1-based id " + std::to_string(face / 6 + 1) + ")";
}
inline std::string nodeName(global_id node) {
  return "node " + std::to_string(node) + " (1-based id " + std::to_string(node + 1) + ")";
}

} // namespace brickwall::miniapp
