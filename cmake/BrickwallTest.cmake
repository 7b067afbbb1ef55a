# brickwall_add_test(NAME SOURCES... LIBRARIES ... RANKS 1 2 ... THREADS n): one GoogleTest executable, and
# one ctest entry for each rank count. RANKS defaults to 1; the tests are named NAME.npN.
function(brickwall_add_test name)
  cmake_parse_arguments(arg "" "THREADS;TIMEOUT" "SOURCES;LIBRARIES;RANKS;LABELS" ${ARGN})
  if(NOT arg_RANKS)
    set(arg_RANKS 1)
  endif()
  if(NOT arg_THREADS)
    set(arg_THREADS 1)
  endif()
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 300)
  endif()
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE ${arg_LIBRARIES} brickwall_test_main brickwall_flags)
  foreach(ranks IN LISTS arg_RANKS)
    set(test ${name}.np${ranks})
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
    "OMP_WAIT_POLICY=passive"
    "OMP_PROC_BIND=false"
    "ASAN_OPTIONS=detect_leaks=0")
