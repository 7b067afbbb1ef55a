// Allocations that fail beyond a limit. Compiled apart from Kokkos: device compilers do not take
// operators that throw.
#include <cstdint>
#include <cstdlib>
#include <new>

std::size_t largest_allocation = SIZE_MAX; // bytes

// NOLINTBEGIN(misc-new-delete-overloads): those for arrays call these
void* operator new(std::size_t bytes) {
  void* memory = bytes > largest_allocation ? nullptr : std::malloc(bytes);
  if (!memory)
    throw std::bad_alloc();
  return memory;
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
// NOLINTEND(misc-new-delete-overloads)
