// All message tags, so that no two patterns in flight share one.
#pragma once

namespace brickwall::tags {

constexpr int shared_nodes = 11; // mechanics: sums at nodes that several ranks share
constexpr int node_faces = 12; // contact: area vectors of the faces around a node
constexpr int rank_boxes = 20; // contact: phase 2
constexpr int node_boxes = 21; // contact: phase 4
constexpr int face_migration = 22; // contact: phase 6
constexpr int ghost_reactions = 23; // contact: reverseSum of forces on ghost faces
constexpr int node_box_counts = 24; // contact: sizes of phase 4's messages
constexpr int face_counts = 25; // contact: sizes of phase 6's messages
constexpr int corner_values = 26; // contact: forward of nodal values to the corners of ghost faces
constexpr int ghost_coordinates = 27; // contact: forward of x^n and x^{n+1} to ghosts that are kept
constexpr int secondary_surface = 28; // contact: nodal values to and from a SecondarySurface
constexpr int ghost_selection = 29; // contact: which ghosts are in use
constexpr int by_rank = 71; // base: exchangeByRank

} // namespace brickwall::tags
