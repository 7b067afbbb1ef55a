#include "contact/search/exchange/ghost_exchange.hpp"

#include "contact/base/region.hpp"
#include "contact/base/scan.hpp"
#include "contact/base/tags.hpp"

namespace brickwall::contact {
namespace {

constexpr int words_per_face = 12;

// Ghosts in the order of their messages: all, or those of a list.
struct GhostRows {
  std::int64_t count;
  View<const int*> ghosts; // [place]; null: ghosts 0 .. count - 1

  KOKKOS_INLINE_FUNCTION std::int64_t operator()(std::int64_t place) const {
    return ghosts.data() == nullptr ? place : ghosts(place);
  }
};

// Values of corners, field after field of a face.
template <int num_fields>
void packCorners(const exec_space& space, const View<const int*>& faces, std::int64_t num_faces,
                 const View<const int* [4]>& face_to_nodes,
                 const Kokkos::Array<View<const double* [3]>, num_fields>& fields,
                 const View<std::int64_t*>& words) {
  Kokkos::parallel_for(
      "contact::forward::pack", rangePolicy(space, num_faces), KOKKOS_LAMBDA(const std::int64_t i) {
        std::int64_t to = i * num_fields * words_per_face;
        for (int field = 0; field < num_fields; ++field)
          for (int corner = 0; corner < 4; ++corner)
            for (int d = 0; d < 3; ++d)
              words(to++) = toWord(fields[field](face_to_nodes(faces(i), corner), d));
      });
}

template <int num_fields>
void unpackCorners(const exec_space& space, const View<const std::int64_t*>& words,
                   const GhostRows& rows,
                   const Kokkos::Array<View<double* [12]>, num_fields>& ghost_fields) {
  Kokkos::parallel_for(
      "contact::forward::unpack", rangePolicy(space, rows.count),
      KOKKOS_LAMBDA(const std::int64_t i) {
        std::int64_t from = i * num_fields * words_per_face;
        for (int field = 0; field < num_fields; ++field)
          for (int w = 0; w < words_per_face; ++w)
            fromWord(words(from++), ghost_fields[field](rows(i), w));
      });
}

void packGhosts(const exec_space& space, const GhostRows& rows,
                const View<const std::int64_t* [12]>& ghost_values,
                const View<std::int64_t*>& words) {
  Kokkos::parallel_for(
      "contact::reverseSum::pack", rangePolicy(space, rows.count),
      KOKKOS_LAMBDA(const std::int64_t i) {
        for (int w = 0; w < words_per_face; ++w)
          words(i * words_per_face + w) = ghost_values(rows(i), w);
      });
}

void addToNodes(const exec_space& space, const View<const std::int64_t*>& words,
                const View<const int*>& faces, std::int64_t num_faces,
                const View<const int* [4]>& face_to_nodes,
                const View<std::int64_t* [3]>& node_values) {
  Kokkos::parallel_for(
      "contact::reverseSum::add", rangePolicy(space, num_faces),
      KOKKOS_LAMBDA(const std::int64_t n) {
        const int face = faces(n);
        for (int j = 0; j < 4; ++j)
          for (int d = 0; d < 3; ++d) // most are 0
            if (const std::int64_t value = words(words_per_face * n + 3 * j + d); value != 0)
              Kokkos::atomic_add(&node_values(face_to_nodes(face, j), d), value);
      });
}

// words(i) = rows(i) - first for i in [begin, end).
void shiftRows(const exec_space& space, const View<const int*>& rows, std::int64_t begin,
               std::int64_t end, std::int64_t first, const View<std::int64_t*>& words) {
  Kokkos::parallel_for(
      "contact::GhostSelection::shiftRows", range_policy(space, begin, end),
      KOKKOS_LAMBDA(const std::int64_t i) { words(i) = rows(i) - first; });
}
// faces(i) = sent(first + words(i)) for i in [begin, end).
void takeFaces(const exec_space& space, const View<const std::int64_t*>& words, std::int64_t begin,
               std::int64_t end, const View<const int*>& sent, std::int64_t first,
               const View<int*>& faces) {
  Kokkos::parallel_for(
      "contact::GhostSelection::takeFaces", range_policy(space, begin, end),
      KOKKOS_LAMBDA(const std::int64_t i) { faces(i) = sent(first + words(i)); });
}

} // namespace

void forward(const exec_space& space, MPI_Comm comm, const PartnerLists& faces_sent,
             const View<const int* [4]>& face_to_nodes, const View<const double* [3]>& node_values,
             FaceMigration& migration, const View<double* [12]>& ghost_values) {
  const Region region("contact::forward");
  auto& messages = migration.messages;
  growTo(space, messages.buffers.send, faces_sent.size() * words_per_face);
  packCorners<1>(space, faces_sent.rows, faces_sent.size(), face_to_nodes, {node_values},
                 messages.buffers.send);
  messages.forward(space, comm, tags::corner_values, words_per_face);
  unpackCorners<1>(space, messages.buffers.receive, {migration.ghosts.count, {}}, {ghost_values});
}

void forwardCoordinates(const exec_space& space, MPI_Comm comm, const PartnerLists& faces_sent,
                        const SweptBoxes& surface, FaceMigration& migration) {
  const Region region("contact::forwardCoordinates");
  auto& messages = migration.messages;
  const GhostFaces& ghosts = migration.ghosts;
  constexpr int width = 2 * words_per_face;
  growTo(space, messages.buffers.send, faces_sent.size() * width);
  packCorners<2>(space, faces_sent.rows, faces_sent.size(), surface.face_to_nodes,
                 {surface.coordinates_old, surface.coordinates_new}, messages.buffers.send);
  messages.forward(space, comm, tags::ghost_coordinates, width);
  unpackCorners<2>(space, messages.buffers.receive, {ghosts.count, {}},
                   {ghosts.coordinates_old, ghosts.coordinates_new});
}

void reverseSum(const exec_space& space, MPI_Comm comm, const PartnerLists& faces_sent,
                const View<const int* [4]>& face_to_nodes,
                const View<const std::int64_t* [12]>& ghost_values, FaceMigration& migration,
                const View<std::int64_t* [3]>& node_values) {
  const Region region("contact::reverseSum");
  auto& messages = migration.messages;
  const GhostRows all{migration.ghosts.count, {}};
  growTo(space, messages.buffers.send, all.count * words_per_face);
  packGhosts(space, all, ghost_values, messages.buffers.send);
  messages.reverse(space, comm, tags::ghost_reactions, words_per_face);
  addToNodes(space, messages.buffers.receive, faces_sent.rows, faces_sent.size(), face_to_nodes,
             node_values);
}

void GhostSelection::select(const exec_space& space, MPI_Comm comm, const PartnerLists& faces_sent,
                            const FaceMigration& migration,
                            const View<const unsigned char*>& flags) {
  const Region region("contact::selectGhosts");
  const std::vector<std::int64_t>& begins = migration.messages.receiveOffsets();
  _ghosts.ranks = migration.messages.senders();
  _ghosts.offsets.assign(1, 0);
  if (!_ghosts.ranks.empty()) {
    const std::int64_t num_ghosts = migration.ghosts.count;
    growTo(space, _ghosts.rows, num_ghosts);
    growTo(space, _before, num_ghosts + 1);
    listFlagged(space, "contact::GhostSelection::list", flags, GhostRows{num_ghosts, {}},
                num_ghosts, _ghosts.rows, _before);
    copyToDevice(space, begins, _starts);
    offsetsOfKept(space, _before, _starts, _ghosts);
  }

  // Ghosts are named by their places among those of the owner.
  growTo(space, _messages.buffers.send, _ghosts.size());
  for (std::size_t p = 0; p < _ghosts.ranks.size(); ++p)
    shiftRows(space, _ghosts.rows, _ghosts.offsets[p], _ghosts.offsets[p + 1], begins[p],
              _messages.buffers.send);
  const std::vector<std::int64_t>& ends = _messages.forwardOfAnySize(
      space, comm, tags::ghost_selection, 1, _ghosts.ranks, _ghosts.offsets, faces_sent.ranks);
  _num_faces = ends.back();
  growTo(space, _faces, _num_faces);
  for (std::size_t p = 0; p < faces_sent.ranks.size(); ++p)
    takeFaces(space, _messages.buffers.receive, ends[p], ends[p + 1], faces_sent.rows,
              faces_sent.offsets[p], _faces);
}

// The roles of sender and receiver are those of select(), which sends to the owners.
void GhostSelection::forward(const exec_space& space, MPI_Comm comm,
                             const View<const int* [4]>& face_to_nodes,
                             const View<const double* [3]>& node_values,
                             const View<double* [12]>& ghost_values) {
  const Region region("contact::forward");
  growTo(space, _messages.buffers.send, _num_faces * words_per_face);
  packCorners<1>(space, _faces, _num_faces, face_to_nodes, {node_values}, _messages.buffers.send);
  _messages.reverse(space, comm, tags::corner_values, words_per_face);
  unpackCorners<1>(space, _messages.buffers.receive, {_ghosts.size(), _ghosts.rows},
                   {ghost_values});
}

void GhostSelection::reverseSum(const exec_space& space, MPI_Comm comm,
                                const View<const int* [4]>& face_to_nodes,
                                const View<const std::int64_t* [12]>& ghost_values,
                                const View<std::int64_t* [3]>& node_values) {
  const Region region("contact::reverseSum");
  growTo(space, _messages.buffers.send, _ghosts.size() * words_per_face);
  packGhosts(space, {_ghosts.size(), _ghosts.rows}, ghost_values, _messages.buffers.send);
  _messages.forward(space, comm, tags::ghost_reactions, words_per_face);
  addToNodes(space, _messages.buffers.receive, _faces, _num_faces, face_to_nodes, node_values);
}

} // namespace brickwall::contact
