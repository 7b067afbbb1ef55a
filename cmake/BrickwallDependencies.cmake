# Third-party libraries, each as one imported target. Kokkos, Zoltan and Exodus come from the Trilinos that
# cmake/build_trilinos.sh caches, or from wherever CMAKE_PREFIX_PATH and <Package>_ROOT point.
find_package(MPI REQUIRED COMPONENTS C CXX)
find_package(Kokkos 3.4 REQUIRED CONFIG)
if("CUDA" IN_LIST Kokkos_DEVICES)
  set(CMAKE_DISABLE_PRECOMPILE_HEADERS ON) # nvcc has none
  # nvcc leaves typedefs of its own in lambdas.
  target_compile_options(brickwall_flags INTERFACE -Wno-unused-local-typedefs)
endif()
find_package(Threads REQUIRED)
if(BRICKWALL_EXECUTION_SPACE)
  string(TOUPPER "${BRICKWALL_EXECUTION_SPACE}" _space)
  if(NOT _space IN_LIST Kokkos_DEVICES)
    message(FATAL_ERROR "The Kokkos in ${Kokkos_DIR} has no ${BRICKWALL_EXECUTION_SPACE} (it has: ${Kokkos_DEVICES}). "
                        "Point Kokkos_ROOT or CMAKE_PREFIX_PATH at one that has.")
  endif()
endif()

# Zoltan: Trilinos' package (target zoltan, Zoltan::zoltan in newer releases).
find_package(Zoltan REQUIRED CONFIG)
add_library(brickwall_zoltan INTERFACE)
if(TARGET Zoltan::zoltan)
  target_link_libraries(brickwall_zoltan INTERFACE Zoltan::zoltan MPI::MPI_C)
else()
  target_link_libraries(brickwall_zoltan INTERFACE ${Zoltan_LIBRARIES} MPI::MPI_C)
  target_include_directories(brickwall_zoltan SYSTEM INTERFACE ${Zoltan_INCLUDE_DIRS})
endif()

# Exodus: SEACAS' package (target exodus, SEACASExodus::exodus in newer releases).
find_package(SEACASExodus REQUIRED CONFIG)
add_library(brickwall_exodus INTERFACE)
if(TARGET SEACASExodus::exodus)
  target_link_libraries(brickwall_exodus INTERFACE SEACASExodus::exodus)
else()
  target_link_libraries(brickwall_exodus INTERFACE ${SEACASExodus_LIBRARIES})
  target_include_directories(brickwall_exodus SYSTEM INTERFACE ${SEACASExodus_INCLUDE_DIRS})
endif()

# epu and exodiff stand beside the Exodus library's prefix; the scripts and the tests call them.
get_filename_component(_seacas_prefix "${SEACASExodus_DIR}/../../.." ABSOLUTE)
find_program(BRICKWALL_EPU epu HINTS "${_seacas_prefix}/bin")
find_program(BRICKWALL_EXODIFF exodiff HINTS "${_seacas_prefix}/bin")

find_package(toml11 REQUIRED CONFIG)
find_package(CLI11 REQUIRED CONFIG)
find_package(nlohmann_json REQUIRED CONFIG)
if(BRICKWALL_ADIAK)
  find_package(adiak REQUIRED CONFIG)
endif()
