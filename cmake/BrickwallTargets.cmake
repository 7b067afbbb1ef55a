# brickwall_add_library(NAME SOURCES... PUBLIC libs... PRIVATE libs...): a library brickwall_NAME with the alias
# brickwall::NAME, our flags, headers included from the source root, installed under include/brickwall.
include(GNUInstallDirs)

# Include path of the installed targets: the public headers, and those that they are made of.
set(BRICKWALL_INSTALL_INCLUDES $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/brickwall>
                               $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/brickwall/detail>)

# brickwall_precompile(TARGET headers...): Kokkos and MPI, which almost every unit includes, are compiled once for a target.
function(brickwall_precompile target)
  target_precompile_headers(${target} PRIVATE <Kokkos_Core.hpp> <mpi.h> <functional> <string> <vector> ${ARGN})
endfunction()

# brickwall_compile_fast(SOURCES...): units that wrap a header-only parser. Nothing in them runs in a time step, so they are
# compiled with little optimisation, which takes a third of the time.
function(brickwall_compile_fast)
  set_source_files_properties(${ARGN} PROPERTIES COMPILE_OPTIONS "-O1" SKIP_PRECOMPILE_HEADERS ON)
endfunction()

function(brickwall_add_library name)
  cmake_parse_arguments(arg "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  set(target brickwall_${name})
  add_library(${target} ${arg_SOURCES})
  add_library(brickwall::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  target_include_directories(
    ${target} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> ${BRICKWALL_INSTALL_INCLUDES})
  target_link_libraries(
    ${target}
    PUBLIC brickwall::base ${arg_PUBLIC}
    PRIVATE ${arg_PRIVATE} $<BUILD_INTERFACE:brickwall_flags>)
  brickwall_precompile(${target})
endfunction()
