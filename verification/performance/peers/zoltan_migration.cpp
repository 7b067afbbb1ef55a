#include "verification/performance/peers/zoltan_migration.hpp"

#include "contact/base/error.hpp"
#include "contact/base/to_device.hpp"

#include <zoltan.h>

#include <cstring>
#include <string>

namespace brickwall::peers {
namespace {

constexpr int id_words = sizeof(global_id) / sizeof(ZOLTAN_ID_TYPE);

void checkZoltan(int code, const char* call) {
  if (code != ZOLTAN_OK && code != ZOLTAN_WARN)
    throw Error(ExitCode::internal, std::string(call) + " failed: " + std::to_string(code));
}

} // namespace

struct ZoltanMigration::State {
  explicit State(const contact::Surface& surface)
      : face_to_nodes(toHost(surface.face_to_nodes)), face_ids(toHost(surface.face_ids)),
        face_body(toHost(surface.face_body)), node_ids(toHost(surface.node_ids)),
        x_old(toHost(surface.coordinates_old)), x_new(toHost(surface.coordinates_new)) {}
  ~State() {
    if (zoltan)
      Zoltan_Destroy(&zoltan);
  }

  void setUp(MPI_Comm comm) {
    float version = 0;
    checkZoltan(Zoltan_Initialize(0, nullptr, &version), "Zoltan_Initialize");
    zoltan = Zoltan_Create(comm);
    if (!zoltan)
      throw Error(ExitCode::internal, "Zoltan_Create failed");
    const std::string words = std::to_string(id_words);
    const char* settings[][2] = {
        {"DEBUG_LEVEL", "0"}, {"NUM_GID_ENTRIES", words.c_str()}, {"NUM_LID_ENTRIES", "1"}};
    for (const auto& setting : settings)
      checkZoltan(Zoltan_Set_Param(zoltan, setting[0], setting[1]), "Zoltan_Set_Param");
    checkZoltan(Zoltan_Set_Obj_Size_Multi_Fn(zoltan, sizes, this), "Zoltan_Set_Obj_Size_Multi_Fn");
    checkZoltan(Zoltan_Set_Pack_Obj_Multi_Fn(zoltan, pack, this), "Zoltan_Set_Pack_Obj_Multi_Fn");
    checkZoltan(Zoltan_Set_Unpack_Obj_Multi_Fn(zoltan, unpack, this),
                "Zoltan_Set_Unpack_Obj_Multi_Fn");
  }

  FaceRecord record(int face) const {
    FaceRecord to;
    to.face = face_ids(face);
    to.body = face_body(face);
    for (int c = 0; c < 4; ++c) {
      const int node = face_to_nodes(face, c);
      to.corners[c] = node_ids(node);
      for (int d = 0; d < 3; ++d) {
        to.x_old[3 * c + d] = x_old(node, d);
        to.x_new[3 * c + d] = x_new(node, d);
      }
    }
    return to;
  }

  static void sizes(void*, int, int, int num, ZOLTAN_ID_PTR, ZOLTAN_ID_PTR, int* bytes,
                    int* error) {
    for (int i = 0; i < num; ++i)
      bytes[i] = sizeof(FaceRecord);
    *error = ZOLTAN_OK;
  }
  static void pack(void* data, int, int, int num, ZOLTAN_ID_PTR, ZOLTAN_ID_PTR local, int*, int*,
                   int* offsets, char* buffer, int* error) {
    const State& state = *static_cast<const State*>(data);
    for (int i = 0; i < num; ++i) {
      const FaceRecord face = state.record(static_cast<int>(local[i]));
      std::memcpy(buffer + offsets[i], &face, sizeof face);
    }
    *error = ZOLTAN_OK;
  }
  static void unpack(void* data, int, int num, ZOLTAN_ID_PTR, int*, int* offsets, char* buffer,
                     int* error) {
    auto& ghosts = static_cast<State*>(data)->ghosts;
    ghosts.resize(static_cast<std::size_t>(num));
    for (int i = 0; i < num; ++i)
      std::memcpy(&ghosts[i], buffer + offsets[i], sizeof(FaceRecord));
    *error = ZOLTAN_OK;
  }

  View<const int* [4]>::HostMirror::const_type face_to_nodes;
  View<const global_id*>::HostMirror::const_type face_ids, face_body, node_ids;
  View<const double*[3]>::HostMirror::const_type x_old, x_new;
  std::vector<ZOLTAN_ID_TYPE> ids, local_ids; // exports
  std::vector<int> destinations;
  std::vector<FaceRecord> ghosts;
  Zoltan_Struct* zoltan = nullptr;
};

ZoltanMigration::ZoltanMigration(MPI_Comm comm, const contact::Surface& surface,
                                 const std::vector<int>& faces,
                                 const std::vector<int>& destinations)
    : _state(std::make_unique<State>(surface)) {
  _state->destinations = destinations;
  _state->ids.resize(faces.size() * id_words);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const global_id id = _state->face_ids(faces[i]);
    std::memcpy(&_state->ids[i * id_words], &id, sizeof id);
    _state->local_ids.push_back(static_cast<ZOLTAN_ID_TYPE>(faces[i]));
  }
  _state->setUp(comm);
}

ZoltanMigration::~ZoltanMigration() = default;

const std::vector<FaceRecord>& ZoltanMigration::migrate() {
  State& state = *_state;
  state.ghosts.clear(); // unpack is not called where nothing comes
  constexpr int unknown = -1; // imports: Zoltan finds them from the exports
  checkZoltan(Zoltan_Migrate(state.zoltan, unknown, nullptr, nullptr, nullptr, nullptr,
                             static_cast<int>(state.destinations.size()), state.ids.data(),
                             state.local_ids.data(), state.destinations.data(), nullptr),
              "Zoltan_Migrate");
  return state.ghosts;
}

} // namespace brickwall::peers
