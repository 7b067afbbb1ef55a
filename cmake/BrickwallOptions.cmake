# Options of the build and the flags that follow from them.
include(CheckCXXSourceCompiles)
include(CTest) # defines BUILD_TESTING

option(BRICKWALL_NATIVE "Build our own targets for this machine's processor (-march=native)" ON)
set(BRICKWALL_SIMD_WIDTH "auto" CACHE STRING
    "Elements and nodes that a thread of a processor takes at once, in SIMD lanes: auto, 8, 4, 2, or 1 (one by one as devices do)")
option(BRICKWALL_WERROR "Treat warnings in our own code as errors" OFF)
option(BRICKWALL_ADIAK "Give the figures of a run to Adiak, whose metadata Caliper records" OFF)
set(BRICKWALL_EXECUTION_SPACE "" CACHE STRING "Kokkos execution space, e.g. Serial, OpenMP, Cuda (default: Kokkos' own)")
set(BRICKWALL_SANITIZE "" CACHE STRING "Sanitizers for our own targets, e.g. address,undefined")

if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif()
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
# The compiler sees eight sources of a target at once, and instantiates Kokkos' templates once for them.
if(NOT DEFINED CMAKE_UNITY_BUILD)
  set(CMAKE_UNITY_BUILD ON)
endif()

# Usage requirements that every target of ours shares, and nobody else's.
add_library(brickwall_flags INTERFACE)
# Conditions are joined without branches on purpose, which Clang reports from version 14. No compiled interface passes packs:
# how vectors that are wider than a register are passed (psabi) does not matter.
target_compile_options(brickwall_flags INTERFACE -Wall -Wextra -Wno-psabi
  $<$<AND:$<CXX_COMPILER_ID:Clang>,$<VERSION_GREATER_EQUAL:$<CXX_COMPILER_VERSION>,14>>:-Wno-bitwise-instead-of-logical>)
# Roots of negative numbers set no errno: then roots are taken in lanes.
target_compile_options(brickwall_flags INTERFACE $<$<COMPILE_LANG_AND_ID:CXX,GNU,Clang>:-fno-math-errno>)
if(BRICKWALL_WERROR)
  target_compile_options(brickwall_flags INTERFACE -Werror)
endif()
if(BRICKWALL_NATIVE)
  target_compile_options(brickwall_flags INTERFACE -march=native)
endif()

# As many lanes as doubles fit the registers of the processor.
if(BRICKWALL_SIMD_WIDTH STREQUAL "auto")
  if(BRICKWALL_NATIVE)
    set(CMAKE_REQUIRED_FLAGS -march=native)
  endif()
  foreach(instruction_set IN ITEMS AVX AVX512F)
    check_cxx_source_compiles("
      #ifndef __${instruction_set}__
      #error
      #endif
      int main() {}" BRICKWALL_HAS_${instruction_set}_NATIVE_${BRICKWALL_NATIVE})
  endforeach()
  unset(CMAKE_REQUIRED_FLAGS)
  if(BRICKWALL_HAS_AVX512F_NATIVE_${BRICKWALL_NATIVE})
    set(brickwall_simd_width 8)
  elseif(BRICKWALL_HAS_AVX_NATIVE_${BRICKWALL_NATIVE})
    set(brickwall_simd_width 4)
  else()
    set(brickwall_simd_width 2)
  endif()
elseif(BRICKWALL_SIMD_WIDTH MATCHES "^[1248]$")
  set(brickwall_simd_width ${BRICKWALL_SIMD_WIDTH})
else()
  message(FATAL_ERROR "BRICKWALL_SIMD_WIDTH is \"${BRICKWALL_SIMD_WIDTH}\"; expected auto, 8, 4, 2 or 1")
endif()
if(BRICKWALL_SANITIZE)
  target_compile_options(brickwall_flags INTERFACE -fsanitize=${BRICKWALL_SANITIZE}
                                                   -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(brickwall_flags INTERFACE -fsanitize=${BRICKWALL_SANITIZE})
endif()
