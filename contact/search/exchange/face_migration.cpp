#include "contact/search/exchange/face_migration.hpp"

#include "contact/base/mpi.hpp"
#include "contact/base/region.hpp"
#include "contact/base/tags.hpp"

#include <cstring>

namespace brickwall::contact {
namespace {

// A face as message words; its attributes follow.
enum Word : int { face_id, body, corner_ids, x_old = 6, x_new = 18, attributes = 30 };

void packFaces(const exec_space& space, const SweptBoxes& surface, const PartnerLists& lists,
               int num_attributes, MessageBuffers& buffers) {
  const int width = attributes + num_attributes;
  growTo(space, buffers.send, lists.size() * width);
  const auto words = buffers.send;
  const View<const int*> faces = lists.rows;
  const auto face_to_nodes = surface.face_to_nodes;
  const auto ids = surface.face_ids, bodies = surface.face_body, node_ids = surface.node_ids;
  const auto old_coordinates = surface.coordinates_old, new_coordinates = surface.coordinates_new;
  const auto values = surface.face_attributes;
  Kokkos::parallel_for(
      "contact::migrateFaces::pack", rangePolicy(space, lists.size()),
      KOKKOS_LAMBDA(const std::int64_t i) {
        const int face = faces(i);
        std::int64_t* const to = &words(i * width);
        to[face_id] = ids(face);
        to[body] = bodies(face);
        for (int corner = 0; corner < 4; ++corner) {
          const int node = face_to_nodes(face, corner);
          to[corner_ids + corner] = node_ids(node);
          for (int d = 0; d < 3; ++d) {
            to[x_old + 3 * corner + d] = toWord(old_coordinates(node, d));
            to[x_new + 3 * corner + d] = toWord(new_coordinates(node, d));
          }
        }
        for (int a = 0; a < num_attributes; ++a)
          memcpy(&to[attributes + a], &values(face, a), sizeof(AttributeWord));
      });
}

void growGhosts(const exec_space& space, std::int64_t n, int num_attributes, GhostFaces& ghosts) {
  const Region timer("contact::search::allocation");
  ghosts.count = checkedInt(n, "ghost faces");
  growTo(space, ghosts.face_ids, n);
  growTo(space, ghosts.bodies, n);
  growTo(space, ghosts.corner_ids, n);
  growTo(space, ghosts.coordinates_old, n);
  growTo(space, ghosts.coordinates_new, n);
  if (static_cast<int>(ghosts.attributes.extent(1)) != num_attributes)
    ghosts.attributes =
        allocate<AttributeWords>(space, "contact::GhostFaces::attributes", n, num_attributes);
  growTo(space, ghosts.attributes, n);
}

void unpackFaces(const exec_space& space, int num_attributes, const MessageBuffers& buffers,
                 const GhostFaces& ghosts) {
  const int width = attributes + num_attributes;
  const auto words = buffers.receive;
  const auto ids = ghosts.face_ids, bodies = ghosts.bodies;
  const auto corners = ghosts.corner_ids;
  const auto old_coordinates = ghosts.coordinates_old, new_coordinates = ghosts.coordinates_new;
  const auto values = ghosts.attributes;
  Kokkos::parallel_for(
      "contact::migrateFaces::unpack", rangePolicy(space, ghosts.count),
      KOKKOS_LAMBDA(const std::int64_t ghost) {
        const std::int64_t* const from = &words(ghost * width);
        ids(ghost) = from[face_id];
        bodies(ghost) = from[body];
        for (int corner = 0; corner < 4; ++corner)
          corners(ghost, corner) = from[corner_ids + corner];
        for (int i = 0; i < 12; ++i) {
          fromWord(from[x_old + i], old_coordinates(ghost, i));
          fromWord(from[x_new + i], new_coordinates(ghost, i));
        }
        for (int a = 0; a < num_attributes; ++a)
          memcpy(&values(ghost, a), &from[attributes + a], sizeof(AttributeWord));
      });
}

} // namespace

void migrateFaces(const exec_space& space, MPI_Comm comm, const SweptBoxes& surface,
                  const PartnerLists& faces_to_send, const std::vector<int>& senders,
                  int num_attributes, bool announces_sizes, FaceMigration& migration) {
  const Region region("contact::migrateFaces");
  const Region timer("contact::search::migration");
  auto& messages = migration.messages;
  const int width = attributes + num_attributes;
  packFaces(space, surface, faces_to_send, num_attributes, messages.buffers);
  if (announces_sizes) {
    messages.announceSizes(comm, tags::face_counts, faces_to_send.ranks, faces_to_send.offsets,
                           senders);
    messages.forward(space, comm, tags::face_migration, width);
  } else {
    messages.forwardOfAnySize(space, comm, tags::face_migration, width, faces_to_send.ranks,
                              faces_to_send.offsets, senders);
  }
  growGhosts(space, messages.receiveOffsets().back(), num_attributes, migration.ghosts);
  unpackFaces(space, num_attributes, messages.buffers, migration.ghosts);
}

} // namespace brickwall::contact
