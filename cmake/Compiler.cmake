# Warnings (-Wrestrict, -Wstringop-* and -Warray-bounds are wrong about std::string and Eigen in g++ 12), sanitizers and the compiler cache, for every target of ours.
find_program(CCACHE ccache)
if(CCACHE)
  # What ccache asks for where headers are precompiled (its manual, "Precompiled headers"); and build
  # folders share what they compile.
  set(CMAKE_C_COMPILER_LAUNCHER ${CCACHE})
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros
      CCACHE_BASEDIR=${CMAKE_SOURCE_DIR} ${CCACHE})
  if(PREDICTOR_PRECOMPILE)
    add_compile_options($<$<AND:$<COMPILE_LANGUAGE:CXX>,$<CXX_COMPILER_ID:GNU>>:-fpch-preprocess>)
  endif()
endif()
if(PREDICTOR_PRECOMPILE)
  # The compiler tidies its memory less often: a tenth of its time. (Not for lint: Clang knows neither.)
  add_compile_options($<$<COMPILE_LANG_AND_ID:CXX,GNU>:--param=ggc-min-expand=200>
                      $<$<COMPILE_LANG_AND_ID:CXX,GNU>:--param=ggc-min-heapsize=1000000>)
endif()

add_library(predictor_options INTERFACE)
target_compile_options(predictor_options INTERFACE
  $<$<COMPILE_LANGUAGE:CXX>:-Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual
  -Wconversion -Wno-sign-conversion -Wno-missing-field-initializers -Wno-restrict -Wno-stringop-overflow -Wno-stringop-overread -Wno-array-bounds
  -fno-math-errno>)
if(PREDICTOR_WERROR)
  target_compile_options(predictor_options INTERFACE -Werror)
endif()
if(PREDICTOR_SANITIZE)
  add_compile_options(-fsanitize=${PREDICTOR_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${PREDICTOR_SANITIZE})
endif()
