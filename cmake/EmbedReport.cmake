# predictor_embed_report(TARGET) compiles the style and the built script of the report's page into
# TARGET. Without the script, the pages have no plots. CMake runs again when the script appears or
# disappears.
function(predictor_embed_report TARGET)
  file(GLOB SCRIPT CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/web/dist/report.js)
  if(SCRIPT)
    set(FOLDER ${CMAKE_SOURCE_DIR}/web/dist)
  else()
    set(FOLDER ${CMAKE_SOURCE_DIR}/web/report/unbuilt)
    message(STATUS "No built script for reports in web/dist: they will have no plots")
  endif()
  predictor_embed_files(${TARGET} ReportStyleFile ${CMAKE_SOURCE_DIR}/web/report report.css)
  predictor_embed_files(${TARGET} ReportScriptFile ${FOLDER} report.js)
endfunction()
