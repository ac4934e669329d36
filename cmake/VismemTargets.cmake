# Declarations of all libraries, programs and tests of the project.
include(GNUInstallDirs)
find_package(Threads REQUIRED)
find_package(GTest REQUIRED)
find_package(benchmark REQUIRED)

# Folder of the installed headers, from which all of them are included.
set(VISMEM_HEADERS ${CMAKE_INSTALL_INCLUDEDIR}/vismem)

# vismem_library(NAME SOURCES file... [PUBLIC lib...] [PRIVATE lib...])
# Headers are included from the folder components/: "common/geometry/pose.h".
function(vismem_library name)
  cmake_parse_arguments(A "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  add_library(${name} STATIC ${A_SOURCES})
  target_include_directories(${name} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/components>
                                            $<INSTALL_INTERFACE:${VISMEM_HEADERS}>)
  target_link_libraries(${name} PUBLIC ${A_PUBLIC} PRIVATE ${A_PRIVATE} $<BUILD_INTERFACE:project_warnings>)
  set_target_properties(${name} PROPERTIES UNITY_BUILD ${VISMEM_UNITY} UNITY_BUILD_BATCH_SIZE 8)
endfunction()

# vismem_driver(NAME SOURCES file... [PUBLIC lib...] [PRIVATE lib...])
# As vismem_library; headers are included from the project's root: "drivers/camera_files/file_camera.h".
function(vismem_driver name)
  vismem_library(${name} ${ARGN})
  target_include_directories(${name} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>)
endfunction()

# Target vismem_installed: everything that `cmake --install` copies.
add_custom_target(vismem_installed)

# vismem_program(NAME [INSTALL components|tools|gui|gateway] SOURCES file... LIBRARIES lib...)
# INSTALL names the part of an installation that it belongs to (cmake/Install.cmake); without it it stays in the build.
function(vismem_program name)
  cmake_parse_arguments(A "" "INSTALL" "SOURCES;LIBRARIES" ${ARGN})
  add_executable(${name} ${A_SOURCES})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR}/components)
  target_link_libraries(${name} PRIVATE ${A_LIBRARIES} project_warnings)
  if(A_INSTALL)
    install(TARGETS ${name} RUNTIME DESTINATION ${CMAKE_INSTALL_LIBEXECDIR}/vismem COMPONENT ${A_INSTALL})
    add_dependencies(vismem_installed ${name})
  endif()
endfunction()

# "support/build_paths.h" is generated; the rest of test/ is included as it lies there.
configure_file(${PROJECT_SOURCE_DIR}/test/support/build_paths.h.in ${CMAKE_BINARY_DIR}/test_paths/support/build_paths.h @ONLY)
set(VISMEM_TEST_INCLUDES ${PROJECT_SOURCE_DIR}/test ${CMAKE_BINARY_DIR}/test_paths)

# Target tests_LABEL: the tests of one label with their dependencies only.
set(VISMEM_TEST_LABELS unit property golden contract component system faults hwkernel browser deploy fleet network)
foreach(label IN LISTS VISMEM_TEST_LABELS)
  add_custom_target(tests_${label})
endforeach()

# Options of the sanitizers in every test.
set(sanitizer_options
  "TSAN_OPTIONS=ignore_noninstrumented_modules=1 suppressions=${PROJECT_SOURCE_DIR}/cmake/tsan.supp"
  "UBSAN_OPTIONS=print_stacktrace=1")

