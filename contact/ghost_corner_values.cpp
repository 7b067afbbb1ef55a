#include "contact/ghost_corner_values.hpp"

#include "contact/base/region.hpp"
#include "contact/base/tags.hpp"

namespace brickwall::contact {

void sendCornerValues(const exec_space& space, MPI_Comm comm, const PartnerLists& faces_sent,
                      const View<const int* [4]>& face_to_nodes,
                      const View<const double* [3]>& node_values, FaceMigration& migration,
                      const View<double* [12]>& ghost_values) {
  const Region region("sendCornerValues");
  auto& buffers = migration.messages.buffers;
  growTo(space, buffers.send, faces_sent.size() * 12);
  const auto to_ghosts = buffers.send;
  const View<const int*> faces = faces_sent.rows;
  Kokkos::parallel_for(
      "contact::sendCornerValues::pack", over(space, faces_sent.size()),
      KOKKOS_LAMBDA(const std::int64_t i) {
        for (int corner = 0; corner < 4; ++corner)
          for (int d = 0; d < 3; ++d)
            to_ghosts(i * 12 + 3 * corner + d) =
                toWord(node_values(face_to_nodes(faces(i), corner), d));
      });
  migration.messages.exchange(space, comm, tags::corner_values, 12);
  const auto received = buffers.receive;
  Kokkos::parallel_for(
      "contact::sendCornerValues::unpack", over(space, migration.ghosts.count),
      KOKKOS_LAMBDA(const std::int64_t ghost) {
        for (int i = 0; i < 12; ++i)
          fromWord(received(ghost * 12 + i), ghost_values(ghost, i));
      });
}

} // namespace brickwall::contact
