#include "contact/search/exchange/rank_boxes.hpp"

#include "contact/base/region.hpp"
#include "contact/search/exchange/node_box_exchange.hpp"

namespace brickwall::contact {
namespace {

// The data of one rank as message words.
enum Word : int { node_box, face_box = 6, num_invalid = 12, first_invalid, attributes, num_words };
constexpr std::int64_t no_faces = -1;

std::int64_t attributesOf(const SweptBoxes& surface) {
  return surface.num_faces > 0 ? static_cast<std::int64_t>(surface.face_attributes.extent(1))
                               : no_faces;
}

// All ranks read the same words: all of them throw, or none does.
void throwIfNotFinite(const std::vector<std::int64_t>& words, int size) {
  std::int64_t total = 0, node = INT64_MAX;
  int rank = 0;
  for (int q = 0; q < size; ++q) {
    const std::int64_t* of_rank = &words[static_cast<std::size_t>(q) * num_words];
    total += of_rank[num_invalid];
    if (of_rank[num_invalid] > 0 && of_rank[first_invalid] < node) {
      node = of_rank[first_invalid];
      rank = q;
    }
  }
  if (total > 0)
    throw PhysicsError("contact search: node " + std::to_string(node) + " on rank " +
                       std::to_string(rank) + " has a coordinate that is not finite (" +
                       std::to_string(total) + " such node(s), summed over ranks)");
}

int agreedAttributes(const std::vector<std::int64_t>& words, int size) {
  std::int64_t agreed = no_faces;
  for (int q = 0; q < size; ++q) {
    const std::int64_t found = words[static_cast<std::size_t>(q) * num_words + attributes];
    if (found == no_faces)
      continue;
    if (agreed != no_faces && found != agreed)
      throw InputError("contact search: rank " + std::to_string(q) + " has " +
                       std::to_string(found) + " attributes per face, lower ranks have " +
                       std::to_string(agreed));
    agreed = found;
  }
  return agreed == no_faces ? 0 : static_cast<int>(agreed);
}

// In the first 600 steps of the default wall on 4 ranks, a surface leaves a box with this margin four
// times.
constexpr double margin_share = 0.01;

Box withMargin(Box box) {
  double longest = 0;
  for (int d = 0; d < 3; ++d)
    longest = maxOf(longest, box.upper[d] - box.lower[d]); // negative if empty
  box.inflate(margin_share * longest);
  return box;
}

// The other ranks whose box, in `boxes` [rank], overlaps `own`.
void findPartners(const Box& own, const std::vector<Box>& boxes, int this_rank,
                  std::vector<int>& ranks) {
  ranks.clear();
  for (int q = 0; q < static_cast<int>(boxes.size()); ++q)
    if (q != this_rank && own.overlaps(boxes[q]))
      ranks.push_back(q);
}

} // namespace

bool RankBoxes::hold(const SweptBoxes& surface, const OwnRankBoxes& own) const {
  return !node_boxes.empty() && own.num_invalid == 0 && node_boxes[rank].contains(own.node_box) &&
         face_boxes[rank].contains(own.face_box) &&
         _words[static_cast<std::size_t>(rank) * num_words + attributes] == attributesOf(surface);
}

void RankBoxes::gather(MPI_Comm comm, const SweptBoxes& surface, const OwnRankBoxes& own,
                       bool with_margin) {
  const Region timer("contact::search::rank_box_exchange");
  node_boxes.clear(); // nothing holds after a throw
  rank = rankOf(comm);
  size = sizeOf(comm);
  std::int64_t sent[num_words];
  packBox(with_margin ? withMargin(own.node_box) : own.node_box, sent + node_box);
  packBox(with_margin ? withMargin(own.face_box) : own.face_box, sent + face_box);
  sent[num_invalid] = own.num_invalid;
  sent[first_invalid] = own.first_invalid;
  sent[attributes] = attributesOf(surface);
  _words.resize(static_cast<std::size_t>(size) * num_words);
  checkMpi(MPI_Allgather(sent, num_words, MPI_INT64_T, _words.data(), num_words, MPI_INT64_T, comm),
           "MPI_Allgather");
  throwIfNotFinite(_words, size);
  num_attributes = agreedAttributes(_words, size);
  node_boxes.resize(static_cast<std::size_t>(size));
  face_boxes.resize(static_cast<std::size_t>(size));
  for (int q = 0; q < size; ++q) {
    const std::int64_t* of_rank = &_words[static_cast<std::size_t>(q) * num_words];
    node_boxes[q] = unpackBox(of_rank + node_box);
    face_boxes[q] = unpackBox(of_rank + face_box);
  }
}

void exchangeRankBoxes(MPI_Comm comm, const SweptBoxes& surface, const OwnRankBoxes& own,
                       bool with_margin, RankBoxes& all) {
  const Region region("contact::exchangeRankBoxes");
  all.gather(comm, surface, own, with_margin);
  const Region timer("contact::search::partners");
  findPartners(all.node_boxes[all.rank], all.face_boxes, all.rank, all.near_nodes);
  findPartners(all.face_boxes[all.rank], all.node_boxes, all.rank, all.near_faces);
}

} // namespace brickwall::contact
