// The public headers of the search and of node-to-face enforcement. Edge-to-edge contact, overlaps
// and audits have headers of their own (contact/README.md).
#pragma once

#include "contact/enforcement/enforcement.hpp"
#include "contact/search/audit/read_back.hpp"
#include "contact/search/candidate_search.hpp"
#include "contact/search/global_search.hpp"
#include "contact/search/local_search.hpp"
#include "contact/surface/features/feature_edges.hpp"
#include "contact/surface/search_config.hpp"
#include "contact/surface/surface.hpp"
