# How tests are added; what they have in common.

set(kernel_pool ${PROJECT_BINARY_DIR}/tests/kernel_pool)
include(${CMAKE_CURRENT_LIST_DIR}/plain_kernels.cmake)

# test_add(NAME PROGRAM [argument...]): a test that makes no use of OpenCL. The library's own cache is off, so that nothing
# reaches the user's; a test that wants one names its folder. Limits of time are there to end what hangs: they leave room
# for a machine several times slower, or as many times as busy. COST, seconds of a processor about, starts long ones
# first.
function(test_add name)
    add_test(NAME ${name} COMMAND ${ARGN})
    set_tests_properties(${name} PROPERTIES SKIP_RETURN_CODE 77 TIMEOUT 1200
                         ENVIRONMENT_MODIFICATION "TETRACUBES_CACHE_DIR=set:;TEST_PLAIN_KERNELS=set:${plain_kernels}")
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
