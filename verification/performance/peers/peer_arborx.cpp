// ArborX 2 builds its bounding volume hierarchy over the face boxes and lists the faces of every
// node box as offsets and indices. Without a result buffer that takes two traversals: one counts,
// one writes. With a buffer of `buffer_size` results a node, one traversal does unless a node has
// more. It runs in float, its faster type, and in double, with queries in Morton order or in the
// order given.
#include "contact/base/to_device.hpp"
#include "verification/performance/peers/peers.hpp"

#include <ArborX.hpp>

namespace brickwall::peers {
namespace {

// Lists indices only, half the bytes of ArborX' own callback, which lists boxes too.
struct KeepIndex {
  template <class Query, class Value, class Insert>
  KOKKOS_FUNCTION void operator()(const Query&, const Value& value, const Insert& insert) const {
    insert(static_cast<int>(value.index));
  }
};

// Rounding to nearest is monotone, so boxes that overlap in double also overlap in float. The
// converse does not hold.
template <class Real>
class ArborXSearch : public Peer {
public:
  ArborXSearch(bool sorts_queries, int buffer_size)
      : _sorts_queries(sorts_queries), _buffer_size(buffer_size) {}

  void prepare(const exec_space& space, MPI_Comm, const SearchBoxes& boxes) override {
    take(space, boxes.node_boxes, _node_boxes);
    take(space, boxes.face_boxes, _face_boxes);
    _node_ids = boxes.node_ids;
    _face_ids = boxes.face_ids;
    _faces = View<int*>("peers::arborx::faces", 0);
    _offsets = View<int*>("peers::arborx::offsets", 0);
  }

  void search(const exec_space& space, MPI_Comm) override {
    const ArborX::BoundingVolumeHierarchy tree(space,
                                               ArborX::Experimental::attach_indices(_face_boxes));
    tree.query(space, ArborX::Experimental::make_intersects(_node_boxes), KeepIndex(), _faces,
               _offsets,
               ArborX::Experimental::TraversalPolicy()
                   .setPredicateSorting(_sorts_queries)
                   .setBufferSize(_buffer_size));
    space.fence();
  }

  std::vector<IdPair> pairs() const override {
    const auto faces = toHost(_faces);
    const auto offsets = toHost(_offsets);
    std::vector<IdPair> ids;
    ids.reserve(faces.size());
    for (std::size_t node = 0; node < _node_ids.size(); ++node)
      for (int i = offsets(node); i < offsets(node + 1); ++i)
        ids.emplace_back(_node_ids[node], _face_ids[faces(i)]);
    return ids;
  }

  bool isExact() const override { return std::is_same_v<Real, double>; }

private:
  using RealBox = ArborX::Box<3, Real>;
  using Boxes = View<RealBox*>;

  static void take(const exec_space& space, const std::vector<Box>& boxes, Boxes& to) {
    to = allocate<Boxes>(space, "peers::arborx::boxes", boxes.size());
    const auto host = Kokkos::create_mirror_view(to);
    for (std::size_t i = 0; i < boxes.size(); ++i)
      for (int d = 0; d < 3; ++d) {
        host(i).minCorner()[d] = static_cast<Real>(boxes[i].lower[d]);
        host(i).maxCorner()[d] = static_cast<Real>(boxes[i].upper[d]);
      }
    Kokkos::deep_copy(space, to, host);
    space.fence();
  }

  bool _sorts_queries;
  int _buffer_size; // 0: none
  Boxes _node_boxes, _face_boxes;
  std::vector<global_id> _node_ids, _face_ids;
  View<int*> _faces, _offsets; // results
};

template <class Real>
PeerKind kind(const std::string& name, bool sorts_queries, int buffer_size = 0) {
  return {name, false, [sorts_queries, buffer_size] {
            return std::make_unique<ArborXSearch<Real>>(sorts_queries, buffer_size);
          }};
}

const PeerEntry entries[] = {
    PeerEntry(kind<float>("ArborX float, queries sorted, buffer", true, 16)),
    PeerEntry(kind<float>("ArborX float, buffer", false, 16)),
    PeerEntry(kind<float>("ArborX float, queries sorted", true)),
    PeerEntry(kind<float>("ArborX float", false)),
    PeerEntry(kind<double>("ArborX double, queries sorted", true)),
    PeerEntry(kind<double>("ArborX double", false)),
};

} // namespace
} // namespace brickwall::peers
