# Installs the components base and contact into a folder of the build, and builds and runs the consumer against them with
# nothing but Kokkos and MPI in sight.
set(test_dir ${PROJECT_BINARY_DIR}/tests/consumer)
set(prefix ${test_dir}/install)
set(environment ${BRICKWALL_TEST_ENVIRONMENT} OMP_NUM_THREADS=1)
set(sanitize "")
if(BRICKWALL_SANITIZE)
  set(sanitize -fsanitize=${BRICKWALL_SANITIZE})
endif()

# The program of the page: what stands between its fences.
file(READ ${PROJECT_SOURCE_DIR}/contact/README.md page)
string(REGEX MATCH "```cpp\n(.*)\n```" program "${page}")
if(NOT CMAKE_MATCH_1)
  message(FATAL_ERROR "contact/README.md has no program between ```cpp and ```")
endif()
file(CONFIGURE OUTPUT ${test_dir}/consumer.cpp CONTENT "${CMAKE_MATCH_1}\n" @ONLY)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/contact/README.md)

add_test(NAME consumer.install_base COMMAND ${CMAKE_COMMAND} --install ${PROJECT_BINARY_DIR} --prefix ${prefix}
                                            --component base)
add_test(NAME consumer.install_contact COMMAND ${CMAKE_COMMAND} --install ${PROJECT_BINARY_DIR} --prefix ${prefix}
                                               --component contact)
add_test(
  NAME consumer.build_and_run
  COMMAND
    ${CMAKE_CTEST_COMMAND} --build-and-test ${CMAKE_CURRENT_LIST_DIR} ${test_dir}/build #
    --build-generator ${CMAKE_GENERATOR} --build-options
    -DCMAKE_BUILD_TYPE=${CMAKE_BUILD_TYPE} -DCMAKE_CXX_COMPILER=${CMAKE_CXX_COMPILER}
    -DBrickwall_DIR=${prefix}/${CMAKE_INSTALL_LIBDIR}/cmake/Brickwall -DKokkos_DIR=${Kokkos_DIR}
    -DCONSUMER_SOURCE=${test_dir}/consumer.cpp
    -DCMAKE_DISABLE_FIND_PACKAGE_Zoltan=ON -DCMAKE_DISABLE_FIND_PACKAGE_SEACASExodus=ON
    -DCMAKE_EXE_LINKER_FLAGS=${sanitize} #
    --test-command ${CMAKE_CTEST_COMMAND} --output-on-failure)
set_tests_properties(consumer.install_base consumer.install_contact PROPERTIES FIXTURES_SETUP consumer_install)
set_tests_properties(
  consumer.build_and_run
  PROPERTIES FIXTURES_REQUIRED consumer_install ENVIRONMENT "${environment}" FAIL_REGULAR_EXPRESSION "CMake Warning (at|\\(dev)")
