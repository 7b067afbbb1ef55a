// The back-end adapter: names of spaces and Views, and all that differs between Kokkos 3.4.1 and
// 4.x/5.x or between OpenMP and CUDA. Beside it only lanes.hpp, messages/peer_memory.hpp and
// miniapp/timing/device.cpp depend on the back end.
#pragma once

#include <Kokkos_Core.hpp>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>

#if defined(KOKKOS_ENABLE_CUDA)
#include <cuda_pipeline_primitives.h>
#endif

namespace brickwall {

using global_id = std::int64_t;

// The option BRICKWALL_EXECUTION_SPACE selects another execution space than the default of Kokkos.
#if defined(BRICKWALL_EXECUTION_SPACE)
using exec_space = Kokkos::BRICKWALL_EXECUTION_SPACE;
#else
using exec_space = Kokkos::DefaultExecutionSpace;
#endif
using memory_space = exec_space::memory_space;
using host_exec_space = Kokkos::DefaultHostExecutionSpace;

// Messages are staged here where MPI cannot read device memory: page-locked memory on CUDA,
// otherwise plain memory.
#if defined(KOKKOS_ENABLE_CUDA)
using staging_space = Kokkos::CudaHostPinnedSpace;
#else
using staging_space = Kokkos::HostSpace;
#endif

// Device data of the libraries, in the default layout of the back end.
template <class T>
using View = Kokkos::View<T, memory_space>;

// Functors travel as kernel arguments also if they are large: each launch that copies its functor
// to the constant memory of a device waits for the launch before.
using launch_by_argument = Kokkos::Experimental::WorkItemProperty::HintLightWeight_t;

using range_policy =
    Kokkos::RangePolicy<exec_space, Kokkos::IndexType<std::int64_t>, launch_by_argument>;

// True where kernels run on the host, so that staging copies vanish; false with managed memory,
// whose kernels run on a device.
constexpr bool host_accessible = std::is_same<memory_space, Kokkos::HostSpace>::value;

// Number of elements that one thread processes at once in SIMD lanes (contact/base/pack.hpp); on a
// device the lanes are threads. With BRICKWALL_SIMD_WIDTH=1 threads of processors have no lanes
// either, so that the code paths of devices can be tested there.
constexpr int simd_width = host_accessible ? BRICKWALL_SIMD_WIDTH : 1;
constexpr bool fills_lanes = simd_width > 1;

// Number of nodes that the contact search processes at once: the lanes of a SIMD register.
constexpr int cluster_size = fills_lanes ? 16 : 1;

// The launch policy over [0, n) on the given space instance.
inline range_policy rangePolicy(const exec_space& space, std::int64_t n) {
  return range_policy(space, 0, n);
}

// The same for iterations of unequal work: threads take `chunk` of them at a time.
using dynamic_policy = Kokkos::RangePolicy<exec_space, Kokkos::Schedule<Kokkos::Dynamic>,
                                           Kokkos::IndexType<std::int64_t>, launch_by_argument>;
inline dynamic_policy dynamicPolicy(const exec_space& space, std::int64_t n, int chunk) {
  return dynamic_policy(space, 0, n, Kokkos::ChunkSize(chunk));
}

// A View whose entries are not initialised; `extents` as for Kokkos::View.
template <class ViewType, class... Extents>
ViewType allocate(const exec_space& space, const std::string& label, Extents... extents) {
  return ViewType(Kokkos::view_alloc(space, Kokkos::WithoutInitializing, label),
                  static_cast<std::size_t>(extents)...);
}

// Makes `view` hold at least `n` rows (first extent). Keeps its label and other extents, not its
// contents. It gets a quarter more rows than needed, so that reallocation of a slowly growing View
// is rare. Rank 1 or [n][W].
template <class ViewType>
void growTo(const exec_space& space, ViewType& view, std::int64_t n) {
  if (static_cast<std::int64_t>(view.extent(0)) >= n)
    return;
  const std::string label = view.label();
  const auto rows = static_cast<std::size_t>(n + n / 4 + 16);
  auto layout = view.layout();
  layout.dimension[0] = rows;
  view = ViewType(); // free first: the peak is one copy
  view = ViewType(Kokkos::view_alloc(space, Kokkos::WithoutInitializing, label), layout);
}

// std::min and std::max are not callable in device code of every compiler.
template <class T>
KOKKOS_INLINE_FUNCTION constexpr T minOf(T a, T b) {
  return b < a ? b : a;
}
template <class T>
KOKKOS_INLINE_FUNCTION constexpr T maxOf(T a, T b) {
  return a < b ? b : a;
}

// count / by, rounded up; both > 0, or count 0.
template <class T>
KOKKOS_INLINE_FUNCTION constexpr T dividedUp(T count, std::common_type_t<T> by) {
  return count / by + (count % by != 0);
}

// Reducer for any value type with operator+= whose default value is the neutral element:
// parallel_reduce(..., PlusReducer<T>(result)). Kokkos::Sum<T> in 3.4.1 needs volatile operators;
// this does not. A device writes a result in staging_space without a wait of the host.
template <class T, class Space = Kokkos::HostSpace>
class PlusReducer {
public:
  using reducer = PlusReducer;
  using value_type = T;
  using result_view_type = Kokkos::View<T, Space, Kokkos::MemoryUnmanaged>;

