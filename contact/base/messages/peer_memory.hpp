// The back-end adapter of memory that the processes of one host share, and of the events that order
// their work on it: CUDA IPC for devices; files in memory for kernels that run on the host.
#pragma once

#include "contact/base/backend.hpp"

#include <cstdio>
#include <cstring>

#if !defined(KOKKOS_ENABLE_CUDA)
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>
#endif

namespace brickwall::peer {

// What another process of the host needs to open memory or an event. Plain bytes, for messages.
struct Handle {
  char bytes[64] = {};
};

#if defined(KOKKOS_ENABLE_CUDA)

// Drivers put small allocations into one piece of memory, of which a handle names the beginning.
constexpr std::int64_t least_words = (std::int64_t(1) << 21) / 8;

using Event = cudaEvent_t;

// Succeeds or leaves no error behind that a later call would find.
inline bool did(cudaError_t result) {
  if (result != cudaSuccess)
    (void)cudaGetLastError();
  return result == cudaSuccess;
}

template <class T>
Handle toHandle(const T& of_driver) {
  static_assert(sizeof(T) <= sizeof(Handle));
  Handle handle;
  memcpy(handle.bytes, &of_driver, sizeof of_driver);
  return handle;
}
template <class T>
T fromHandle(const Handle& handle) {
  T of_driver;
  memcpy(&of_driver, handle.bytes, sizeof of_driver);
  return of_driver;
}

template <class Space>
cudaStream_t streamOf(const Space& space) {
  if constexpr (std::is_same<Space, Kokkos::Cuda>::value)
    return space.cuda_stream();
  else
    return nullptr; // unused: kernels of the host have no such memory
}

// Memory that others can open; it lasts as long as the process. Null if there is none.
inline std::int64_t* allocate(std::int64_t words, Handle& handle) {
  void* data = nullptr;
  cudaIpcMemHandle_t of_driver;
  if (host_accessible || !did(cudaMalloc(&data, static_cast<std::size_t>(words) * 8)))
    return nullptr;
  if (!did(cudaIpcGetMemHandle(&of_driver, data))) {
    (void)did(cudaFree(data));
    return nullptr;
  }
  handle = toHandle(of_driver);
  return static_cast<std::int64_t*>(data);
}
// The memory of another process, or null if it cannot be reached from the device of this one.
inline const std::int64_t* open(const Handle& handle, std::int64_t) {
  void* data = nullptr;
  const bool is_open = did(cudaIpcOpenMemHandle(&data, fromHandle<cudaIpcMemHandle_t>(handle),
                                                cudaIpcMemLazyEnablePeerAccess));
  return is_open ? static_cast<const std::int64_t*>(data) : nullptr;
}

// An event that others can open; null if there is none.
inline Event makeEvent(Handle& handle) {
  Event event = nullptr;
  cudaIpcEventHandle_t of_driver;
  if (!did(cudaEventCreateWithFlags(&event, cudaEventDisableTiming | cudaEventInterprocess)) ||
      !did(cudaIpcGetEventHandle(&of_driver, event)))
    return nullptr;
  handle = toHandle(of_driver);
  return event;
}
inline Event openEvent(const Handle& handle) {
  Event event = nullptr;
  return did(cudaIpcOpenEventHandle(&event, fromHandle<cudaIpcEventHandle_t>(handle))) ? event
                                                                                       : nullptr;
}
// The event happens when the device has done what was launched before.
inline bool record(const exec_space& space, Event event) {
  return did(cudaEventRecord(event, streamOf(space)));
}
// What is launched from here on waits for the last record() that the other process has made.
inline bool waitFor(const exec_space& space, Event event) {
  return did(cudaStreamWaitEvent(streamOf(space), event, 0));
}
inline bool copy(const exec_space& space, std::int64_t* to, const std::int64_t* from,
                 std::int64_t words) {
  return did(cudaMemcpyAsync(to, from, static_cast<std::size_t>(words) * 8, cudaMemcpyDefault,
                             streamOf(space)));
}

#else

constexpr std::int64_t least_words = 512;

using Event = const char*; // events happen in the order of the messages that announce them

inline std::int64_t* map(int file, std::int64_t words, int protection) {
  void* const data =
      mmap(nullptr, static_cast<std::size_t>(words) * 8, protection, MAP_SHARED, file, 0);
  return data == MAP_FAILED ? nullptr : static_cast<std::int64_t*>(data);
}
inline std::int64_t* allocate(std::int64_t words, Handle& handle) {
  const int file = host_accessible ? memfd_create("brickwall", 0) : -1;
  if (file < 0 || ftruncate(file, words * 8) != 0)
    return nullptr;
  std::snprintf(handle.bytes, sizeof handle.bytes, "/proc/%ld/fd/%d", static_cast<long>(getpid()),
                file);
  return map(file, words, PROT_READ | PROT_WRITE);
}
inline const std::int64_t* open(const Handle& handle, std::int64_t words) {
  const int file = ::open(handle.bytes, O_RDONLY);
  if (file < 0)
    return nullptr;
  const std::int64_t* const data = map(file, words, PROT_READ);
  close(file);
  return data;
}
inline Event makeEvent(Handle&) {
  return "";
}
inline Event openEvent(const Handle&) {
  return "";
}
inline bool record(const exec_space& space, Event) {
  space.fence();
  return true;
}
inline bool waitFor(const exec_space&, Event) {
  return true;
}
inline bool copy(const exec_space& space, std::int64_t* to, const std::int64_t* from,
                 std::int64_t words) {
  space.fence();
  memcpy(to, from, static_cast<std::size_t>(words) * 8);
  return true;
}

#endif

} // namespace brickwall::peer
