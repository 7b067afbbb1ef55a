# Installs the program, the libraries with their headers, and the package file that find_package(Brickwall) reads. Each
# library is a component of its own: `cmake --install build --component contact`, after the same of base, installs the
# contact library, which needs Kokkos and MPI only.
include(CMakePackageConfigHelpers)

set(_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/Brickwall)

# brickwall_install_component(NAME FOLDER dir TARGETS targets... PUBLIC headers or folders...): installs targets, as
# brickwall::... in the file Brickwall-NAME.cmake, and the headers of a folder. Public ones go to include/brickwall/, those
# that they are made of to include/brickwall/detail/; hosts include the former only. EXCEPT names a folder of another
# component.
function(brickwall_install_component name)
  cmake_parse_arguments(arg "" "FOLDER;EXCEPT" "TARGETS;PUBLIC" ${ARGN})
  install(
    TARGETS ${arg_TARGETS}
    EXPORT Brickwall-${name}
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT ${name}
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT ${name})
  install(EXPORT Brickwall-${name} NAMESPACE brickwall:: DESTINATION ${_package_dir} COMPONENT ${name})
  foreach(public IN LISTS arg_PUBLIC)
    if(NOT EXISTS ${PROJECT_SOURCE_DIR}/${public})
      message(FATAL_ERROR "brickwall_install_component: there is no ${public}")
    endif()
  endforeach()
  file(GLOB_RECURSE headers CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/${arg_FOLDER}/*.hpp)
  foreach(header IN LISTS headers)
    cmake_path(GET header PARENT_PATH folder)
    if(arg_EXCEPT AND folder STREQUAL arg_EXCEPT)
      continue()
    endif()
    set(destination ${CMAKE_INSTALL_INCLUDEDIR}/brickwall)
    if(NOT header IN_LIST arg_PUBLIC AND NOT folder IN_LIST arg_PUBLIC)
      string(APPEND destination /detail)
    endif()
    install(FILES ${PROJECT_SOURCE_DIR}/${header} DESTINATION ${destination}/${folder} COMPONENT ${name})
  endforeach()
endfunction()

brickwall_install_component(
  base FOLDER contact/base TARGETS brickwall_base
  PUBLIC contact/base/backend.hpp
         contact/base/box.hpp
         contact/base/error.hpp
         contact/base/mpi.hpp
         contact/base/to_device.hpp
         contact/base/vec3.hpp)
brickwall_install_component(
  contact FOLDER contact EXCEPT contact/base TARGETS brickwall_contact
  PUBLIC contact/contact.hpp
         contact/surface
         contact/search/candidate_search.hpp
         contact/search/global_search.hpp
         contact/search/local_search.hpp
         contact/search/audit
         contact/enforcement/enforcement.hpp
         contact/enforcement/law/enforcement_config.hpp
         contact/enforcement/law/contact_sums.hpp
         contact/enforcement/edge_edge/edge_contact.hpp
         contact/overlap/initial_overlap.hpp)
brickwall_install_component(
  mechanics FOLDER mechanics TARGETS brickwall_mechanics
  PUBLIC mechanics/element/material.hpp
         mechanics/mesh/hex_mesh.hpp
         mechanics/mesh/host_mesh.hpp
         mechanics/mesh/nodal_state.hpp
         mechanics/mesh/body_inertia.hpp
         mechanics/mesh/lumped_mass.hpp
         mechanics/mesh/shared_node_sum.hpp
         mechanics/mesh/skin.hpp
         mechanics/force/internal_force.hpp
         mechanics/loads
         mechanics/ledger/energy.hpp
         mechanics/stability/largest_frequency.hpp
         mechanics/stability/stable_time_step.hpp
         mechanics/step/central_difference.hpp
         mechanics/step/free_bricks/free_bricks.hpp
         mechanics/step/resting_bodies.hpp)
brickwall_install_component(
  io FOLDER io TARGETS brickwall_io brickwall_zoltan brickwall_exodus
  PUBLIC io/deck/deck.hpp
         io/exodus/mesh_reader.hpp
         io/exodus/mesh_writer.hpp
         io/exodus/results_writer.hpp
         io/mesh/mesh_part.hpp
         io/mesh/partition.hpp
         io/wall/wall_generator.hpp)
install(TARGETS brickwall RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
install(PROGRAMS miniapp/plot/brickwall-plot miniapp/study/brickwall-report miniapp/study/brickwall-study
        DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)
install(
  DIRECTORY miniapp/plot/brickwall_plot miniapp/study/brickwall_study
  DESTINATION ${CMAKE_INSTALL_DATADIR}/brickwall
  COMPONENT program
  FILES_MATCHING
  PATTERN "*.py"
  PATTERN __pycache__ EXCLUDE)
install(
  DIRECTORY inputs
  DESTINATION ${CMAKE_INSTALL_DATADIR}/brickwall
  COMPONENT program
  FILES_MATCHING
  PATTERN "*.toml")

configure_package_config_file(
  ${CMAKE_CURRENT_LIST_DIR}/BrickwallConfig.cmake.in ${PROJECT_BINARY_DIR}/BrickwallConfig.cmake
  INSTALL_DESTINATION ${_package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/BrickwallConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(
  FILES ${PROJECT_BINARY_DIR}/BrickwallConfig.cmake ${PROJECT_BINARY_DIR}/BrickwallConfigVersion.cmake
  DESTINATION ${_package_dir}
  COMPONENT base)
