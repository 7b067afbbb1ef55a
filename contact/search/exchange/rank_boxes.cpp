#include "contact/search/exchange/rank_boxes.hpp"

#include "contact/base/messages/message_buffers.hpp"
#include "contact/base/mpi.hpp"
#include "contact/base/region.hpp"
#include "contact/base/tags.hpp"
#include "contact/search/exchange/rank_tree.hpp"

namespace brickwall::contact {
namespace {

constexpr std::int64_t no_faces = RankGroup::none;

std::int64_t attributesOf(const SweptBoxes& surface) {
  return surface.num_faces > 0 ? static_cast<std::int64_t>(surface.face_attributes.extent(1))
                               : no_faces;
}

RankGroup groupOf(int rank, const Box& node_box, const Box& face_box, const OwnRankBoxes& own,
                  std::int64_t attributes) {
  RankGroup group;
  group.node_box = node_box;
  group.face_box = face_box;
  group.num_invalid = own.num_invalid;
  group.first_invalid = own.first_invalid;
  group.invalid_rank = rank;
  if (attributes != no_faces) {
    group.rank_with_faces = rank;
    group.attributes = attributes;
  }
  return group;
}

// All ranks have the same group of all: all of them throw, or none does.
void throwIfFaulty(const RankGroup& all) {
  if (all.num_invalid > 0)
    throw PhysicsError("contact search: node " + std::to_string(all.first_invalid) + " on rank " +
                       std::to_string(all.invalid_rank) +
                       " has a coordinate that is not finite; expected finite ones. "
                       "Such nodes, summed over ranks: " +
                       std::to_string(all.num_invalid));
  if (all.other_rank != RankGroup::none)
    throw InputError("contact search: rank " + std::to_string(all.other_rank) + " has " +
                     std::to_string(all.other_attributes) + " attributes per face; expected " +
                     std::to_string(all.attributes) + ", as on lower ranks");
}

// In the first 600 steps of the default wall on 4 ranks, a surface leaves a box with this margin
// four times.
constexpr double margin_share = 0.01;

Box withMargin(Box box) {
  double longest = 0;
  for (int d = 0; d < 3; ++d)
    longest = maxOf(longest, box.upper[d] - box.lower[d]); // negative if empty
  box.inflate(margin_share * longest);
  return box;
}

// The records of the partners, through the tree.
std::vector<RankRecord> exchangeAlongTree(MPI_Comm comm, const RankRecord& own,
                                          const RankGroup& group, RankGroup& all) {
  RankTree tree(own.rank, sizeOf(comm));
  tree.begin(own, group);
  std::vector<std::int64_t> sent, received;
  WordMessages messages;
  for (int i = 0; i < tree.numRounds(); ++i) {
    const RankTree::Round round = tree.round(i);
    if (round.sends) {
      tree.pack(i, sent);
      messages.send(sent.data(), std::int64_t(sent.size()), round.peer, tags::rank_boxes, comm);
    }
    if (round.receives) {
      ProbedMessage message(round.peer, tags::rank_boxes, comm);
      received.resize(static_cast<std::size_t>(message.words));
      messages.receive(received.data(), message);
    }
    messages.wait();
    if (round.receives)
      tree.unpack(i, received.data(), received.size());
  }
  all = tree.all();
  return tree.partners();
}

// The paper's phase 2: the records of all ranks.
std::vector<RankRecord> gatherAll(MPI_Comm comm, const RankRecord& own, const RankGroup& group,
                                  RankGroup& all) {
  static_assert(std::is_trivially_copyable_v<RankGroup>);
  std::vector<RankGroup> groups(static_cast<std::size_t>(sizeOf(comm)));
  constexpr int bytes = sizeof(RankGroup);
  checkMpi(MPI_Allgather(&group, bytes, MPI_BYTE, groups.data(), bytes, MPI_BYTE, comm),
           "MPI_Allgather");
  all = groups[0];
  std::vector<RankRecord> records;
  for (int q = 0; q < static_cast<int>(groups.size()); ++q) {
    if (q > 0)
      all.include(groups[std::size_t(q)]);
    if (q != own.rank)
      records.push_back({q, groups[std::size_t(q)].node_box, groups[std::size_t(q)].face_box});
  }
  return records;
}

} // namespace

bool RankBoxes::hold(const SweptBoxes& surface, const OwnRankBoxes& own) const {
  return _are_known && own.num_invalid == 0 && node_box.contains(own.node_box) &&
         face_box.contains(own.face_box) && _sent_attributes == attributesOf(surface);
}

void exchangeRankBoxes(MPI_Comm comm, const SweptBoxes& surface, const OwnRankBoxes& own,
                       bool keeps, RankBoxes& all) {
  const Region region("contact::exchangeRankBoxes");
  std::vector<RankRecord> records;
  {
    const Region timer("contact::search::rank_box_exchange");
    all._are_known = false; // nothing holds after a throw
    all._sent_attributes = attributesOf(surface);
    all.node_box = keeps ? withMargin(own.node_box) : own.node_box;
    all.face_box = keeps ? withMargin(own.face_box) : own.face_box;
    const int rank = rankOf(comm);
    const RankRecord record{rank, all.node_box, all.face_box};
    const RankGroup group = groupOf(rank, all.node_box, all.face_box, own, all._sent_attributes);
    RankGroup of_all;
    records = keeps ? exchangeAlongTree(comm, record, group, of_all)
                    : gatherAll(comm, record, group, of_all);
    throwIfFaulty(of_all);
    all.num_attributes = static_cast<int>(of_all.attributes);
    all._are_known = true;
  }
  const Region timer("contact::search::partners");
  all.near_nodes.clear();
  all.near_faces.clear();
  for (const RankRecord& other : records) {
    if (all.node_box.overlaps(other.face_box))
      all.near_nodes.add(other.rank, other.face_box);
    if (all.face_box.overlaps(other.node_box))
      all.near_faces.add(other.rank, other.node_box);
  }
}

} // namespace brickwall::contact
