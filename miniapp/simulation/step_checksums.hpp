// Checksums of what each part of a step leaves behind, to find the first part in which two runs of
// one deck differ (`brickwall run --checksums`). Sums modulo 2^64 of hashes of all bits, with
// global ids: the same on any number of ranks and threads, and on a GPU. Without free bricks
// (skip.free_bricks), whose positions and forces are not those of the parts.
#pragma once

#include <cstdint>
#include <functional>

namespace brickwall::miniapp {

class Simulation;

// The parts of a step (Simulation::runStages), named for what they leave.
enum class StepPart {
  displacement, // u^{n+1} of all nodes
  pairs, // candidate pairs of nodes and faces
  forces, // of elements and loads, at all nodes
  contacts, // contact history and contact forces
  velocity, // v^{n+1/2} of all nodes
  energies, // of the ledger
};
const char* nameOf(StepPart part);

using StepObserver = std::function<void(StepPart)>;

// Collective.
std::uint64_t checksumOf(const Simulation& simulation, StepPart part);

} // namespace brickwall::miniapp
