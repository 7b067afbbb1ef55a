// Candidate rows from plain offsets by node: the form in which the methods that keep the host's node order find them.
#pragma once

#include "contact/surface/surface.hpp"

namespace brickwall::contact {

// Makes row i that of node i, with its faces at pairs.faces [offsets(i), offsets(i + 1)); offsets [num_nodes + 1]. All of
// `pairs` but `faces` is set.
void layOutRowsByNode(const exec_space& space, int num_nodes,
                      const View<const std::int64_t*>& offsets, CandidatePairs& pairs);

} // namespace brickwall::contact
