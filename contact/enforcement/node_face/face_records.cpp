// See face_records.hpp.
#include "contact/enforcement/node_face/face_records.hpp"

namespace brickwall::contact {
namespace {

constexpr int least_share = 4; // of blocks asleep so many times fewer: else all faces are wanted

void ghostRecords(const exec_space& space, const FaceAccess& faces, int first_row,
                  const View<FaceRecord*>& records) {
  Kokkos::parallel_for(
      "contact::enforce::ghostRecords", rangePolicy(space, faces.ghosts.count),
      KOKKOS_LAMBDA(const std::int64_t ghost) {
        const int face = faces.surface.num_faces + static_cast<int>(ghost);
        records(first_row + ghost) = {meanPlane(faces.quad(face)), faces.body(face),
                                      faces.id(face)};
      });
}

// Own faces that rows which are awake ask for: candidates, and those around the nodes.
void markWanted(const exec_space& space, const CandidatePairs& pairs, const SleepState& sleep,
                const NodeFaceLists& around, std::int64_t num_blocks,
                const View<unsigned char*>& is_wanted) {
  const int num_faces = static_cast<int>(is_wanted.extent(0));
  Kokkos::parallel_for(
      "contact::FaceRecords::markWanted", rangePolicy(space, num_blocks),
      KOKKOS_LAMBDA(const std::int64_t block) {
        if (sleep.sleeps(block))
          return;
        constexpr int width = CandidatePairs::rows_per_block;
        const std::int64_t end = minOf<std::int64_t>((block + 1) * width, pairs.num_rows);
        for (std::int64_t row = block * width; row < end; ++row) {
          const std::int64_t last = pairs.end(row);
          if (pairs.begin(row) == last)
            continue;
          for (std::int64_t p = pairs.begin(row); p < last; ++p)
            if (pairs.faces(p) < num_faces)
              is_wanted(pairs.faces(p)) = 1;
          const int node = pairs.node(row);
          for (int k = around.offsets(node); k < around.offsets(node + 1); ++k)
            if (around.rows(k) < num_faces)
              is_wanted(around.rows(k)) = 1;
        }
      });
}

} // namespace

FaceRecords::FaceRecords(const exec_space& space, const Surface& surface,
                         const NodeFaces& node_faces)
    : _records(allocate<View<FaceRecord*>>(space, "contact::FaceRecords::records",
                                           surface.num_faces + node_faces.numRemote())),
      _is_current("contact::FaceRecords::is_current", surface.num_faces),
      _is_wanted("contact::FaceRecords::is_wanted", surface.num_faces) {}

void FaceRecords::update(const exec_space& space, const FaceAccess& faces,
                         const CandidatePairs& pairs, const StationaryFlags& still,
                         const SleepingBlocks& sleeping, NodeFaces& node_faces) {
  const int first_ghost = faces.surface.num_faces + node_faces.numRemote();
  const auto num_records = static_cast<std::int64_t>(first_ghost) + faces.ghosts.count;
  if (num_records > static_cast<std::int64_t>(_records.extent(0)))
    forget(space);
  growTo(space, _records, num_records);
  RecordsWanted wanted;
  wanted.is_current = _is_current;
  if (still.is_any)
    wanted.still = still.faces;
  if (least_share * sleeping.numAwake() < sleeping.numBlocks()) {
    markWanted(space, pairs, sleeping.state(), node_faces.lists(), sleeping.numBlocks(),
               _is_wanted);
    wanted.is_wanted = _is_wanted;
  }
  node_faces.updateRecords(space, faces.surface, wanted, _records);
  if (wanted.is_wanted.extent(0) > 0)
    Kokkos::deep_copy(space, _is_wanted, static_cast<unsigned char>(0));
  ghostRecords(space, faces, first_ghost, _records);
}

void FaceRecords::forget(const exec_space& space) {
  Kokkos::deep_copy(space, _is_current, static_cast<unsigned char>(0));
}

} // namespace brickwall::contact
