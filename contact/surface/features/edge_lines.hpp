// Lines of convex edges: edges that continue each other in nearly the same direction. An edge has
// at most one contact with each line of another body, and slides along it from edge to edge.
#pragma once

#include "contact/surface/features/feature_edges.hpp"
#include "contact/surface/surface.hpp"

#include <mpi.h>

#include <vector>

namespace brickwall::contact {

// Collective; for set-up. Sets FeatureEdge::goes_on and FeatureEdge::line of this rank's edges.
void findLines(MPI_Comm comm, const Surface& surface, std::vector<FeatureEdge>& edges);

} // namespace brickwall::contact
