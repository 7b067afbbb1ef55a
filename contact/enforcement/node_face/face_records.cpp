#include "contact/enforcement/node_face/face_records.hpp"

namespace brickwall::contact {
namespace {

// records are made for requested faces only if fewer than 1/4 of the blocks are awake
constexpr int min_asleep_ratio = 4;

void ghostRecords(const exec_space& space, const FaceAccess& faces, int first_row,
                  const View<FaceRecord*>& records) {
  Kokkos::parallel_for(
      "contact::enforce::ghostRecords", rangePolicy(space, faces.ghosts.count),
      KOKKOS_LAMBDA(const std::int64_t ghost) {
        const int face = faces.surface.num_faces + static_cast<int>(ghost);
        records(first_row + ghost) = {meanPlane(faces.quad(face)), faces.side(face),
                                      faces.id(face)};
      });
}

// Requests own faces of rows that are awake: candidates, and the faces around the nodes.
void markRequested(const exec_space& space, const CandidatePairs& pairs, const SleepState& sleep,
                   const NodeFaceLists& adjacent_faces, std::int64_t num_blocks,
                   const View<unsigned char*>& is_requested) {
  const int num_faces = static_cast<int>(is_requested.extent(0));
  Kokkos::parallel_for(
      "contact::FaceRecords::markRequested", rangePolicy(space, num_blocks),
      KOKKOS_LAMBDA(const std::int64_t block) {
        if (sleep.sleeps(block))
          return;
        constexpr int width = CandidatePairs::rows_per_block;
        constexpr unsigned char set = 1;
        const std::int64_t end = minOf<std::int64_t>((block + 1) * width, pairs.num_rows);
        for (std::int64_t row = block * width; row < end; ++row) {
          const std::int64_t last = pairs.end(row);
          if (pairs.begin(row) == last)
            continue;
          for (std::int64_t p = pairs.begin(row); p < last; ++p)
            if (pairs.faces(p) < num_faces)
              storeShared(is_requested(pairs.faces(p)), set);
          const int node = pairs.node(row);
          for (int k = adjacent_faces.offsets(node); k < adjacent_faces.offsets(node + 1); ++k)
            if (adjacent_faces.rows(k) < num_faces)
              storeShared(is_requested(adjacent_faces.rows(k)), set);
        }
      });
}

} // namespace

FaceRecords::FaceRecords(const exec_space& space, const Surface& surface,
                         const NodeFaces& node_faces)
    : _records(allocate<View<FaceRecord*>>(space, "contact::FaceRecords::records",
                                           surface.num_faces + node_faces.numRemote())),
      _is_current("contact::FaceRecords::is_current", surface.num_faces),
      _is_requested("contact::FaceRecords::is_requested", surface.num_faces) {}

void FaceRecords::update(const exec_space& space, const FaceAccess& faces,
                         const CandidatePairs& pairs, const IdleRows& idle, NodeFaces& node_faces) {
  const int first_ghost = faces.surface.num_faces + node_faces.numRemote();
  const auto num_records = static_cast<std::int64_t>(first_ghost) + faces.ghosts.count;
  if (num_records > static_cast<std::int64_t>(_records.extent(0)))
    invalidate(space);
  growTo(space, _records, num_records);
  RecordSelection selection;
  selection.is_current = _is_current;
  const StationaryFlags stationary = idle.state().stationary;
  if (stationary.is_any)
    selection.stationary = stationary.faces;
  const SleepingBlocks& sleeping = idle.sleeping();
  if (min_asleep_ratio * sleeping.numAwake(space) < sleeping.numBlocks()) {
    markRequested(space, pairs, sleeping.state(), node_faces.lists(), sleeping.numBlocks(),
                  _is_requested);
    selection.is_requested = _is_requested;
  }
  node_faces.updateRecords(space, faces.surface, selection, _records);
  if (selection.is_requested.extent(0) > 0)
    Kokkos::deep_copy(space, _is_requested, static_cast<unsigned char>(0));
  ghostRecords(space, faces, first_ghost, _records);
}

void FaceRecords::invalidate(const exec_space& space) {
  Kokkos::deep_copy(space, _is_current, static_cast<unsigned char>(0));
}

} // namespace brickwall::contact
