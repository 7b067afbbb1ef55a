# Builds the tests with a label and what they need: cmake --build build --target unit_tests. Label "quick": unit tests that
# continuous integration runs under sanitizers (.ci/run).
add_custom_target(unit_tests)
add_custom_target(quick_tests)
# Tests reuse the precompiled headers of a library: it must be compiled as executables are.
set(CMAKE_POSITION_INDEPENDENT_CODE OFF)

# brickwall_add_test(NAME SOURCES... LIBRARIES ... RANKS 1 2 ... THREADS n TIMEOUT s LABELS ...): one GoogleTest executable and
# its ctest entries (brickwall_run_test). The label is "unit" unless another is given.
function(brickwall_add_test name)
  cmake_parse_arguments(arg "" "THREADS;TIMEOUT" "SOURCES;LIBRARIES;RANKS;LABELS" ${ARGN})
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE ${arg_LIBRARIES} brickwall_test_main)
  target_precompile_headers(${name} REUSE_FROM brickwall_test_main)
  if(NOT arg_LABELS)
    set(arg_LABELS unit)
  endif()
  foreach(label IN LISTS arg_LABELS)
    if(TARGET ${label}_tests)
      add_dependencies(${label}_tests ${name})
    endif()
  endforeach()
  brickwall_run_test(
    ${name}
    RANKS ${arg_RANKS}
    THREADS ${arg_THREADS}
    TIMEOUT ${arg_TIMEOUT}
    LABELS ${arg_LABELS})
endfunction()

# brickwall_run_test(NAME RANKS 1 2 ... THREADS n ...): a ctest entry NAME.npN for each rank count of an existing test
# executable, NAME.npN.tM with M > 1 threads. RANKS and THREADS default to 1.
function(brickwall_run_test name)
  cmake_parse_arguments(arg "" "THREADS;TIMEOUT" "RANKS;LABELS" ${ARGN})
  if(NOT arg_RANKS)
    set(arg_RANKS 1)
  endif()
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 300)
  endif()
  if(NOT arg_LABELS)
    set(arg_LABELS unit)
  endif()
  set(suffix "")
  if(arg_THREADS GREATER 1)
    set(suffix .t${arg_THREADS})
  else()
    set(arg_THREADS 1)
  endif()
  foreach(ranks IN LISTS arg_RANKS)
    set(test ${name}.np${ranks}${suffix})
    add_test(NAME ${test} COMMAND ${MPIEXEC_EXECUTABLE} ${MPIEXEC_NUMPROC_FLAG} ${ranks} --oversubscribe
                                  $<TARGET_FILE:${name}>)
    set_tests_properties(
      ${test}
      PROPERTIES ENVIRONMENT "${BRICKWALL_TEST_ENVIRONMENT};OMP_NUM_THREADS=${arg_THREADS}"
                 TIMEOUT ${arg_TIMEOUT} PROCESSORS ${ranks} LABELS "${arg_LABELS}")
  endforeach()
endfunction()

# More ranks than cores, as root, without binding: tests must pass on the smallest machine.
set(BRICKWALL_TEST_ENVIRONMENT
    "OMPI_ALLOW_RUN_AS_ROOT=1"
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1"
    "OMPI_MCA_mpi_yield_when_idle=1"
    "OMPI_MCA_hwloc_base_binding_policy=none"
    "OMPI_MCA_btl_vader_single_copy_mechanism=none"
    # Without a search for networks MPI starts in half the time, and mpiexec does not wait 2 s after a rank that fails.
    "OMPI_MCA_pml=ob1"
    "OMPI_MCA_odls_base_sigkill_timeout=0"
    "OMP_WAIT_POLICY=passive"
    "OMP_PROC_BIND=false"
    # LeakSanitizer may crash on the thread-local storage of a thread that ends, unless it does not follow it.
    "ASAN_OPTIONS=intercept_tls_get_addr=0"
    "LSAN_OPTIONS=leak_check_at_exit=0:print_suppressions=0:suppressions=${PROJECT_SOURCE_DIR}/tests/support/leaks_of_libraries.txt")
