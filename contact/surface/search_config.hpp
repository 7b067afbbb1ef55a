// Configuration and statistics of the global and the local search.
#pragma once

#include <cstdint>

namespace brickwall::contact {

// `cluster`: the surface is kept in order, boxes in blocks of eight, one tree per sender; a face
// ends at its first hit.
// `paper`: Morton codes, radix sort, Karras tree, one merged tree over all senders (paper, sections
// 4 and 5).
// `reference`: plain serial loops over all pairs, per sender; oracle and baseline. All methods find
// the same ghosts and pairs; `cluster` lists the ghosts of one owner in an order of its own.
enum class SearchMethod { cluster, paper, reference };

struct SearchConfig {
  SearchMethod method = SearchMethod::cluster;
  double node_tolerance = 0; // inflation of node boxes, length, >= 0
  double face_tolerance = 0; // inflation of face boxes, length, >= 0
  bool drop_same_body = false; // candidate pairs of a node and a face of one body are not listed
};

// Counts of the last call on this rank.
struct SearchStatistics {
  int num_partners = 0; // ranks that node boxes are sent to or received from
  std::int64_t node_boxes_sent = 0; // sum over q of |L_gns^q|
  // sum over q of |L_gfs^q|; cluster: eight for each block tested for q
  std::int64_t candidate_faces = 0;
  // Pairs that search 2 finds. paper: before its filter; reference and cluster: first hits, one for
  // each face sent.
  std::int64_t overlapping_pairs = 0;
  std::int64_t faces_sent = 0; // sum over q of |L_ges^q|
  std::int64_t num_ghosts = 0; // faces received
};

} // namespace brickwall::contact
