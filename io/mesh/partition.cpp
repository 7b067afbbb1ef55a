// Zoltan RCB. Ids go as NUM_GID_ENTRIES words of ZOLTAN_ID_TYPE, whatever its size.
#include "io/mesh/partition.hpp"

#include "contact/base/mpi.hpp"

#include <zoltan.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <string>
#include <unordered_map>

namespace brickwall::io {

namespace {

static_assert(sizeof(global_id) % sizeof(ZOLTAN_ID_TYPE) == 0);
constexpr int id_words = sizeof(global_id) / sizeof(ZOLTAN_ID_TYPE);

// A warning (such as of imbalance) is not a failure.
void checkZoltan(int code, const char* call) {
  if (code != ZOLTAN_OK && code != ZOLTAN_WARN)
    throw Error(ExitCode::internal,
                std::string(call) + " failed with code " + std::to_string(code));
}

struct Points {
  const std::vector<global_id>* ids;
  const std::vector<double>* coordinates;
  const std::vector<float>* weights;
};
const Points& pointsOf(void* data) {
  return *static_cast<const Points*>(data);
}

int numPoints(void* data, int* error) {
  *error = ZOLTAN_OK;
  return static_cast<int>(pointsOf(data).ids->size());
}
void listPoints(void* data, int, int, ZOLTAN_ID_PTR ids, ZOLTAN_ID_PTR, int weights_per_point,
                float* weights, int* error) {
  const auto& from = *pointsOf(data).ids;
  if (!from.empty())
    std::memcpy(ids, from.data(), from.size() * sizeof(global_id));
  if (weights_per_point > 0)
    std::copy(pointsOf(data).weights->begin(), pointsOf(data).weights->end(), weights);
  *error = ZOLTAN_OK;
}
int numDimensions(void*, int* error) {
  *error = ZOLTAN_OK;
  return 3;
}
// Points come in the order of listPoints.
void copyCoordinates(void* data, int, int, int num, ZOLTAN_ID_PTR, ZOLTAN_ID_PTR, int, double* to,
                     int* error) {
  if (num > 0)
    std::memcpy(to, pointsOf(data).coordinates->data(),
                static_cast<std::size_t>(num) * 3 * sizeof(double));
  *error = ZOLTAN_OK;
}

struct Destroy {
  void operator()(Zoltan_Struct* zoltan) const { Zoltan_Destroy(&zoltan); }
};
using ZoltanHandle = std::unique_ptr<Zoltan_Struct, Destroy>;

ZoltanHandle createRcb(MPI_Comm comm, const Points& points, bool has_weights,
                       CutPlanes cut_planes) {
  float version = 0;
  checkZoltan(Zoltan_Initialize(0, nullptr, &version), "Zoltan_Initialize");
  ZoltanHandle zoltan(Zoltan_Create(comm));
  if (!zoltan)
    throw Error(ExitCode::internal, "Zoltan_Create failed");
  const std::string words = std::to_string(id_words);
  const char* settings[][2] = {
      {"DEBUG_LEVEL", "0"},
      {"LB_METHOD", "RCB"},
      {"LB_APPROACH", "PARTITION"},
      {"NUM_GID_ENTRIES", words.c_str()},
      {"NUM_LID_ENTRIES", "0"},
      {"OBJ_WEIGHT_DIM", has_weights ? "1" : "0"},
      {"RETURN_LISTS", "EXPORT"},
      {"RCB_OUTPUT_LEVEL", "0"},
      {"RCB_RECTILINEAR_BLOCKS", cut_planes == CutPlanes::whole ? "1" : "0"},
      {"CHECK_GEOM", "0"},
  };
  for (const auto& setting : settings)
    checkZoltan(Zoltan_Set_Param(zoltan.get(), setting[0], setting[1]), "Zoltan_Set_Param");
  void* data = const_cast<Points*>(&points);
  checkZoltan(Zoltan_Set_Num_Obj_Fn(zoltan.get(), numPoints, data), "Zoltan_Set_Num_Obj_Fn");
  checkZoltan(Zoltan_Set_Obj_List_Fn(zoltan.get(), listPoints, data), "Zoltan_Set_Obj_List_Fn");
  checkZoltan(Zoltan_Set_Num_Geom_Fn(zoltan.get(), numDimensions, data), "Zoltan_Set_Num_Geom_Fn");
  checkZoltan(Zoltan_Set_Geom_Multi_Fn(zoltan.get(), copyCoordinates, data),
              "Zoltan_Set_Geom_Multi_Fn");
  return zoltan;
}

} // namespace

std::vector<int> partitionPoints(MPI_Comm comm, const std::vector<global_id>& ids,
                                 const std::vector<double>& points,
                                 const std::vector<float>& weights, CutPlanes cut_planes) {
  const std::int64_t num_points = allReduce(comm, static_cast<std::int64_t>(ids.size()), MPI_SUM);
  if (sizeOf(comm) == 1 || num_points == 0) // RCB fails without points
    return std::vector<int>(ids.size(), 0);
  rethrowOnAllRanks(comm,
                    [&] { checkedInt(static_cast<std::int64_t>(ids.size()), "partitionPoints"); });
  const Points mine{&ids, &points, &weights};
  const bool has_weights = allReduce(comm, weights.empty() ? 0 : 1, MPI_MAX) > 0;
  const ZoltanHandle zoltan = createRcb(comm, mine, has_weights, cut_planes);

  int changed = 0, gid_words = 0, lid_words = 0, num_import = 0, num_export = 0;
  ZOLTAN_ID_PTR import_gids = nullptr, import_lids = nullptr;
  ZOLTAN_ID_PTR export_gids = nullptr, export_lids = nullptr;
  int *import_ranks = nullptr, *import_parts = nullptr;
  int *export_ranks = nullptr, *export_parts = nullptr;
  const int code =
      Zoltan_LB_Partition(zoltan.get(), &changed, &gid_words, &lid_words, &num_import, &import_gids,
                          &import_lids, &import_ranks, &import_parts, &num_export, &export_gids,
                          &export_lids, &export_ranks, &export_parts);
  // Only points that leave this rank are listed, in an order of Zoltan. (Its list of all parts
  // fails with ZOLTAN_FATAL on ranks without points when nothing changes.)
  std::unordered_map<global_id, int> rank_of_leaving;
  for (int i = 0; i < num_export; ++i) {
    global_id id = 0;
    std::memcpy(&id, export_gids + static_cast<std::ptrdiff_t>(i) * id_words, sizeof id);
    rank_of_leaving[id] = export_ranks[i];
  }
  Zoltan_LB_Free_Part(&import_gids, &import_lids, &import_ranks, &import_parts);
  Zoltan_LB_Free_Part(&export_gids, &export_lids, &export_ranks, &export_parts);
  checkZoltan(code, "Zoltan_LB_Partition");

  std::vector<int> rank_of_point(ids.size(), rankOf(comm));
  for (std::size_t i = 0; i < ids.size() && !rank_of_leaving.empty(); ++i) {
    const auto leaving = rank_of_leaving.find(ids[i]);
    if (leaving != rank_of_leaving.end())
      rank_of_point[i] = leaving->second;
  }
  return rank_of_point;
}

} // namespace brickwall::io
