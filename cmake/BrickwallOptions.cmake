# Options of the build and the flags that follow from them.
include(CTest) # defines BUILD_TESTING

option(BRICKWALL_NATIVE "Build our own targets for this machine's processor (-march=native)" ON)
option(BRICKWALL_LANES "On processors, take elements and nodes at once in SIMD lanes; OFF: one by one as devices do, for tests" ON)
option(BRICKWALL_WERROR "Treat warnings in our own code as errors" OFF)
option(BRICKWALL_ADIAK "Give the figures of a run to Adiak, whose metadata Caliper records" OFF)
set(BRICKWALL_EXECUTION_SPACE "" CACHE STRING "Kokkos execution space, e.g. Serial, OpenMP, Cuda (default: Kokkos' own)")
set(BRICKWALL_SANITIZE "" CACHE STRING "Sanitizers for our own targets, e.g. address,undefined")

if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif()
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)

# Usage requirements that every target of ours shares, and nobody else's.
add_library(brickwall_flags INTERFACE)
# Conditions are joined without branches on purpose, which Clang reports from version 14.
# Packs are eight lanes wide on every processor, and no compiled interface passes them: how vectors that
# are wider than its registers are passed between object files does not matter.
target_compile_options(brickwall_flags INTERFACE -Wall -Wextra -Wno-psabi
  $<$<AND:$<CXX_COMPILER_ID:Clang>,$<VERSION_GREATER_EQUAL:$<CXX_COMPILER_VERSION>,14>>:-Wno-bitwise-instead-of-logical>)
if(BRICKWALL_WERROR)
  target_compile_options(brickwall_flags INTERFACE -Werror)
endif()
if(BRICKWALL_NATIVE)
  target_compile_options(brickwall_flags INTERFACE -march=native)
endif()
if(BRICKWALL_SANITIZE)
  target_compile_options(brickwall_flags INTERFACE -fsanitize=${BRICKWALL_SANITIZE}
                                                   -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(brickwall_flags INTERFACE -fsanitize=${BRICKWALL_SANITIZE})
endif()
