#include "contact/search/exchange/ghost_corner_values.hpp"

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
      "contact::packCorners", rangePolicy(space, faces_sent.size()),
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
      "contact::unpackCorners", rangePolicy(space, num_ghosts),
      KOKKOS_LAMBDA(const std::int64_t ghost) {
        for (int i = 0; i < words_per_face; ++i)
          fromWord(words(ghost * width + first + i), ghost_values(ghost, i));
      });
}

} // namespace

void forwardCornerValues(const exec_space& space, MPI_Comm comm, const PartnerLists& faces_sent,
                         const View<const int* [4]>& face_to_nodes,
                         const View<const double* [3]>& node_values, FaceMigration& migration,
                         const View<double* [12]>& ghost_values) {
  const Region region("forwardCornerValues");
  auto& messages = migration.messages;
  constexpr int width = words_per_face;
  growTo(space, messages.buffers.send, faces_sent.size() * width);
  packCorners(space, faces_sent, face_to_nodes, node_values, 0, width, messages.buffers.send);
  messages.exchange(space, comm, tags::corner_values, width);
  unpackCorners(space, messages.buffers.receive, 0, width, migration.ghosts.count, ghost_values);
}

void sendCoordinates(const exec_space& space, MPI_Comm comm, const PartnerLists& faces_sent,
                     const Surface& surface, FaceMigration& migration) {
  const Region region("sendCoordinates");
  auto& messages = migration.messages;
  const GhostFaces& ghosts = migration.ghosts;
  constexpr int second = words_per_face, width = 2 * words_per_face;
  growTo(space, messages.buffers.send, faces_sent.size() * width);
  const auto to_send = messages.buffers.send;
  packCorners(space, faces_sent, surface.face_to_nodes, surface.coordinates_old, 0, width, to_send);
  packCorners(space, faces_sent, surface.face_to_nodes, surface.coordinates_new, second, width,
              to_send);
  messages.exchange(space, comm, tags::ghost_coordinates, width);
  const auto received = messages.buffers.receive;
  unpackCorners(space, received, 0, width, ghosts.count, ghosts.coordinates_old);
  unpackCorners(space, received, second, width, ghosts.count, ghosts.coordinates_new);
}

} // namespace brickwall::contact
