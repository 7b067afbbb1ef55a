# Installs the program, the libraries with their headers, and the package file that find_package(Brickwall) reads. Each
# library is a component of its own (cmake --install build --component contact installs base and contact alone), so
# that who wants the contact search needs Kokkos and MPI only.
include(CMakePackageConfigHelpers)

set(_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/Brickwall)

# brickwall_install_component(NAME DIRECTORY dir TARGETS targets...): headers of a folder, its targets, and the file
# Brickwall-NAME.cmake that defines the targets as brickwall::... .
function(brickwall_install_component name)
  cmake_parse_arguments(arg "" "DIRECTORY" "TARGETS" ${ARGN})
  install(
    TARGETS ${arg_TARGETS}
    EXPORT Brickwall-${name}
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT ${name}
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT ${name})
  install(EXPORT Brickwall-${name} NAMESPACE brickwall:: DESTINATION ${_package_dir} COMPONENT ${name})
  install(
    DIRECTORY ${PROJECT_SOURCE_DIR}/${arg_DIRECTORY}/
    DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/brickwall/${arg_DIRECTORY}
    COMPONENT ${name}
    FILES_MATCHING
    PATTERN "*.hpp")
endfunction()

brickwall_install_component(base DIRECTORY contact/base TARGETS brickwall_base)
brickwall_install_component(contact DIRECTORY contact TARGETS brickwall_contact)
brickwall_install_component(mechanics DIRECTORY mechanics TARGETS brickwall_mechanics)
brickwall_install_component(io DIRECTORY io TARGETS brickwall_io brickwall_zoltan brickwall_exodus)
install(TARGETS brickwall RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT program)

configure_package_config_file(
  ${CMAKE_CURRENT_LIST_DIR}/BrickwallConfig.cmake.in ${PROJECT_BINARY_DIR}/BrickwallConfig.cmake
  INSTALL_DESTINATION ${_package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/BrickwallConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(
  FILES ${PROJECT_BINARY_DIR}/BrickwallConfig.cmake ${PROJECT_BINARY_DIR}/BrickwallConfigVersion.cmake
  DESTINATION ${_package_dir}
  COMPONENT base)
