#include "miniapp/timing/device.hpp"

#include "contact/base/backend.hpp"

#include <type_traits>

namespace brickwall::miniapp {

Device describeDevice() {
  Device device;
#if defined(KOKKOS_ENABLE_CUDA)
  if constexpr (std::is_same<exec_space, Kokkos::Cuda>::value) {
    int number = 0, runtime = 0, driver = 0;
    cudaDeviceProp properties;
    std::size_t free = 0, bytes = 0;
    if (cudaGetDevice(&number) != cudaSuccess ||
        cudaGetDeviceProperties(&properties, number) != cudaSuccess)
      return device;
    device.name = properties.name;
    if (cudaMemGetInfo(&free, &bytes) != cudaSuccess ||
        cudaRuntimeGetVersion(&runtime) != cudaSuccess ||
        cudaDriverGetVersion(&driver) != cudaSuccess)
      return device;
    const auto text = [](int version) { // 13010 is 13.1
      return std::to_string(version / 1000) + "." + std::to_string(version % 1000 / 10);
    };
    device.versions = "CUDA " + text(runtime) + ", driver for CUDA " + text(driver);
    device.bytes = static_cast<std::int64_t>(bytes);
    device.bytes_in_use = static_cast<std::int64_t>(bytes - free);
  }
#endif
  return device;
}

} // namespace brickwall::miniapp
