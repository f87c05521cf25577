# predictor_embed_files(TARGET FUNCTION FOLDER FILE...) compiles the files of FOLDER into TARGET
# unchanged. The module itself declares FUNCTION, which returns the files as std::string_view
# FUNCTION(name), or an empty one for any other name. FUNCTION may name a namespace within
# predictor, such as survey::PageFile.
function(predictor_embed_files TARGET FUNCTION FOLDER)
  set(SPACE predictor)
  if(FUNCTION MATCHES "^(.+)::(.+)$")
    set(SPACE predictor::${CMAKE_MATCH_1})
    set(FUNCTION ${CMAKE_MATCH_2})
  endif()
  set(ASSEMBLY "")
  set(CASES "")
  set(DEPENDS "")
  foreach(FILE ${ARGN})
    string(MAKE_C_IDENTIFIER "predictor_${FUNCTION}_${FILE}" SYMBOL)
    list(APPEND DEPENDS ${FOLDER}/${FILE})
    string(APPEND ASSEMBLY
      "asm(\".pushsection .rodata\\n.global ${SYMBOL}, ${SYMBOL}_end\\n${SYMBOL}:\\n\"\n"
      "    \".incbin \\\"${FOLDER}/${FILE}\\\"\\n${SYMBOL}_end:\\n.popsection\\n\");\n"
      "extern \"C\" const char ${SYMBOL}[], ${SYMBOL}_end[];\n")
    string(APPEND CASES
      "  if (name == \"${FILE}\") return {${SYMBOL}, static_cast<std::size_t>(${SYMBOL}_end - ${SYMBOL})};\n")
  endforeach()
  string(CONCAT TEXT
    "// Made by cmake/EmbedFiles.cmake.\n#include <cstddef>\n#include <string_view>\n\n${ASSEMBLY}\n"
    "namespace ${SPACE} {\n\nstd::string_view ${FUNCTION}(std::string_view name);\n\n"
    "std::string_view ${FUNCTION}(std::string_view name) {\n${CASES}  return {};\n}\n\n}  // namespace ${SPACE}\n")
  set(SOURCE ${CMAKE_BINARY_DIR}/embedded/${FUNCTION}.cpp)
  file(CONFIGURE OUTPUT ${SOURCE} CONTENT "${TEXT}" @ONLY)
  # In a unity build, its dependence on the files would be lost.
  set_source_files_properties(${SOURCE} PROPERTIES
    OBJECT_DEPENDS "${DEPENDS}" SKIP_PRECOMPILE_HEADERS ON SKIP_UNITY_BUILD_INCLUSION ON)
  target_sources(${TARGET} PRIVATE ${SOURCE})
endfunction()
