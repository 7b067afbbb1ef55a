// STKSearch of Trilinos: coarse_search with its k-d tree on boxes of doubles. Its OpenMP loops run
// on OMP_NUM_THREADS threads, as those of Brickwall. By default it sends a pair to the face's rank
// too and sorts the list; asked for pairs on the node's rank only, as Brickwall's search returns
// them, it does neither.
#include "contact/base/mpi.hpp"
#include "verification/performance/peers/peers.hpp"

#include <stk_search/CoarseSearch.hpp>

namespace brickwall::peers {
namespace {

class StkSearch : public Peer {
public:
  explicit StkSearch(bool on_both_ranks) : _on_both_ranks(on_both_ranks) {}

  void prepare(const exec_space&, MPI_Comm comm, const SearchBoxes& boxes) override {
    _rank = rankOf(comm);
    take(boxes.node_boxes, boxes.node_ids, _nodes);
    take(boxes.face_boxes, boxes.face_ids, _faces);
  }

  void search(const exec_space&, MPI_Comm comm) override {
    _results.clear();
    stk::search::coarse_search(_nodes, _faces, stk::search::KDTREE, comm, _results, _on_both_ranks);
  }

  std::vector<IdPair> pairs() const override {
    std::vector<IdPair> ids;
    ids.reserve(_results.size());
    for (const auto& [node, face] : _results)
      if (node.proc() == _rank)
        ids.emplace_back(node.id(), face.id());
    return ids;
  }

private:
  using StkBox = stk::search::Box<double>;
  using Ident = stk::search::IdentProc<global_id, int>;
  using Boxes = std::vector<std::pair<StkBox, Ident>>;

  void take(const std::vector<Box>& boxes, const std::vector<global_id>& ids, Boxes& to) const {
    to.clear();
    to.reserve(boxes.size());
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      const auto &low = boxes[i].lower, &up = boxes[i].upper;
      to.emplace_back(StkBox(low[0], low[1], low[2], up[0], up[1], up[2]), Ident(ids[i], _rank));
    }
  }

  bool _on_both_ranks;
  int _rank = 0;
  Boxes _nodes, _faces;
  std::vector<std::pair<Ident, Ident>> _results;
};

PeerKind kind(const std::string& name, bool on_both_ranks) {
  return {name, true, [=] { return std::make_unique<StkSearch>(on_both_ranks); }};
}

const PeerEntry entries[] = {
    PeerEntry(kind("STK k-d tree", false)),
    PeerEntry(kind("STK k-d tree, its default", true)),
};

} // namespace
} // namespace brickwall::peers
