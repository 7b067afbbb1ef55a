// The way of messages between ranks whose data are in the memory of a device: chosen by what MPI
// and the host offer, or by the environment variable BRICKWALL_MESSAGES.
#pragma once

#include "contact/base/backend.hpp"
#include "contact/base/error.hpp"

#include <mpi.h>

#include <cstdlib>
#include <string>

#if __has_include(<mpi-ext.h>)
#include <mpi-ext.h>
#endif

namespace brickwall {

enum class MessagePath {
  direct, // MPI reads and writes the memory of kernels
  staged, // through page-locked memory of the host
  peer // ranks of a host copy from each other's devices; other messages are staged
};

inline const char* nameOf(MessagePath path) {
  return path == MessagePath::direct ? "direct" : path == MessagePath::staged ? "staged" : "peer";
}

// Whether this MPI says that it takes addresses of device memory.
inline bool isDeviceAware() {
#if defined(MPIX_CUDA_AWARE_SUPPORT)
  if (MPIX_Query_cuda_support() == 1)
    return true;
#endif
#if defined(MPIX_ROCM_AWARE_SUPPORT)
  if (MPIX_Query_rocm_support() == 1)
    return true;
#endif
  return false;
}

// The same on all ranks if the variable is. Throws InputError for another value.
inline MessagePath chooseMessagePath() {
  const char* const variable = std::getenv("BRICKWALL_MESSAGES");
  const std::string wanted = variable != nullptr ? variable : "";
  for (const MessagePath path : {MessagePath::direct, MessagePath::staged, MessagePath::peer})
    if (wanted == nameOf(path))
      return path;
  if (!wanted.empty() && wanted != "auto")
    throw InputError("BRICKWALL_MESSAGES is \"" + wanted +
                     "\"; expected auto, direct, staged or peer");
  return host_accessible || isDeviceAware() ? MessagePath::direct : MessagePath::peer;
}

// Messages of words that this rank has sent to others since its start, for reports.
struct MessageCounts {
  std::int64_t messages = 0, words = 0;

  void add(std::int64_t num_words) {
    ++messages;
    words += num_words;
  }
};
inline MessageCounts& messagesSent() {
  static MessageCounts counts;
  return counts;
}

} // namespace brickwall
