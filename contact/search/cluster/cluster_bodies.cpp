#include "contact/search/cluster/cluster_bodies.hpp"

namespace brickwall::contact {
namespace {

KOKKOS_FORCEINLINE_FUNCTION void joinBody(global_id body, global_id& of_all, bool& is_first) {
  of_all = is_first || of_all == body ? body : many_bodies;
  is_first = false;
}

} // namespace

void nameBodies(const exec_space& space, const SweptBoxes& surface, ClusterOrder& order) {
  const int num_faces = surface.num_faces, num_nodes = surface.num_nodes;
  const std::int64_t num_blocks = dividedUp<std::int64_t>(num_faces, block_size);
  order.cluster_body =
      allocate<View<global_id*>>(space, "contact::ClusterOrder::cluster_body", order.num_clusters);
  order.block_body =
      allocate<View<global_id*>>(space, "contact::ClusterOrder::block_body", num_blocks);
  const auto cluster_body = order.cluster_body, block_body = order.block_body;
  const auto node_order = order.node_order, face_order = order.face_order;
  const auto node_body = surface.node_body, face_body = surface.face_body;
  const auto face_to_nodes = surface.face_to_nodes;
  Kokkos::parallel_for(
      "contact::nameBodies::clusters", rangePolicy(space, order.num_clusters),
      KOKKOS_LAMBDA(const std::int64_t cluster) {
        global_id body = many_bodies;
        bool is_first = true;
        const std::int64_t begin = cluster * cluster_size;
        for (std::int64_t i = begin; i < minOf<std::int64_t>(begin + cluster_size, num_nodes); ++i)
          joinBody(node_body(node_order(i)), body, is_first);
        cluster_body(cluster) = body;
      });
  Kokkos::parallel_for(
      "contact::nameBodies::blocks", rangePolicy(space, num_blocks),
      KOKKOS_LAMBDA(const std::int64_t block) {
        global_id body = many_bodies;
        bool is_first = true;
        const std::int64_t begin = block * block_size;
        for (std::int64_t i = begin; i < minOf<std::int64_t>(begin + block_size, num_faces); ++i) {
          const int face = face_order(i);
          joinBody(bodyOfSide(face_body(face)), body, is_first);
          for (int k = 0; k < 4; ++k)
            joinBody(node_body(face_to_nodes(face, k)), body, is_first);
        }
        block_body(block) = body;
      });
  space.fence();
}

} // namespace brickwall::contact
