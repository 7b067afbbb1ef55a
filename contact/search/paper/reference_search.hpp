// The reference of every search: plain serial loops over all pairs on the host, per sender. It is
// the oracle of the tests and the baseline of the measurements; results and their order are those
// of the tree searches.
#pragma once

#include "contact/search/paper/paper_search.hpp"

namespace brickwall::contact {

class ReferenceSearch final : public PaperSearch {
protected:
  void findCandidates(const exec_space& space, const View<const Box*>& boxes, int num_rows,
                      const std::vector<Box>& rank_boxes, RankBoxSearch& search,
                      PartnerLists& lists) override;
  // Counts a face once for each partner: the loop stops at the first overlap.
  std::int64_t findFaces(const exec_space& space) override;
  void findRows(const exec_space& space, const SweptBoxes& surface, const GhostFaces& ghosts,
                const View<const Box*>& face_boxes, const Box& all, bool drop_same_body) override;
};

} // namespace brickwall::contact
