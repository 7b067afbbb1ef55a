#include "contact/search/local_search.hpp"

#include "contact/base/region.hpp"

namespace brickwall::contact {

const CandidatePairs& LocalSearch::findCandidatePairs(const exec_space& space,
                                                      const SweptBoxes& surface) {
  const Region region("contact::findCandidatePairs");
  const Region timer("contact::search::local_search");
  _global._phases->findPairs(space, surface, _global.ghosts(), _global.config());
  return pairs();
}

} // namespace brickwall::contact
