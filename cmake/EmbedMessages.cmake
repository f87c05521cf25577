# The library message_table contains src/core/message_catalogue.json as a table.
# core/message_catalogue.h searches it at compile time, so that the compiler rejects an unknown id.
set(MESSAGE_FOLDER ${CMAKE_BINARY_DIR}/messages)
set(MESSAGE_CATALOGUE ${CMAKE_SOURCE_DIR}/src/core/message_catalogue.json)
add_custom_command(OUTPUT ${MESSAGE_FOLDER}/message_table.inc
  COMMAND ${CMAKE_COMMAND} -DIN=${MESSAGE_CATALOGUE} -DOUT=${MESSAGE_FOLDER}/message_table.inc
          -P ${CMAKE_SOURCE_DIR}/cmake/message_table.cmake
  DEPENDS ${MESSAGE_CATALOGUE} ${CMAKE_SOURCE_DIR}/cmake/message_table.cmake VERBATIM)
add_custom_target(make_message_table DEPENDS ${MESSAGE_FOLDER}/message_table.inc)
add_library(message_table INTERFACE)
target_include_directories(message_table INTERFACE ${MESSAGE_FOLDER})
add_dependencies(message_table make_message_table)
