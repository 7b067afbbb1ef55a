// All public headers of brickwall::contact.
#pragma once

#include "contact/enforcement/enforcement.hpp"
#include "contact/search/audit/read_back.hpp"
#include "contact/search/candidate_search.hpp"
#include "contact/search/global_search.hpp"
#include "contact/search/local_search.hpp"
#include "contact/surface/feature_edges.hpp"
#include "contact/surface/search_config.hpp"
#include "contact/surface/surface.hpp"
