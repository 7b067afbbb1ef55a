# Options of the build and the flags that follow from them.
include(CTest) # defines BUILD_TESTING

option(BRICKWALL_NATIVE "Build our own targets for this machine's processor (-march=native)" ON)
option(BRICKWALL_WERROR "Treat warnings in our own code as errors" OFF)
set(BRICKWALL_EXECUTION_SPACE "" CACHE STRING "Kokkos execution space, e.g. Serial, OpenMP, Cuda (default: Kokkos' own)")
set(BRICKWALL_SANITIZE "" CACHE STRING "Sanitizers for our own targets, e.g. address,undefined")

if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif()
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)

# Usage requirements that every target of ours shares, and nobody else's.
add_library(brickwall_flags INTERFACE)
# -ffp-contract=on contracts a*b+c within one expression only, as the source spells it: the element
# arithmetic is then the same in every kernel that calls the same function. g++ 12 takes
# "on" as "off"; clang and nvcc honour it.
target_compile_options(brickwall_flags INTERFACE -Wall -Wextra -ffp-contract=on)
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
