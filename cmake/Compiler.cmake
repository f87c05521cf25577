# Warnings, sanitizers and the compiler cache, for all targets of this project. In g++ 12, -Wrestrict, -Wstringop-*
# and -Warray-bounds report false positives for std::string and Eigen.
find_program(CCACHE ccache)
if(CCACHE)
  # Settings that ccache requires for precompiled headers (its manual, "Precompiled headers"). They also let build
  # folders share compiled objects.
  set(CMAKE_C_COMPILER_LAUNCHER ${CCACHE})
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros
      CCACHE_BASEDIR=${CMAKE_SOURCE_DIR} ${CCACHE})
  if(PREDICTOR_PRECOMPILE)
    add_compile_options($<$<AND:$<COMPILE_LANGUAGE:CXX>,$<CXX_COMPILER_ID:GNU>>:-fpch-preprocess>)
  endif()
endif()
if(PREDICTOR_PRECOMPILE)
  # The compiler collects garbage less often, which saves a tenth of its time. Clang knows neither
  # option, so lint builds omit them.
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
if(PREDICTOR_SANITIZE_ALL OR PREDICTOR_FUZZ)
  set(PREDICTOR_HARDEN OFF)  # sanitizers have their own checks, which are incompatible with these
endif()
if(PREDICTOR_HARDEN)
  # All targets get these flags, because all users of a precompiled header must have the same flags.
  # docs/developer/benchmarks.md says how to measure their cost per tick. FORTIFY needs optimization; some systems
  # already define their own level.
  add_compile_options($<$<CONFIG:Release>:-fstack-protector-strong>)
  add_compile_definitions($<$<AND:$<CONFIG:Release>,$<COMPILE_LANGUAGE:CXX>>:_GLIBCXX_ASSERTIONS>)
  add_compile_options($<$<CONFIG:Release>:-U_FORTIFY_SOURCE> $<$<CONFIG:Release>:-D_FORTIFY_SOURCE=3>)
  add_link_options(-Wl,-z,relro -Wl,-z,now)
endif()
if(PREDICTOR_SANITIZE)
  add_link_options(-fsanitize=${PREDICTOR_SANITIZE})
  set(PREDICTOR_SANITIZER_OPTIONS -fsanitize=${PREDICTOR_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
endif()
if(PREDICTOR_SANITIZE AND PREDICTOR_SANITIZE_ALL)
  add_compile_options(${PREDICTOR_SANITIZER_OPTIONS})
  if(PREDICTOR_SANITIZE STREQUAL thread)
    # The thread sanitizer does not support std::atomic_thread_fence, which Boost.Asio uses twice. Without this
    # option, the compiler would warn in each file.
    add_compile_options($<$<COMPILE_LANG_AND_ID:CXX,GNU>:-Wno-tsan>)
  endif()
elseif(PREDICTOR_SANITIZE)
  # Only some modules and their tests are compiled with these options (PREDICTOR_SANITIZED in Modules.cmake). All other
  # objects are those of the release build, so that the compiler cache has them. The options undo what the release
  # build adds. That build shows the warnings. All objects must free Eigen's memory alike, and Eigen assumes less about
  # malloc under a sanitizer.
  list(APPEND PREDICTOR_SANITIZER_OPTIONS -O1 -g1 -UNDEBUG -U_FORTIFY_SOURCE -fno-stack-protector -w -DEIGEN_MALLOC_ALREADY_ALIGNED=1)
  # In tests, only memory is checked, because the other checks find defects in the tested code alone.
  set(PREDICTOR_SANITIZER_TEST_OPTIONS ${PREDICTOR_SANITIZER_OPTIONS} -fno-sanitize=undefined -O0)
  # These checks of each pointer and call take a third of the compiler's time in CI. Without them, the address
  # sanitizer still reports a null pointer, an access outside an object and a vector instruction on a misaligned
  # address. The complete build (./dev soak asan) has them.
  list(APPEND PREDICTOR_SANITIZER_OPTIONS -fno-sanitize=null,alignment,object-size,vptr,pointer-overflow
       -fno-sanitize=nonnull-attribute,returns-nonnull-attribute)
endif()