  KOKKOS_INLINE_FUNCTION explicit PlusReducer(T& result) : _result(&result) {}
  KOKKOS_INLINE_FUNCTION void join(T& to, const T& from) const { to += from; }
  KOKKOS_INLINE_FUNCTION void join(volatile T& to, const volatile T& from) const {
    const_cast<T&>(to) += const_cast<const T&>(from);
  }
  KOKKOS_INLINE_FUNCTION void init(T& value) const { value = T(); }
  KOKKOS_INLINE_FUNCTION T& reference() const { return *_result.data(); }
  KOKKOS_INLINE_FUNCTION result_view_type view() const { return _result; }
  // Kokkos waits for results of which this is true.
  KOKKOS_INLINE_FUNCTION bool references_scalar() const {
    return std::is_same<Space, Kokkos::HostSpace>::value;
  }

private:
  result_view_type _result;
};

// To be placed between plain memory accesses and an atomic operation by which one thread hands data
// to another: writes before the atomic of the first thread are visible after the atomic of the
// second. (Kokkos::memory_fence costs more on processors.)
KOKKOS_INLINE_FUNCTION void orderMemory() {
#if defined(__CUDA_ARCH__) || defined(__HIP_DEVICE_COMPILE__)
  Kokkos::memory_fence();
#else
  std::atomic_thread_fence(std::memory_order_acq_rel);
#endif
}

// A value that other threads may change meanwhile, by atomic operations. (Kokkos::atomic_load is
// missing in Kokkos 3, and exchanges the value in Kokkos 4.)
template <class T>
KOKKOS_FORCEINLINE_FUNCTION T loadShared(const T& value) {
#if defined(__CUDA_ARCH__) || defined(__HIP_DEVICE_COMPILE__)
  return const_cast<const volatile T&>(value);
#else
  return __atomic_load_n(&value, __ATOMIC_RELAXED);
#endif
}

// Stores a value that other threads may store at the same time.
template <class T>
KOKKOS_FORCEINLINE_FUNCTION void storeShared(T& to, T value) {
#if defined(__CUDA_ARCH__) || defined(__HIP_DEVICE_COMPILE__)
  static_cast<volatile T&>(to) = value;
#else
  __atomic_store_n(&to, value, __ATOMIC_RELAXED);
#endif
}

// Keeps the compiler of a device from moving loads of the code before to where their values are
// used, so that a thread waits for all of them at once.
KOKKOS_FORCEINLINE_FUNCTION void startLoads() {
#if defined(__CUDA_ARCH__) || defined(__HIP_DEVICE_COMPILE__)
  asm volatile("" ::: "memory");
#endif
}

// Copies a number of 4 or 8 bytes to the scratch memory of a team. It may arrive as late as at
// finishCopies(), after which other threads can read it behind a barrier.
template <class T>
KOKKOS_FORCEINLINE_FUNCTION void startCopy(T& to, const T& from) {
#if defined(__CUDA_ARCH__)
  __pipeline_memcpy_async(&to, &from, sizeof(T));
#else
  to = from;
#endif
}
// Waits for the copies that this thread has started.
KOKKOS_FORCEINLINE_FUNCTION void finishCopies() {
#if defined(__CUDA_ARCH__)
  __pipeline_commit();
  __pipeline_wait_prior(0);
#endif
}

// A number > 0 of the calling thread that no other thread of the program has; 0 on devices.
KOKKOS_INLINE_FUNCTION int threadNumber() {
#if defined(__CUDA_ARCH__) || defined(__HIP_DEVICE_COMPILE__)
  return 0;
#else
  static std::atomic<int> last{0};
  static thread_local const int number = ++last;
  return number;
#endif
}

// Prefetches data that will be read soon; on a device other threads hide the latency. Forced
// inline, as must be all functions that only call it: g++ 12 takes such functions for pure and
// deletes their calls.
KOKKOS_FORCEINLINE_FUNCTION void prefetch(const void* address) {
#if defined(__GNUC__) && !defined(__CUDA_ARCH__) && !defined(__HIP_DEVICE_COMPILE__)
  __builtin_prefetch(address);
#else
  (void)address;
#endif
}

// Combines lanes of two vectors (contact/base/pack.hpp) by number: 0 .. W-1 are those of a, W ..
// 2W-1 those of b. With constant numbers this is one instruction.
template <class V, class Numbers>
KOKKOS_FORCEINLINE_FUNCTION V shuffled(const V& a, const V& b, const Numbers& lanes) {
#if defined(__clang__)
  constexpr int width = sizeof(Numbers) / sizeof(lanes[0]);
  V to;
  for (int lane = 0; lane < width; ++lane)
    to[lane] = lanes[lane] < width ? a[lanes[lane]] : b[lanes[lane] - width];
  return to;
#else
  return __builtin_shuffle(a, b, lanes);
#endif
}

// Number of threads (or device lanes) that the default execution space runs at once.
inline int concurrency(const exec_space& space) {
#if defined(KOKKOS_VERSION) && KOKKOS_VERSION >= 30700
  return space.concurrency();
#else
  (void)space;
  return exec_space::concurrency();
#endif
}

// Another queue of a device, whose kernels run beside those of `space`; a host has none.
inline exec_space queueBeside(const exec_space& space) {
#if defined(KOKKOS_VERSION) && KOKKOS_VERSION >= 40000
  if constexpr (!host_accessible)
    return Kokkos::Experimental::partition_space(space, 1)[0];
#endif
  return space;
}

// A place in a queue of a device that other queues can wait for while the host goes on. A host
// computes in one queue.
class QueueMark {
public:
  QueueMark() = default;
  QueueMark(const QueueMark&) = delete;
  QueueMark& operator=(const QueueMark&) = delete;
#if defined(KOKKOS_ENABLE_CUDA)
  ~QueueMark() {
    if (_event != nullptr)
      cudaEventDestroy(_event);
  }
#endif

