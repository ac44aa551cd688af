# SPDX-License-Identifier: BSD-3-Clause
# One static library a stage, one executable a command, one test program a stage.
# Every target gets the same language level, warnings and sanitizers.

add_library(lfm_flags INTERFACE)
target_compile_features(lfm_flags INTERFACE cxx_std_20)
target_compile_options(lfm_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow
                                           -Wnon-virtual-dtor -fno-math-errno -ffp-contract=off)
# GCC 12 warns of overlapping copies in plain string concatenation (its bug 105651).
target_compile_options(lfm_flags INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)
if(LFM_WARNINGS_AS_ERRORS)
  target_compile_options(lfm_flags INTERFACE -Werror)
endif()
if(LFM_SANITIZE)
  target_compile_options(lfm_flags INTERFACE -fsanitize=${LFM_SANITIZE} -fno-omit-frame-pointer
                                             -fno-sanitize-recover=undefined)
  target_link_options(lfm_flags INTERFACE -fsanitize=${LFM_SANITIZE})
endif()
target_compile_definitions(lfm_flags INTERFACE LFM_VERSION="${PROJECT_VERSION}")

# lfm_stage(NAME SOURCES a.cpp ... PUBLIC_HEADERS a.h ... LINK target ... PRIVATE_LINK target ...)
# PUBLIC_HEADERS are what a stage to the right may include; tests/house reads them from here.
function(lfm_stage name)
  cmake_parse_arguments(ARG "" "" "SOURCES;PUBLIC_HEADERS;LINK;PRIVATE_LINK" ${ARGN})
  add_library(lfm_${name} STATIC ${ARG_SOURCES})
  target_sources(lfm_${name} PUBLIC FILE_SET public_headers TYPE HEADERS
                 BASE_DIRS ${PROJECT_SOURCE_DIR} FILES ${ARG_PUBLIC_HEADERS})
  target_include_directories(lfm_${name} PUBLIC ${PROJECT_SOURCE_DIR})
  target_link_libraries(lfm_${name} PUBLIC lfm_flags ${ARG_LINK} PRIVATE ${ARG_PRIVATE_LINK})
endfunction()

add_custom_target(commands COMMENT "Every command of lfm")

# lfm_command(NAME lfm-name SOURCES main.cpp LINK lfm_stage ...)
function(lfm_command name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE lfm_flags ${ARG_LINK})
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)
  add_dependencies(commands ${name})
endfunction()

# lfm_tests(stage SOURCES a_test.cpp ... LINK lfm_stage ...)
function(lfm_tests name)
  cmake_parse_arguments(ARG "" "TIMEOUT" "SOURCES;LINK" ${ARGN})
  find_package(GTest REQUIRED)
  include(GoogleTest)
  add_executable(${name}_tests ${ARG_SOURCES})
  target_link_libraries(${name}_tests PRIVATE lfm_flags ${ARG_LINK} GTest::gtest_main)
  target_compile_definitions(${name}_tests PRIVATE LFM_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
                                                   LFM_BIN_DIR="${PROJECT_BINARY_DIR}/bin")
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 300)
  endif()
  gtest_discover_tests(${name}_tests TEST_PREFIX ${name}. DISCOVERY_TIMEOUT 60
                       PROPERTIES TIMEOUT ${ARG_TIMEOUT})
endfunction()
