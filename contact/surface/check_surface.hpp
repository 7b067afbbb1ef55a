// Whether a host's surface can be searched (Views, counts, indices, ids), and whether it is still
// the one that was checked.
#pragma once

#include "contact/base/mpi.hpp"
#include "contact/surface/search_config.hpp"
#include "contact/surface/surface.hpp"

#include <cstdint>
#include <string>

namespace brickwall::contact {

// Collective. Throws InputError on all ranks, naming `function`, the rank, what was found and what
// was expected, if on any rank a count is negative, a View is missing or has fewer rows than its
// count, a corner of a face is no node, an id or a body is negative, or two nodes or two faces have
// the same id. The cost is linear in the size of the surface.
void checkSurface(const exec_space& space, MPI_Comm comm, const std::string& function,
                  const SweptBoxes& surface);

// Collective. Throws InputError on all ranks if a tolerance or the margin is negative or not
// finite, or if a value differs between ranks.
void checkSearchConfig(MPI_Comm comm, const std::string& function, const SearchConfig& config,
                       double margin = 0);

// Remembers the surface that was checked: between calls only coordinates and attributes may change,
// unless forget() is called. Connectivity, ids, bodies and owners are compared by 64-bit hashes.
class SurfaceCheck {
public:
  // Not collective. Whether `surface` has the counts of the one that was checked, Views that are
  // long enough and, where these are other Views, the same content.
  bool isSame(const exec_space& space, const SweptBoxes& surface);
  // Launches a look at a sixteenth of the rows, at another one in each call, after isSame().
  void startLook(const exec_space& space, const SweptBoxes& surface);
  // Whether these were the same. Waits for the device.
  bool looksSame(const exec_space& space) const;

  // Collective, needed where isSame() is false on any rank; `is_same` is that of this rank. Throws
  // InputError on all ranks as checkSurface() does, and if the surface has changed without
  // forget().
  void update(const exec_space& space, MPI_Comm comm, const std::string& function,
              const SweptBoxes& surface, bool is_same);

  void forget() { _is_checked = false; }

private:
  static constexpr int num_samples = 16;

  bool hasSameCounts(const SweptBoxes& surface) const;
  bool hasSameViews(const SweptBoxes& surface) const;
  void remember(const SweptBoxes& surface);

  bool _is_checked = false;
  SweptBoxes _surface; // keeps managed Views alive, so that their addresses tell surfaces apart
  std::uint64_t _hash[num_samples] = {};
  int _sample = 0; // of the last look
  Kokkos::View<std::uint64_t, staging_space> _looked{"contact::SurfaceCheck::looked"};
};

} // namespace brickwall::contact
