#include "contact/search/audit/pair_audit.hpp"

#include "contact/base/mpi.hpp"
#include "contact/base/region.hpp"
#include "contact/surface/face_access.hpp"

namespace brickwall::contact {
namespace {

// The faces of one rank, as sent to all ranks.
struct AuditedFaces {
  View<Box*> boxes;
  View<global_id* [6]> ids; // face, body, four corners
};

AuditedFaces describeOwnFaces(const exec_space& space, const SweptBoxes& surface,
                              double tolerance) {
  AuditedFaces own{
      allocate<View<Box*>>(space, "contact::countMissedPairs::boxes", surface.num_faces),
      allocate<View<global_id* [6]>>(space, "contact::countMissedPairs::ids", surface.num_faces)};
  Kokkos::parallel_for(
      "contact::countMissedPairs::describe", rangePolicy(space, surface.num_faces),
      KOKKOS_LAMBDA(const std::int64_t face) {
        own.boxes(face) = faceBox(surface.coordinates_old, surface.coordinates_new,
                                  surface.face_to_nodes, face, tolerance);
        own.ids(face, 0) = surface.face_ids(face);
        own.ids(face, 1) = surface.face_body(face);
        for (int corner = 0; corner < 4; ++corner)
          own.ids(face, 2 + corner) = surface.node_ids(surface.face_to_nodes(face, corner));
      });
  return own;
}

template <class ViewType>
void broadcastRows(const exec_space& space, MPI_Comm comm, int root, ViewType& view, int rows) {
  if (rankOf(comm) != root)
    view = allocate<ViewType>(space, "contact::countMissedPairs::received", rows);
  const auto host = Kokkos::create_mirror_view(Kokkos::HostSpace(), view);
  if (rankOf(comm) == root)
    Kokkos::deep_copy(space, host, view);
  space.fence();
  broadcast(comm, host.data(), static_cast<std::int64_t>(host.size()), root);
  Kokkos::deep_copy(space, view, host);
}

struct CountMissed {
  FaceAccess faces;
  CandidatePairs pairs;
  AuditedFaces all;
  int num_all;
  SearchConfig config;

  KOKKOS_INLINE_FUNCTION void operator()(const std::int64_t row, std::int64_t& missed) const {
    const int node = pairs.node(row);
    const SweptBoxes& surface = faces.surface;
    if (!surface.node_is_owned(node))
      return;
    const Box box = nodeBox(rowOf(surface.coordinates_old, node),
                            rowOf(surface.coordinates_new, node), config.node_tolerance);
    for (int face = 0; face < num_all; ++face)
      if (box.overlaps(all.boxes(face)) && isAllowed(node, face) &&
          !isListed(row, node, all.ids(face, 0)))
        ++missed;
  }
  KOKKOS_INLINE_FUNCTION bool isAllowed(int node, int face) const {
    if (config.drop_same_body)
      return bodyOfSide(all.ids(face, 1)) != faces.surface.node_body(node);
    for (int corner = 0; corner < 4; ++corner)
      if (all.ids(face, 2 + corner) == faces.surface.node_ids(node))
        return false;
    return true;
  }
  KOKKOS_INLINE_FUNCTION bool isListed(std::int64_t row, int node, global_id id) const {
    for (std::int64_t pair = pairs.begin(row); pair < pairs.end(row); ++pair) {
      const int face = pairs.faces(pair);
      if (faces.id(face) == id)
        return faces.isOfThisStep(pairs.step_test, node, face);
    }
    return false;
  }
};

} // namespace

std::int64_t countMissedPairs(const exec_space& space, MPI_Comm comm, const SweptBoxes& surface,
                              const GhostFaces& ghosts, const CandidatePairs& pairs,
                              const SearchConfig& config) {
  const Region region("contact::countMissedPairs");
  const AuditedFaces own = describeOwnFaces(space, surface, config.face_tolerance);
  std::int64_t missed = 0;
  for (int root = 0; root < sizeOf(comm); ++root) {
    AuditedFaces all = own;
    const int count = allReduce(comm, root == rankOf(comm) ? surface.num_faces : 0, MPI_MAX);
    broadcastRows(space, comm, root, all.boxes, count);
    broadcastRows(space, comm, root, all.ids, count);
    std::int64_t of_root = 0;
    Kokkos::parallel_reduce("contact::countMissedPairs::count", rangePolicy(space, pairs.num_rows),
                            CountMissed{FaceAccess{surface, ghosts}, pairs, all, count, config},
                            Kokkos::Sum<std::int64_t>(of_root));
    missed += of_root;
  }
  return allReduce(comm, missed, MPI_SUM);
}

} // namespace brickwall::contact
