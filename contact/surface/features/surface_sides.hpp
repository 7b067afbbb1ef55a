// The sides of the surface of a concave body. A node has at most one contact with each, so that
// both flanks of a re-entrant corner can hold it. Theory: theory.md, section 6.2.
#pragma once

#include "contact/surface/surface.hpp"

#include <mpi.h>

#include <vector>

namespace brickwall::contact {

// Collective; for set-up. [own face] its side. Patches between feature edges and concave edges get
// different sides where they meet at a concave edge or are connected by concave edges of one node,
// and otherwise the lowest that is free, in the order of their lowest face ids; so the sides do not
// depend on the partition.
// `concave_edges` [own face] bit j: the body is concave at edge j. `face_edges`: those of
// FeatureEdges; concave edges between different sides become feature edges.
std::vector<int> findSides(MPI_Comm comm, const Surface& surface,
                           const std::vector<unsigned char>& concave_edges,
                           std::vector<unsigned char>& face_edges);

} // namespace brickwall::contact
