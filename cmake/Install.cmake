# Rules for `cmake --install`, which writes a relocatable tree. The component `runtime` contains the program and all
# files that it reads; `./dev package` packs it. The component `development` contains the files that
# find_package(predictor) needs.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(PREDICTOR_PRIVATE_LIBDIR lib/predictor)  # libraries that other programs should not find
set(PREDICTOR_DATADIR share/predictor)       # src/scenario/paths.cpp looks for it beside bin/
set(PREDICTOR_CONFIGDIR lib/cmake/predictor)

# ---- runtime ----
install(TARGETS predictor RUNTIME DESTINATION bin COMPONENT runtime)
set_target_properties(predictor PROPERTIES INSTALL_RPATH "$ORIGIN/../${PREDICTOR_PRIVATE_LIBDIR}")
# They are installed under their sonames, which the program uses to load them.
install(FILES ${PREDICTOR_DEPS}/prefix/mujoco/libmujoco.so.4.0.0 DESTINATION ${PREDICTOR_PRIVATE_LIBDIR} COMPONENT runtime)
install(FILES ${PREDICTOR_PREFIX}/lib/libtinyxml2.so.11.0.0 RENAME libtinyxml2.so.11
        DESTINATION ${PREDICTOR_PRIVATE_LIBDIR} COMPONENT runtime)
install(DIRECTORY scenarios assets DESTINATION ${PREDICTOR_DATADIR} COMPONENT runtime)
# These robots belong to the shipped scenarios. PREDICTOR_PACKAGE_PATH adds others.
foreach(ROBOT panda ur)
  install(DIRECTORY ${PREDICTOR_ROBOT_DATA}/${ROBOT}_description
          DESTINATION ${PREDICTOR_DATADIR}/example-robot-data/robots COMPONENT runtime)
endforeach()
include(Notices)
install(FILES LICENSE DESTINATION share/doc/predictor RENAME copyright COMPONENT runtime)
install(FILES ${CMAKE_BINARY_DIR}/THIRD_PARTY_NOTICES DESTINATION share/doc/predictor COMPONENT runtime)
# The program itself prints the manual page and the completion of commands.
file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/printed)
foreach(PRINTED "man|predictor.1|share/man/man1" "completion bash|predictor|share/bash-completion/completions")
  string(REPLACE "|" ";" PRINTED "${PRINTED}")
  list(GET PRINTED 0 ARGUMENTS)
  list(GET PRINTED 1 FILE)
  list(GET PRINTED 2 DESTINATION)
  string(REPLACE " " ";" ARGUMENTS "${ARGUMENTS}")
  install(CODE "
    execute_process(COMMAND \"$<TARGET_FILE:predictor>\" ${ARGUMENTS}
      OUTPUT_FILE \"${CMAKE_BINARY_DIR}/printed/${FILE}\" COMMAND_ERROR_IS_FATAL ANY)
    file(INSTALL \"${CMAKE_BINARY_DIR}/printed/${FILE}\" DESTINATION \"\${CMAKE_INSTALL_PREFIX}/${DESTINATION}\")"
    COMPONENT runtime)
endforeach()

# ---- development: the emulator and all modules that it is linked with ----
# predictor_collect(OUT MODULE) sets OUT to the targets of this project that a program linked with
# MODULE needs.
function(predictor_collect OUT MODULE)
  set(FOUND ${${OUT}})
  if(NOT MODULE IN_LIST FOUND)
    list(APPEND FOUND ${MODULE})
    get_target_property(LIBRARIES ${MODULE} INTERFACE_LINK_LIBRARIES)
    foreach(LIBRARY ${LIBRARIES})
      string(REGEX REPLACE "^\\$<LINK_ONLY:(.*)>$" "\\1" LIBRARY "${LIBRARY}")
      if(LIBRARY MATCHES "^predictor_" AND TARGET ${LIBRARY})
        predictor_collect(FOUND ${LIBRARY})
      endif()
    endforeach()
  endif()
  set(${OUT} ${FOUND} PARENT_SCOPE)
endfunction()

set(MODULES "")
predictor_collect(MODULES predictor_emulator)
foreach(MODULE ${MODULES})
  string(REPLACE predictor_ "" NAME ${MODULE})
  set_target_properties(${MODULE} PROPERTIES EXPORT_NAME ${NAME})
  install(DIRECTORY src/${NAME} DESTINATION include/predictor COMPONENT development FILES_MATCHING PATTERN *.h)
endforeach()
install(TARGETS ${MODULES} daqp EXPORT predictorTargets ARCHIVE DESTINATION ${PREDICTOR_PRIVATE_LIBDIR} COMPONENT development)
install(FILES include/predictor/controller.h DESTINATION include/predictor COMPONENT development)
install(EXPORT predictorTargets NAMESPACE predictor:: DESTINATION ${PREDICTOR_CONFIGDIR} COMPONENT development)
configure_package_config_file(cmake/predictorConfig.cmake.in ${CMAKE_BINARY_DIR}/predictorConfig.cmake
  INSTALL_DESTINATION ${PREDICTOR_CONFIGDIR} PATH_VARS PREDICTOR_DATADIR PREDICTOR_PRIVATE_LIBDIR)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/predictorConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/predictorConfig.cmake ${CMAKE_BINARY_DIR}/predictorConfigVersion.cmake
        DESTINATION ${PREDICTOR_CONFIGDIR} COMPONENT development)

# ---- ./dev package: a Debian package of the runtime ----
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME predictor)
set(CPACK_PACKAGE_CONTACT "The PREDICTOR authors <predictor@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_COMPONENTS_ALL runtime)
set(CPACK_COMPONENTS_GROUPING ALL_COMPONENTS_IN_ONE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)  # Debian's libraries, from the program's link dependencies
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PREDICTOR_DEPS}/prefix/mujoco ${PREDICTOR_PREFIX}/lib)
include(CPack)
