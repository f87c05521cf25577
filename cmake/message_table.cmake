# Run as `cmake -DIN=FILE.json -DOUT=FILE.inc -P message_table.cmake`. Writes the message catalogue as rows of a C++
# table, {"id", "text"}, in the order of the file.
cmake_minimum_required(VERSION 3.22)
file(READ "${IN}" CATALOGUE)
string(JSON COUNT LENGTH "${CATALOGUE}")
math(EXPR LAST "${COUNT} - 1")
set(ROWS "// Generated from src/core/message_catalogue.json by cmake/message_table.cmake.\n")
foreach(I RANGE ${LAST})
  string(JSON ID MEMBER "${CATALOGUE}" ${I})
  string(JSON TEXT GET "${CATALOGUE}" "${ID}")
  string(APPEND ROWS "{\"${ID}\", R\"m(${TEXT})m\"},\n")
endforeach()
file(WRITE "${OUT}" "${ROWS}")
