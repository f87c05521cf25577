# predictor_embed_page(TARGET) compiles the built page (index.html, app.js, app.css) into TARGET. If
# the page was not built, a page that says so is compiled instead. CMake runs again when files
# appear in the folder or disappear.
set(PREDICTOR_PAGE ${CMAKE_SOURCE_DIR}/web/dist CACHE PATH "Folder of the built page")

function(predictor_embed_page TARGET)
  set(PAGE_DIST ${PREDICTOR_PAGE})
  file(GLOB FOUND CONFIGURE_DEPENDS ${PAGE_DIST}/index.html ${PAGE_DIST}/app.js ${PAGE_DIST}/app.css)
  list(LENGTH FOUND COUNT)
  set(SOURCE ${CMAKE_BINARY_DIR}/page/page_files.cpp)
  if(COUNT EQUAL 3)
    configure_file(${CMAKE_SOURCE_DIR}/cmake/page_files.cpp.in ${SOURCE} @ONLY)
    set_source_files_properties(${SOURCE} PROPERTIES OBJECT_DEPENDS "${FOUND}" SKIP_UNITY_BUILD_INCLUSION ON)
  else()
    message(STATUS "No built page in ${PAGE_DIST}: the viewer will say so")
    configure_file(${CMAKE_SOURCE_DIR}/cmake/no_page_files.cpp.in ${SOURCE} @ONLY)
  endif()
  target_sources(${TARGET} PRIVATE ${SOURCE})
endfunction()
