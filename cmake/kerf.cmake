# How targets are declared, so that warnings, realtime rules and labels stand in one place.

set(KERF_WARNINGS -Wall -Wextra -Wshadow -Wconversion -Wold-style-cast -Werror)
# Realtime code: no exceptions, no RTTI, no silent float->double, bounded frames.
set(KERF_RT_FLAGS -fno-exceptions -fno-rtti -Wdouble-promotion -Wframe-larger-than=8192)
# Structs of some hundred bytes are cleared and copied in every servo cycle. A string instruction (what GCC takes by default) needs longer to start
# than such a loop to end: a twenty-fifth of the cycle.
include(CheckCXXCompilerFlag)
set(short_loops vector_loop:512:noalign,libcall:-1:noalign)
set(KERF_SHORT_LOOPS -mmemset-strategy=${short_loops} -mmemcpy-strategy=${short_loops})
check_cxx_compiler_flag("${KERF_SHORT_LOOPS}" KERF_HAS_SHORT_LOOPS)
if(KERF_HAS_SHORT_LOOPS AND (CMAKE_CXX_FLAGS MATCHES "-O2" OR CMAKE_BUILD_TYPE MATCHES "Rel"))
  list(APPEND KERF_RT_FLAGS ${KERF_SHORT_LOOPS})
endif()

function(_kerf_common target)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_compile_options(${target} PRIVATE ${KERF_WARNINGS})
  target_include_directories(${target} PUBLIC ${PROJECT_SOURCE_DIR}/src)
  set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON)
endfunction()

# kerf_library(name [RT] SOURCES a.cpp ... [LINK lib ...])
#   RT: reachable from a HAL function on a realtime thread; built by the realtime rules and audited by scripts/check_rt_symbols.sh.
function(kerf_library name)
  cmake_parse_arguments(A "RT" "" "SOURCES;LINK" ${ARGN})
  if(A_SOURCES)
    add_library(${name} STATIC ${A_SOURCES})
    _kerf_common(${name})
    if(A_LINK)
      target_link_libraries(${name} PUBLIC ${A_LINK})
    endif()
    if(A_RT)
      target_compile_options(${name} PRIVATE ${KERF_RT_FLAGS})
      set_property(GLOBAL APPEND PROPERTY KERF_RT_TARGETS ${name})
    endif()
  else()
    add_library(${name} INTERFACE)
    target_compile_features(${name} INTERFACE cxx_std_20)
    target_include_directories(${name} INTERFACE ${PROJECT_SOURCE_DIR}/src)
    if(A_LINK)
      target_link_libraries(${name} INTERFACE ${A_LINK})
    endif()
  endif()
endfunction()

# kerf_program(name SOURCES ... [LINK ...])  -> build/<preset>/bin/name
function(kerf_program name)
  cmake_parse_arguments(A "" "" "SOURCES;LINK" ${ARGN})
  add_executable(${name} ${A_SOURCES})
  _kerf_common(${name})
  target_link_libraries(${name} PRIVATE ${A_LINK})
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
endfunction()

# kerf_script(name FILE)  -> build/<preset>/bin/name
function(kerf_script name file)
  configure_file(${file} ${CMAKE_BINARY_DIR}/bin/${name} COPYONLY)
endfunction()

# kerf_component(file-name SOURCES ... [LINK ...] [DEFINES ...])  -> build/<preset>/components/file-name.so, loaded by `loadrt file-name`.
# Also adds the same code to the object list that the whole-machine harness links in (KERF_COMPONENT_OBJECTS).
function(kerf_component name)
  cmake_parse_arguments(A "" "" "SOURCES;LINK;DEFINES" ${ARGN})
  string(REPLACE "-" "_" id ${name})
  add_library(component_${id}_objects OBJECT ${A_SOURCES})
  _kerf_common(component_${id}_objects)
  target_compile_options(component_${id}_objects PRIVATE ${KERF_RT_FLAGS} -fvisibility=hidden)
  if(CMAKE_CXX_FLAGS MATCHES "-fsanitize")
    # Sanitizers give each temporary a place of its own; constructors, which run at load time, may have hundreds of them.
    target_compile_options(component_${id}_objects PRIVATE -Wno-frame-larger-than)
  endif()
  target_compile_definitions(component_${id}_objects PRIVATE KERF_MODULE_ID=${id} ${A_DEFINES})
  if(A_LINK)
    target_link_libraries(component_${id}_objects PUBLIC ${A_LINK})
  endif()
  target_link_libraries(component_${id}_objects PUBLIC kerf_hal_component)
  add_library(component_${id} MODULE)
  target_link_libraries(component_${id} PRIVATE component_${id}_objects)
  set_target_properties(component_${id} PROPERTIES PREFIX "" OUTPUT_NAME ${name} LINKER_LANGUAGE CXX
    LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/components)
  set_property(GLOBAL APPEND PROPERTY KERF_COMPONENTS ${id})
endfunction()

