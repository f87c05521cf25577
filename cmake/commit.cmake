# Run as `cmake -DSOURCE=FOLDER -DOUT=FILE.inc -P commit.cmake`. Writes the commit of the sources as a string literal,
# with a + if they differ from it, or "" without Git. Changes the file only if its content changes.
execute_process(COMMAND git rev-parse --short=7 HEAD WORKING_DIRECTORY ${SOURCE}
                OUTPUT_VARIABLE COMMIT OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
if(COMMIT)
  execute_process(COMMAND git diff --quiet HEAD -- src apps web WORKING_DIRECTORY ${SOURCE}
                  RESULT_VARIABLE DIFFERS ERROR_QUIET)
  if(DIFFERS)
    string(APPEND COMMIT "+")
  endif()
endif()
file(CONFIGURE OUTPUT ${OUT} CONTENT "\"${COMMIT}\"\n")
