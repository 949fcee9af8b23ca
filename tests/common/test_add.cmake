# How tests are added; what they have in common.

set(kernel_pool ${PROJECT_BINARY_DIR}/tests/kernel_pool)
include(${CMAKE_CURRENT_LIST_DIR}/plain_kernels.cmake)

# Seconds of a processor that long tests take, about, when those before them have built kernels: the longest start first,
# so that no long one is left alone at the end. Those that others wait for (test_after) come before all.
set(test_costs
    test_bytes_sample 60 test_device_snap 60 test_failures 55 test_cli_devices 50 test_carry 40 test_device_closed 40
    test_device_closed_snap 35 test_trials 35 test_budget 30 test_host_memory 30 bench 27 test_closed_groups 27
    test_simplified 26 test_device 25 test_again 22 test_install 24 test_memory 20 test_interval_groups 20
    test_device_snap_always_copy 20 test_closed_alone 20 test_lacks 20 test_whole 19 test_cancel 18 test_python 18
    test_selftest 18 bench_tune 17 test_snap 17 test_endings 15 test_whole_always_copy 14 test_curvilinear 14
    test_cli_stream 14 test_drivers 14 test_program_cache 13 test_snap_groups 12 test_grid_pieces 12
    test_float_environment 11 test_hybrid 11 test_quiet 11 test_rusticl 11 test_labels_groups 10 test_on_device 10
    test_device_hybrid 10 test_tool_failures 10 test_ranks 10 test_cli_join 10 test_cli_parts 10 test_cli_far 10)

# test_add(NAME PROGRAM [argument...]): a test that makes no use of OpenCL. The library's own cache is off, so that nothing
# reaches the user's; a test that wants one names its folder. Limits of time are there to end what hangs: they leave room
# for a machine several times slower, or as many times as busy.
function(test_add name)
    add_test(NAME ${name} COMMAND ${ARGN})
    set_tests_properties(${name} PROPERTIES SKIP_RETURN_CODE 77 TIMEOUT 1200
                         ENVIRONMENT_MODIFICATION "TETRACUBES_CACHE_DIR=set:;TEST_PLAIN_KERNELS=set:${plain_kernels}")
    list(FIND test_costs ${name} at)
    if(NOT at EQUAL -1)
        math(EXPR at "${at} + 1")
        list(GET test_costs ${at} seconds)
        set_tests_properties(${name} PROPERTIES COST ${seconds})
    endif()
endfunction()

# The same for one that may, with kernels for one work-item per group optimised, those for groups not: in a cache of
# PoCL's of its own, with the kernels that tests before it built.
function(test_add_optimised name)
    test_add(${name} sh ${PROJECT_SOURCE_DIR}/tests/common/run_with_cache.sh ${kernel_pool} ${kernel_pool}_of_${name} ${ARGN})
    set_tests_properties(${name} PROPERTIES LABELS device)
endfunction()

# The same, without any kernel optimised; tests/long runs it with all of them optimised.
function(test_add_device name)
    test_add_optimised(${name} ${ARGN})
    if(plain_kernels)
        set_property(TEST ${name} APPEND PROPERTY ENVIRONMENT_MODIFICATION POCL_EXTRA_BUILD_FLAGS=set:${plain_kernels})
    endif()
endfunction()

# The same in the long tier.
function(test_add_long name)
    test_add_optimised(${name} ${ARGN} CONFIGURATIONS Long)
    set_tests_properties(${name} PROPERTIES LABELS long TIMEOUT 14400
                         ENVIRONMENT_MODIFICATION TETRACUBES_CACHE_DIR=set:)
endfunction()

# test_add_analysis(NAME PROGRAM [argument...]): the same for what bash tests/analysis runs: sources and kernels under
# tools that look for faults. The long tier can need its fixtures.
function(test_add_analysis name)
    test_add(${name} ${ARGN} CONFIGURATIONS Analysis Long)
    set_tests_properties(${name} PROPERTIES LABELS analysis TIMEOUT 3600)
endfunction()

# test_after(EARLIER NAME...): these need the kernels that EARLIER builds, so they start when it has ended.
function(test_after earlier)
    set_tests_properties(${ARGN} PROPERTIES DEPENDS ${earlier})
endfunction()

# test_program(NAME SOURCE...): links the library
function(test_program name)
    add_executable(${name} ${ARGN})
    target_link_libraries(${name} PRIVATE test_helpers tetracubes m)
endfunction()

# test_preload(NAME): a library that tests preload. LD_PRELOAD is split at blanks and colons, so where the folder of the
# build has any, it is built into one that has none.
function(test_preload name)
    if(NOT CMAKE_CURRENT_BINARY_DIR MATCHES "[ :]")
        return()
    endif()
    if(NOT IS_DIRECTORY "${TETRACUBES_PRELOAD_FOLDER}")
        execute_process(COMMAND mktemp -d /tmp/tetracubes-preload-XXXXXX OUTPUT_VARIABLE folder
                        OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
        set(TETRACUBES_PRELOAD_FOLDER ${folder} CACHE INTERNAL "Of libraries that tests preload")
    endif()
    set_target_properties(${name} PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${TETRACUBES_PRELOAD_FOLDER})
endfunction()
