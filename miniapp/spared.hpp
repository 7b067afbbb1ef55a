// What a scene did not need and was therefore left out: the list that `brickwall check` and the report show; `key` is the deck key that puts it back, for measurements (./run.sh --study savings).
#pragma once

#include "miniapp/config.hpp"
#include "miniapp/simulation.hpp"

#include <string>
#include <vector>

namespace brickwall::miniapp {

struct Spared {
  std::string what; // e.g. "elements at rest"
  double share = 0; // of what it is a part of, 0 to 1
  std::string of; // in words: of what, and what that saves
  std::string key; // of the deck; empty: there is no way to have it
};

// Collective. Before the first step what is known of the scene, later what the steps so far have spared.
std::vector<Spared> sparedParts(const Config& config, const Simulation& simulation,
                                std::int64_t num_elems);

} // namespace brickwall::miniapp
