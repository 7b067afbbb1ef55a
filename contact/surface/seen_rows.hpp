// What the user of candidate pairs knows of their rows from one step to the next.
#pragma once

#include "contact/surface/surface.hpp"

#include <cstdint>

namespace brickwall::contact {

class SeenRows {
public:
  // Rows compared with those of the last call.
  struct Comparison {
    // They are the same but for the blocks that CandidatePairs::changed flags.
    bool are_known = false;
    bool are_same = false; // they are known, and no block has changed
  };

  // To be called once a step.
  Comparison see(const CandidatePairs& pairs) {
    Comparison rows;
    const bool have_versions =
        _version > 0 && pairs.version > 0 && pairs.changed.data() == _changed;
    rows.are_same = have_versions && pairs.version == _version;
    rows.are_known = rows.are_same || (have_versions && pairs.version == _version + 1);
    _version = pairs.version;
    _changed = pairs.changed.data();
    return rows;
  }

private:
  std::int64_t _version = 0; // of the pairs seen last
  const unsigned char* _changed = nullptr; // likewise
};

} // namespace brickwall::contact
