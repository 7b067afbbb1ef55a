#include "contact/search/exchange/ghost_exchange.hpp"

#include "contact/base/region.hpp"
#include "contact/base/tags.hpp"

namespace brickwall::contact {
namespace {

constexpr int words_per_face = 12;

// One field of a message of `width` words a face, from word `first` on.
void packCorners(const exec_space& space, const PartnerLists& faces_sent,
                 const View<const int* [4]>& face_to_nodes,
                 const View<const double* [3]>& node_values, int first, int width,
                 const View<std::int64_t*>& words) {
  const View<const int*> faces = faces_sent.rows;
  Kokkos::parallel_for(
      "contact::forward::pack", rangePolicy(space, faces_sent.size()),
      KOKKOS_LAMBDA(const std::int64_t i) {
        for (int corner = 0; corner < 4; ++corner)
          for (int d = 0; d < 3; ++d)
            words(i * width + first + 3 * corner + d) =
                toWord(node_values(face_to_nodes(faces(i), corner), d));
      });
}

void unpackCorners(const exec_space& space, const View<const std::int64_t*>& words, int first,
                   int width, int num_ghosts, const View<double* [12]>& ghost_values) {
  Kokkos::parallel_for(
      "contact::forward::unpack", rangePolicy(space, num_ghosts),
      KOKKOS_LAMBDA(const std::int64_t ghost) {
        for (int i = 0; i < words_per_face; ++i)
          fromWord(words(ghost * width + first + i), ghost_values(ghost, i));
      });
}

} // namespace

void forward(const exec_space& space, MPI_Comm comm, const PartnerLists& faces_sent,
             const View<const int* [4]>& face_to_nodes, const View<const double* [3]>& node_values,
             FaceMigration& migration, const View<double* [12]>& ghost_values) {
  const Region region("contact::forward");
  auto& messages = migration.messages;
  constexpr int width = words_per_face;
  growTo(space, messages.buffers.send, faces_sent.size() * width);
  packCorners(space, faces_sent, face_to_nodes, node_values, 0, width, messages.buffers.send);
  messages.forward(space, comm, tags::corner_values, width);
  unpackCorners(space, messages.buffers.receive, 0, width, migration.ghosts.count, ghost_values);
}

void forwardCoordinates(const exec_space& space, MPI_Comm comm, const PartnerLists& faces_sent,
                        const SweptBoxes& surface, FaceMigration& migration) {
  const Region region("contact::forwardCoordinates");
  auto& messages = migration.messages;
  const GhostFaces& ghosts = migration.ghosts;
  constexpr int second = words_per_face, width = 2 * words_per_face;
  growTo(space, messages.buffers.send, faces_sent.size() * width);
  const auto to_send = messages.buffers.send;
  packCorners(space, faces_sent, surface.face_to_nodes, surface.coordinates_old, 0, width, to_send);
  packCorners(space, faces_sent, surface.face_to_nodes, surface.coordinates_new, second, width,
              to_send);
  messages.forward(space, comm, tags::ghost_coordinates, width);
  const auto received = messages.buffers.receive;
  unpackCorners(space, received, 0, width, ghosts.count, ghosts.coordinates_old);
  unpackCorners(space, received, second, width, ghosts.count, ghosts.coordinates_new);
}

void reverseSum(const exec_space& space, MPI_Comm comm, const PartnerLists& faces_sent,
                const View<const int* [4]>& face_to_nodes,
                const View<const std::int64_t* [12]>& ghost_values, FaceMigration& migration,
                const View<std::int64_t* [3]>& node_values) {
  const Region region("contact::reverseSum");
  auto& buffers = migration.messages.buffers;
  const std::int64_t num_ghosts = migration.ghosts.count, num_sent = faces_sent.size();
  growTo(space, buffers.send, num_ghosts * words_per_face);
  const auto to_owner = buffers.send;
  Kokkos::parallel_for(
      "contact::reverseSum::pack", rangePolicy(space, num_ghosts),
      KOKKOS_LAMBDA(const std::int64_t ghost) {
        for (int i = 0; i < 12; ++i)
          to_owner(ghost * 12 + i) = ghost_values(ghost, i);
      });
  migration.messages.reverse(space, comm, tags::ghost_reactions, words_per_face);
  const auto returned = buffers.receive;
  const View<const int*> faces = faces_sent.rows;
  Kokkos::parallel_for(
      "contact::reverseSum::add", rangePolicy(space, num_sent),
      KOKKOS_LAMBDA(const std::int64_t n) {
        const int face = faces(n);
        for (int j = 0; j < 4; ++j)
          for (int d = 0; d < 3; ++d) // most are 0
            if (const std::int64_t value = returned(12 * n + 3 * j + d); value != 0)
              Kokkos::atomic_add(&node_values(face_to_nodes(face, j), d), value);
      });
}

} // namespace brickwall::contact
