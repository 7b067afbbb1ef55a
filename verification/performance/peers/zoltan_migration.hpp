// Migration of ghost faces by Zoltan_Migrate as in host codes: callbacks size, pack and unpack
// objects.
#pragma once

#include "contact/surface/surface.hpp"

#include <mpi.h>

#include <memory>
#include <vector>

namespace brickwall::peers {

// The contents of a ghost, as many bytes as in Brickwall's own message: 30 words.
struct FaceRecord {
  global_id face = 0, body = 0;
  global_id corners[4] = {0, 0, 0, 0};
  double x_old[12] = {}, x_new[12] = {}; // [3 * corner + xyz]
};
static_assert(sizeof(FaceRecord) == 240);

class ZoltanMigration {
public:
  // Collective. Copies the surface to the host; the local `faces` go to the ranks `destinations`.
  ZoltanMigration(MPI_Comm comm, const contact::Surface& surface, const std::vector<int>& faces,
                  const std::vector<int>& destinations);
  ~ZoltanMigration();

  // Collective. Packs, sends and unpacks; the result stays valid until the next call.
  const std::vector<FaceRecord>& migrate();

private:
  struct State;
  std::unique_ptr<State> _state;
};

} // namespace brickwall::peers
