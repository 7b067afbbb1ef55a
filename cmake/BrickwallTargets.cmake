# brickwall_add_library(NAME SOURCES... PUBLIC libs... PRIVATE libs...): a library brickwall_NAME with the alias
# brickwall::NAME, our flags, headers included from the source root, installed under include/brickwall.
include(GNUInstallDirs)

function(brickwall_add_library name)
  cmake_parse_arguments(arg "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  set(target brickwall_${name})
  add_library(${target} ${arg_SOURCES})
  add_library(brickwall::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  target_include_directories(
    ${target} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/brickwall>)
  target_link_libraries(
    ${target}
    PUBLIC brickwall::base ${arg_PUBLIC}
    PRIVATE ${arg_PRIVATE} $<BUILD_INTERFACE:brickwall_flags>)
endfunction()