  // Moves the mark to the end of what has been launched in `queue`.
  template <class Queue>
  void set(const Queue& queue) {
    if constexpr (host_accessible)
      return;
#if defined(KOKKOS_ENABLE_CUDA)
    if constexpr (std::is_same<Queue, Kokkos::Cuda>::value) {
      if (_event == nullptr)
        requireSuccess(cudaEventCreateWithFlags(&_event, cudaEventDisableTiming));
      requireSuccess(cudaEventRecord(_event, queue.cuda_stream()));
      return;
    }
#endif
    queue.fence();
  }
  // What is launched in `queue` from now on starts after the mark, if it has been set.
  template <class Queue>
  void waitIn(const Queue& queue) const {
    (void)queue;
#if defined(KOKKOS_ENABLE_CUDA)
    if constexpr (std::is_same<Queue, Kokkos::Cuda>::value)
      if (_event != nullptr)
        requireSuccess(cudaStreamWaitEvent(queue.cuda_stream(), _event, 0));
#endif
  }

#if defined(KOKKOS_ENABLE_CUDA)
private:
  static void requireSuccess(cudaError_t error) {
    if (error != cudaSuccess)
      Kokkos::abort(cudaGetErrorString(error));
  }
  cudaEvent_t _event = nullptr;
#endif
};

// To be called before Kokkos::initialize. Kokkos 4 and later fence the device around every
// profiling region if a tool is registered; the recorder of phase times does not need these fences
// (a tool that is loaded can still request them).
inline void letToolsSkipFences() {
#if defined(KOKKOS_VERSION) && KOKKOS_VERSION >= 40000
  Kokkos::Tools::Experimental::set_request_tool_settings_callback(
      [](std::uint32_t, Kokkos_Tools_ToolSettings* settings) {
        settings->requires_global_fencing = false;
      });
#endif
}

// Calls body(i) for i in [0, n) on all threads of the host.
template <class Body>
void parallelOnHost(const std::string& label, std::int64_t n, const Body& body) {
  using policy = Kokkos::RangePolicy<host_exec_space, Kokkos::IndexType<std::int64_t>>;
  Kokkos::parallel_for(label, policy(0, n), body);
  host_exec_space().fence();
}

} // namespace brickwall
