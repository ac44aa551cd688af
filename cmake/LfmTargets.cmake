# SPDX-License-Identifier: BSD-3-Clause
# One static library a stage, one executable a command, one test program a stage.
# Every target gets the same language level, warnings and sanitizers.

add_library(lfm_flags INTERFACE)
target_compile_features(lfm_flags INTERFACE cxx_std_20)
# -pthread: some packages ask for it, and precompiled headers want the same flags everywhere.
target_compile_options(lfm_flags INTERFACE -pthread -Wall -Wextra -Wpedantic -Wshadow
                                           -Wnon-virtual-dtor -fno-math-errno -ffp-contract=off)
# GCC 12 warns of overlapping copies in plain string concatenation (its bug 105651).
target_compile_options(lfm_flags INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)
if(LFM_PRECOMPILED_HEADERS)  # the same bug in other guises, once strings are precompiled
  target_compile_options(lfm_flags INTERFACE
                         $<$<CXX_COMPILER_ID:GNU>:-Wno-stringop-overflow;-Wno-array-bounds>)
endif()
if(LFM_WARNINGS_AS_ERRORS)
  target_compile_options(lfm_flags INTERFACE -Werror)
endif()
if(LFM_SANITIZE)
  # GCC takes what the sanitizers add for reads of uninitialised values.
  target_compile_options(lfm_flags INTERFACE -Wno-maybe-uninitialized)
  # Under the address sanitizer Eigen would lay out aligned memory otherwise than the PCL and Ceres
  # that hand it to us and free what we hand to them.
  target_compile_definitions(lfm_flags INTERFACE EIGEN_MALLOC_ALREADY_ALIGNED=1)
  target_compile_options(lfm_flags INTERFACE -fsanitize=${LFM_SANITIZE} -fno-omit-frame-pointer
                                             -fno-sanitize-recover=undefined)
  target_link_options(lfm_flags INTERFACE -fsanitize=${LFM_SANITIZE})
endif()
if(LFM_FUZZ)  # counts what the fuzz targets reach (tests/fuzz)
  target_compile_options(lfm_flags INTERFACE -fsanitize=fuzzer-no-link)
endif()
target_compile_definitions(lfm_flags INTERFACE LFM_VERSION="${PROJECT_VERSION}")

# What nearly every file includes, parsed once instead of 300 times: a third of a clean build. Files
# must compile without it all the same; the presets debug and tidy build them so.
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(nlohmann_json 3.11 REQUIRED)
find_package(GTest REQUIRED)
add_library(lfm_precompiled OBJECT ${PROJECT_SOURCE_DIR}/cmake/precompiled.cpp)
target_link_libraries(lfm_precompiled PRIVATE lfm_flags Eigen3::Eigen nlohmann_json::nlohmann_json)
set(LFM_COMMON_HEADERS <Eigen/Core> <Eigen/Geometry> <algorithm> <cmath> <filesystem> <functional>
    <map> <memory> <nlohmann/json.hpp> <optional> <span> <string> <vector>)
if(LFM_PRECOMPILED_HEADERS)
  target_precompile_headers(lfm_precompiled PRIVATE ${LFM_COMMON_HEADERS})
endif()

function(lfm_precompile target source)
  if(LFM_PRECOMPILED_HEADERS)
    target_precompile_headers(${target} REUSE_FROM ${source})
  endif()
endfunction()

# lfm_stage(NAME SOURCES a.cpp ... PUBLIC_HEADERS a.h ... LINK target ... PRIVATE_LINK target ...)
# PUBLIC_HEADERS are what a stage to the right may include; tests/house reads them from here.
function(lfm_stage name)
  cmake_parse_arguments(ARG "" "" "SOURCES;PUBLIC_HEADERS;LINK;PRIVATE_LINK" ${ARGN})
  add_library(lfm_${name} STATIC ${ARG_SOURCES})
  target_sources(lfm_${name} PUBLIC FILE_SET public_headers TYPE HEADERS
                 BASE_DIRS ${PROJECT_SOURCE_DIR} FILES ${ARG_PUBLIC_HEADERS})
  target_include_directories(lfm_${name} PUBLIC ${PROJECT_SOURCE_DIR})
  target_link_libraries(lfm_${name} PUBLIC lfm_flags ${ARG_LINK} PRIVATE ${ARG_PRIVATE_LINK})
  lfm_precompile(lfm_${name} lfm_precompiled)
endfunction()

add_custom_target(commands COMMENT "Every command of lfm")

# lfm_command(NAME lfm-name SOURCES main.cpp LINK lfm_stage ...)
function(lfm_command name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE lfm_flags ${ARG_LINK})
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)
  lfm_precompile(${name} lfm_precompiled)
  add_dependencies(commands ${name})
endfunction()

add_library(lfm_precompiled_tests OBJECT ${PROJECT_SOURCE_DIR}/cmake/precompiled.cpp)
target_link_libraries(lfm_precompiled_tests PRIVATE lfm_flags Eigen3::Eigen
                                                    nlohmann_json::nlohmann_json GTest::gtest)
if(LFM_PRECOMPILED_HEADERS)
  target_precompile_headers(lfm_precompiled_tests PRIVATE ${LFM_COMMON_HEADERS} <gtest/gtest.h>)
endif()

# lfm_tests(stage SOURCES a_test.cpp ... LINK lfm_stage ...)
function(lfm_tests name)
  cmake_parse_arguments(ARG "DRIVERS" "TIMEOUT" "SOURCES;LINK" ${ARGN})
  include(GoogleTest)
  add_executable(${name}_tests ${ARG_SOURCES})
  target_link_libraries(${name}_tests PRIVATE lfm_flags ${ARG_LINK} GTest::gtest_main)
  target_compile_definitions(${name}_tests PRIVATE LFM_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
                                                   LFM_BIN_DIR="${PROJECT_BINARY_DIR}/bin")
  lfm_precompile(${name}_tests lfm_precompiled_tests)
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 300)
  endif()
  if(LFM_SANITIZE)
    math(EXPR ARG_TIMEOUT "5 * ${ARG_TIMEOUT}")
  endif()
  # Graphics drivers are unloaded before leaks are looked for: theirs have no name to suppress.
  set(properties)
  if(ARG_DRIVERS)
    set(properties ENVIRONMENT ASAN_OPTIONS=detect_leaks=0)
  endif()
  gtest_discover_tests(${name}_tests TEST_PREFIX ${name}. DISCOVERY_TIMEOUT 60
                       PROPERTIES TIMEOUT ${ARG_TIMEOUT} ${properties})
endfunction()
