# Installs the libraries with their headers, and the package file that find_package(Brickwall) reads.
include(CMakePackageConfigHelpers)

set(_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/Brickwall)
foreach(folder contact mechanics io)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/${folder} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/brickwall
          FILES_MATCHING PATTERN "*.hpp")
endforeach()
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/BrickwallConfig.cmake.in BrickwallConfig.cmake
                              INSTALL_DESTINATION ${_package_dir})
write_basic_package_version_file(BrickwallConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/BrickwallConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/BrickwallConfigVersion.cmake
        DESTINATION ${_package_dir})
