# Third-party libraries come from Debian packages, or from wheels that `./dev` unpacks into
# .deps/prefix.
set(PREDICTOR_DEPS ${CMAKE_SOURCE_DIR}/.deps CACHE PATH "Where ./dev put the pinned dependencies")
set(PREDICTOR_PREFIX ${PREDICTOR_DEPS}/prefix/cmeel.prefix)
if(NOT EXISTS ${PREDICTOR_PREFIX})
  message(FATAL_ERROR "The pinned libraries are not in ${PREDICTOR_DEPS}. Run ./dev build, which fetches them.")
endif()

# Debian's packages come first, so that the wheels' prefix cannot shadow them.
find_package(Eigen3 3.4 REQUIRED CONFIG)
find_package(yaml-cpp REQUIRED)
find_package(nlohmann_json REQUIRED CONFIG)
find_package(CLI11 REQUIRED CONFIG)
find_package(GTest REQUIRED)
find_package(Threads REQUIRED)
find_package(OpenSSL 3.0 REQUIRED)
find_package(ZLIB REQUIRED)

# predictor_library(NAME HEADER) finds a library whose Debian package has no CMake configuration.
function(predictor_library NAME HEADER)
  find_path(${NAME}_INCLUDE_DIR ${HEADER} REQUIRED)
  find_library(${NAME}_LIBRARY ${NAME} REQUIRED)
  add_library(${NAME} UNKNOWN IMPORTED GLOBAL)
  set_target_properties(${NAME} PROPERTIES IMPORTED_LOCATION ${${NAME}_LIBRARY} INTERFACE_INCLUDE_DIRECTORIES ${${NAME}_INCLUDE_DIR})
endfunction()
predictor_library(zstd zstd.h)           # compression of recordings
predictor_library(sqlite3 sqlite3.h)     # ROS 2 bags
predictor_library(deflate libdeflate.h)  # CRC32 of recordings, compression of PNG pictures
predictor_library(seccomp seccomp.h)     # system call filter of the server processes
predictor_library(rapidcheck rapidcheck.h)  # tests: random cases that shrink

# TinyXML-2 comes from the wheels, because Pinocchio's include path contains its header, which must
# match the library.
add_library(tinyxml2::tinyxml2 SHARED IMPORTED)
set_target_properties(tinyxml2::tinyxml2 PROPERTIES
  IMPORTED_LOCATION ${PREDICTOR_PREFIX}/lib/libtinyxml2.so.11.0.0
  INTERFACE_INCLUDE_DIRECTORIES ${PREDICTOR_PREFIX}/include)

# Only Pinocchio's templates are used, for the torque regressor. Its library is not linked, so coal,
# urdfdom and Boost's libraries are not needed, and the wheel's compiler settings do not matter. Its
# include path contains Boost 1.90 and precedes the system's, so that Debian's Boost is never mixed
# in.
add_library(pinocchio::pinocchio INTERFACE IMPORTED)
set_target_properties(pinocchio::pinocchio PROPERTIES
  INTERFACE_INCLUDE_DIRECTORIES "${PREDICTOR_PREFIX}/include"
  INTERFACE_COMPILE_DEFINITIONS "BOOST_MPL_LIMIT_LIST_SIZE=30;BOOST_MPL_CFG_NO_PREPROCESSED_HEADERS;BOOST_VARIANT_USE_RELAXED_GET_BY_DEFAULT"
  INTERFACE_LINK_LIBRARIES Eigen3::Eigen)

# Boost 1.90 (Asio and Beast) comes from the same wheels, as headers only. It is never combined with
# Debian's Boost.
add_library(boost_headers INTERFACE IMPORTED)
set_target_properties(boost_headers PROPERTIES
  INTERFACE_INCLUDE_DIRECTORIES ${PREDICTOR_PREFIX}/include
  INTERFACE_SYSTEM_INCLUDE_DIRECTORIES ${PREDICTOR_PREFIX}/include
  INTERFACE_LINK_LIBRARIES Threads::Threads)

# MuJoCo is the physics engine. Its wheel contains no CMake configuration.
add_library(mujoco::mujoco SHARED IMPORTED)
set_target_properties(mujoco::mujoco PROPERTIES
  IMPORTED_LOCATION ${PREDICTOR_DEPS}/prefix/mujoco/libmujoco.so.4.0.0
  INTERFACE_INCLUDE_DIRECTORIES ${PREDICTOR_DEPS}/prefix/mujoco/include
  INTERFACE_SYSTEM_INCLUDE_DIRECTORIES ${PREDICTOR_DEPS}/prefix/mujoco/include)

# DAQP is the QP solver. It is built from its C sources.
file(GLOB DAQP_SOURCES ${PREDICTOR_DEPS}/daqp/csrc/src/*.c)
add_library(daqp STATIC ${DAQP_SOURCES})
target_include_directories(daqp SYSTEM PUBLIC $<BUILD_INTERFACE:${PREDICTOR_DEPS}/daqp/csrc/include>)
target_compile_options(daqp PRIVATE -w -O3)
add_library(daqp::daqp ALIAS daqp)

# The other QP solvers are for the benchmark only.
add_library(qp_candidates INTERFACE)
target_include_directories(qp_candidates SYSTEM INTERFACE ${PREDICTOR_PREFIX}/include)
target_link_libraries(qp_candidates INTERFACE Eigen3::Eigen ${PREDICTOR_PREFIX}/lib/libeiquadprog.so)

# This folder of robot descriptions is the default root of package:// paths.
set(PREDICTOR_ROBOT_DATA ${PREDICTOR_PREFIX}/share/example-robot-data/robots)