# vismem_test(NAME LABEL unit|property|golden|contract|component|system|faults|hwkernel|browser SOURCES file... LIBRARIES lib...
#             [TIMEOUT seconds] [PROGRAMS target...] [EMULATED_DEVICES] [SHARDS n])
# One CTest entry per test program. TIMEOUT (default 120) detects a hang, also on a busy machine. PROGRAMS are built first: tests
# that start real processes name them.
# EMULATED_DEVICES: it runs under umockdev, which replaces the machine's devices by its own.
# SHARDS: number of parallel processes for its tests, for tests that wait most of the time.
# Tests that need test/data, cfg/ or the programs include "support/build_paths.h".
function(vismem_test name)
  cmake_parse_arguments(A "EMULATED_DEVICES" "LABEL;TIMEOUT;SHARDS" "SOURCES;LIBRARIES;PROGRAMS" ${ARGN})
  # umockdev replaces calls of the C library, which an emulator of another processor makes for itself.
  if(A_EMULATED_DEVICES AND CMAKE_CROSSCOMPILING)
    return()
  endif()
  add_executable(${name} ${A_SOURCES})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR}/components ${VISMEM_TEST_INCLUDES})
  target_link_libraries(${name} PRIVATE ${A_LIBRARIES} GTest::gmock GTest::gtest GTest::gtest_main project_warnings)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/test)
  if(A_PROGRAMS)
    add_dependencies(${name} ${A_PROGRAMS})
  endif()
  if(NOT A_LABEL IN_LIST VISMEM_TEST_LABELS)
    message(FATAL_ERROR "${name}: LABEL ${A_LABEL} (must be one of ${VISMEM_TEST_LABELS})")
  endif()
  add_dependencies(tests_${A_LABEL} ${name})
  if(NOT A_TIMEOUT)
    set(A_TIMEOUT 120)
  endif()
  if(VISMEM_SANITIZE)
    math(EXPR A_TIMEOUT "5 * ${A_TIMEOUT}")
  endif()
  if(CMAKE_CROSSCOMPILING)
    math(EXPR A_TIMEOUT "15 * ${A_TIMEOUT}")  # an emulated processor is as much slower
  endif()
  # The paths in cfg/ are relative to the project, where components are started.
  set(wrapper ${CMAKE_CROSSCOMPILING_EMULATOR})
  if(A_EMULATED_DEVICES)
    find_program(VISMEM_UMOCKDEV umockdev-wrapper REQUIRED)
    set(wrapper ${VISMEM_UMOCKDEV})
  endif()
  if(A_SHARDS)
    set(wrapper ${PROJECT_SOURCE_DIR}/test/support/run_shards ${A_SHARDS} ${wrapper})
  endif()
  add_test(NAME ${name} COMMAND ${wrapper} $<TARGET_FILE:${name}> WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
  set_tests_properties(${name} PROPERTIES LABELS "${A_LABEL}" TIMEOUT ${A_TIMEOUT}
                       ENVIRONMENT "${sanitizer_options}")
  if(A_EMULATED_DEVICES)
    # umockdev's library is loaded before the runtime of the address sanitizer, which is harmless.
    set_property(TEST ${name} APPEND PROPERTY ENVIRONMENT "ASAN_OPTIONS=verify_asan_link_order=0")
  endif()
endfunction()

# vismem_benchmark(NAME SOURCES file... LIBRARIES lib... [PROGRAMS target...])
# The program behind `scripts/bench NAME`: build/PRESET/bench/NAME. It has its own main, so that it can print
# tables beside what Google Benchmark prints.
function(vismem_benchmark name)
  cmake_parse_arguments(A "" "" "SOURCES;LIBRARIES;PROGRAMS" ${ARGN})
  set(target bench_${name})
  add_executable(${target} ${A_SOURCES})
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR}/components ${VISMEM_TEST_INCLUDES})
  target_link_libraries(${target} PRIVATE ${A_LIBRARIES} benchmark::benchmark project_warnings)
  set_target_properties(${target} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bench OUTPUT_NAME ${name})
  if(A_PROGRAMS)
    add_dependencies(${target} ${A_PROGRAMS})
  endif()
endfunction()

# vismem_fuzzer(NAME SOURCES file... LIBRARIES lib...)
# A libFuzzer target (its sources define LLVMFuzzerTestOneInput). Under the preset `fuzz` it is the program
# behind `scripts/fuzz NAME`; in every other build it is a unit test that runs the target over its seeds,
# test/fuzz/seeds/NAME/, as a regression test of earlier crashes.
function(vismem_fuzzer name)
  cmake_parse_arguments(A "" "" "SOURCES;LIBRARIES" ${ARGN})
  set(target fuzz_${name})
  if(VISMEM_FUZZ)
    add_executable(${target} ${A_SOURCES})
    target_link_options(${target} PRIVATE -fsanitize=fuzzer)
    set_target_properties(${target} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/fuzz OUTPUT_NAME ${name})
  else()
    add_executable(${target} ${A_SOURCES} ${PROJECT_SOURCE_DIR}/test/fuzz/run_seeds.cpp)
    set_target_properties(${target} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/test)
    add_dependencies(tests_unit ${target})
    add_test(NAME ${target} COMMAND ${target} ${PROJECT_SOURCE_DIR}/test/fuzz/seeds/${name}
             WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
    set_tests_properties(${target} PROPERTIES LABELS unit TIMEOUT 300 ENVIRONMENT "${sanitizer_options}")
  endif()
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR}/components ${VISMEM_TEST_INCLUDES})
  target_link_libraries(${target} PRIVATE ${A_LIBRARIES} project_warnings)
endfunction()
