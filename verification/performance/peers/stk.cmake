# Defines the target brickwall_stk_search from the libraries of the prefix STK_ROOT. Its package
# file is not used: it would define the targets of a second Kokkos.
set(STK_ROOT "" CACHE PATH "Prefix of STKSearch, as cmake/build_stk.sh prints it")
find_path(STK_INCLUDE_DIR stk_search/CoarseSearch.hpp HINTS ${STK_ROOT} PATH_SUFFIXES include)
set(_stk_libraries)
foreach(_name IN ITEMS stk_search stk_util_env stk_util_diag stk_util_registry stk_util_parallel stk_util_util)
  find_library(STK_LIBRARY_${_name} ${_name} HINTS ${STK_ROOT} PATH_SUFFIXES lib)
  list(APPEND _stk_libraries ${STK_LIBRARY_${_name}})
endforeach()
if(NOT STK_INCLUDE_DIR OR _stk_libraries MATCHES "NOTFOUND")
  message(FATAL_ERROR "BRICKWALL_PEER_STK: no STKSearch in STK_ROOT=\"${STK_ROOT}\"; -DSTK_ROOT=$(cmake/build_stk.sh) builds it.")
endif()
# One program can hold one Kokkos only.
file(GLOB _stk_kokkos_versions ${STK_INCLUDE_DIR}/../lib/cmake/Kokkos/KokkosConfigVersion.cmake)
if(_stk_kokkos_versions)
  file(STRINGS ${_stk_kokkos_versions} _stk_kokkos_version REGEX "PACKAGE_VERSION \"")
  if(NOT _stk_kokkos_version MATCHES "\"${Kokkos_VERSION}\"")
    message(FATAL_ERROR "BRICKWALL_PEER_STK: STKSearch was built with another Kokkos than ${Kokkos_VERSION}: "
                        "use the one of cmake/build_trilinos.sh.")
  endif()
endif()

add_library(brickwall_stk_search INTERFACE)
target_include_directories(brickwall_stk_search SYSTEM INTERFACE ${STK_INCLUDE_DIR})
target_link_libraries(brickwall_stk_search INTERFACE ${_stk_libraries})
