# Writes THIRD_PARTY_NOTICES into the build folder, with the licences of third-party parts of an
# installed tree. Libraries from Debian packages contain their own licences.
set(NOTICES ${CMAKE_BINARY_DIR}/THIRD_PARTY_NOTICES)
string(REPEAT "=" 100 RULE)
file(WRITE ${NOTICES} "PREDICTOR contains the following third-party software and data.\n")

# predictor_notice(TITLE FILE...) adds a section with the texts of the files.
function(predictor_notice TITLE)
  file(APPEND ${NOTICES} "\n${RULE}\n${TITLE}\n${RULE}\n\n")
  foreach(FILE ${ARGN})
    if(EXISTS ${FILE})
      file(READ ${FILE} TEXT)
      file(APPEND ${NOTICES} "${TEXT}\n")
    else()
      message(WARNING "No licence of ${TITLE} at ${FILE}: do not distribute packages of this build.")
    endif()
  endforeach()
endfunction()

set(WHEELS ${PREDICTOR_DEPS}/prefix)
set(DEBIAN /usr/share/doc)
set(TEXTS ${CMAKE_SOURCE_DIR}/deps/licences)
predictor_notice("MuJoCo (library)" ${WHEELS}/mujoco_core-4.0.0.dist-info/licenses/LICENSE
                 ${WHEELS}/mujoco_core-4.0.0.dist-info/licenses/LICENSES_THIRD_PARTY.md)
predictor_notice("TinyXML-2 (library)" ${TEXTS}/tinyxml2)
predictor_notice("DAQP (compiled in)" ${PREDICTOR_DEPS}/daqp/LICENSE)
predictor_notice("Pinocchio (headers)" ${WHEELS}/libpinocchio-4.1.0.dist-info/licenses/LICENSE)
predictor_notice("Boost (headers)" ${TEXTS}/boost)
predictor_notice("Eigen (headers)" ${DEBIAN}/libeigen3-dev/copyright)
predictor_notice("CLI11 (headers)" ${DEBIAN}/libcli11-dev/copyright)
predictor_notice("JSON for Modern C++ (headers)" ${DEBIAN}/nlohmann-json3-dev/copyright)
predictor_notice("Robot descriptions: Panda, UR5" ${WHEELS}/example_robot_data-6.0.0.dist-info/licenses/LICENSE
                 ${PREDICTOR_ROBOT_DATA}/panda_description/LICENSE)
# web/dist bundles these libraries. They are absent if the page was not built.
if(EXISTS ${CMAKE_SOURCE_DIR}/web/dist/index.html)
  predictor_notice("three.js (in the viewer's page)" ${CMAKE_SOURCE_DIR}/web/node_modules/three/LICENSE)
  predictor_notice("uPlot (in the viewer's page)" ${CMAKE_SOURCE_DIR}/web/node_modules/uplot/LICENSE)
  predictor_notice("Apache ECharts (in reports)" ${CMAKE_SOURCE_DIR}/web/node_modules/echarts/LICENSE
                   ${CMAKE_SOURCE_DIR}/web/node_modules/echarts/NOTICE)
  predictor_notice("ZRender (in reports)" ${CMAKE_SOURCE_DIR}/web/node_modules/zrender/LICENSE)
  predictor_notice("urdf-loader (in the viewer's page)" /usr/share/common-licenses/Apache-2.0)
endif()
