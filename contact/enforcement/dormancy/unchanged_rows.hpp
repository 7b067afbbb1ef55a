// The rows of candidates that are the same as in the last step.
#pragma once

#include "contact/surface/surface.hpp"

namespace brickwall::contact {

// For kernels.
struct UnchangedRows {
  bool are_all = false, may_be_any = false;
  View<const unsigned char*> changed; // [block], see CandidatePairs; read if may_be_any only

  KOKKOS_FORCEINLINE_FUNCTION bool hasBlock(std::int64_t block) const {
    return are_all || (may_be_any && changed(block) == 0);
  }
  KOKKOS_FORCEINLINE_FUNCTION bool has(std::int64_t row) const {
    return hasBlock(row / CandidatePairs::rows_per_block);
  }
};

class RowChanges {
public:
  // `pairs` are those of this step; those of the last call are of the last step.
  UnchangedRows update(const CandidatePairs& pairs) {
    const bool is_known = pairs.version > 0 && pairs.changed.data() == _changed;
    UnchangedRows rows;
    rows.are_all = is_known && pairs.version == _version;
    rows.may_be_any = is_known && pairs.version == _version + 1;
    rows.changed = pairs.changed;
    _version = pairs.version;
    _changed = pairs.changed.data();
    return rows;
  }
  void forget() { _changed = nullptr; }

private:
  std::int64_t _version = 0;
  const unsigned char* _changed = nullptr;
};

} // namespace brickwall::contact