# kerf_comp_component(name)  NAME.comp, compiled as users do, -> build/<preset>/components/name.so
function(kerf_comp_component name)
  find_program(KERF_PYTHON python3 PATHS /usr/bin NO_DEFAULT_PATH)
  if(NOT KERF_PYTHON)
    return()
  endif()
  set(out ${CMAKE_BINARY_DIR}/components/${name}.so)
  file(GLOB compiler CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/hal/compile/kerf_halcompile/*.py)
  add_custom_command(OUTPUT ${out}
    COMMAND ${CMAKE_BINARY_DIR}/bin/halcompile --compile --outfile=${out} ${CMAKE_CURRENT_SOURCE_DIR}/${name}.comp
    DEPENDS ${name}.comp ${compiler} ${PROJECT_SOURCE_DIR}/src/hal/compile/halcompile kerf_capi_headers VERBATIM)
  add_custom_target(component_${name} ALL DEPENDS ${out})
endfunction()

# What nearly every test reads before its own first line, compiled once a preset: a third of the time that tests take to build.
# A program, as tests are, so that its options are theirs; only its headers are used.
function(_kerf_test_headers target)
  if(NOT TARGET kerf_test_headers)
    file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/test_headers.cpp CONTENT "int main() {}\n")
    add_executable(kerf_test_headers EXCLUDE_FROM_ALL ${CMAKE_BINARY_DIR}/test_headers.cpp)
    _kerf_common(kerf_test_headers)
    target_link_libraries(kerf_test_headers PRIVATE GTest::gtest_main GTest::gmock)
    target_precompile_headers(kerf_test_headers PRIVATE <gmock/gmock.h> <gtest/gtest.h>
      <algorithm> <cmath> <filesystem> <fstream> <functional> <map> <memory> <sstream> <string> <vector>)
  endif()
  target_precompile_headers(${target} REUSE_FROM kerf_test_headers)
  # GCC forgets that these are system headers, and what it thinks of their strings is wrong.
  target_compile_options(${target} PRIVATE -Wno-array-bounds -Wno-restrict -Wno-stringop-overflow -Wno-stringop-overread)
endfunction()

# kerf_test(name SOURCES ... [LINK ...] [LABELS fast hal ...] [TIMEOUT s])  one GoogleTest program, one CTest entry.
function(kerf_test name)
  cmake_parse_arguments(A "" "TIMEOUT" "SOURCES;LINK;LABELS" ${ARGN})
  add_executable(${name} ${A_SOURCES})
  _kerf_common(${name})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR}/tests)
  target_link_libraries(${name} PRIVATE ${A_LINK} GTest::gtest_main GTest::gmock)
  target_sources(${name} PRIVATE $<TARGET_OBJECTS:kerf_hang_watch>)
  _kerf_test_headers(${name})
  target_compile_definitions(${name} PRIVATE KERF_SOURCE_DIR="${PROJECT_SOURCE_DIR}" KERF_BUILD_DIR="${CMAKE_BINARY_DIR}")
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  if(NOT A_LABELS)
    set(A_LABELS fast)
  endif()
  if(NOT A_TIMEOUT)
    # Far above what the slowest takes on a busy machine: what ends here hangs.
    set(A_TIMEOUT 600)
  endif()
  if(CMAKE_CXX_FLAGS MATCHES "-fsanitize")
    # What hangs is told later there: everything takes ten times as long.
    math(EXPR A_TIMEOUT "3 * ${A_TIMEOUT}")
  endif()
  if(KERF_SEED_PLACES)
    # Tests that a row of the seeds names: in a source of this program, or cases in its folder.
    list(TRANSFORM A_SOURCES PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/ OUTPUT_VARIABLE sources)
    foreach(place ${KERF_SEED_PLACES})
      string(FIND ${place} ${CMAKE_CURRENT_SOURCE_DIR}/ at)
      if(place IN_LIST sources OR (at EQUAL 0 AND IS_DIRECTORY ${place}))
        list(APPEND A_LABELS seeds)
        break()
      endif()
    endforeach()
  endif()
  add_test(NAME ${name} COMMAND ${name})
  # Brief: what fails is not to be looked for among hundreds of lines of what did not.
  set_tests_properties(${name} PROPERTIES LABELS "${A_LABELS}" TIMEOUT ${A_TIMEOUT}
    ENVIRONMENT "GTEST_BRIEF=1;KERF_TEST_TIMEOUT_S=${A_TIMEOUT}")
endfunction()

# kerf_bench(name SOURCES ... [LINK ...])  one Google Benchmark program -> build/<preset>/bench/name, run by scripts/bench.
function(kerf_bench name)
  cmake_parse_arguments(A "" "" "SOURCES;LINK" ${ARGN})
  add_executable(${name} ${A_SOURCES})
  _kerf_common(${name})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR}/tests)
  target_link_libraries(${name} PRIVATE ${A_LINK} benchmark::benchmark)
  target_compile_definitions(${name} PRIVATE KERF_SOURCE_DIR="${PROJECT_SOURCE_DIR}" KERF_BUILD_DIR="${CMAKE_BINARY_DIR}")
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bench)
endfunction()

# Adds every named subdirectory that has a CMakeLists.txt.
function(kerf_add_if_present)
  foreach(dir ${ARGN})
    if(EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/${dir}/CMakeLists.txt)
      add_subdirectory(${dir})
    endif()
  endforeach()
endfunction()
