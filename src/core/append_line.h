// Text for a person, line by line.
#pragma once

#include <cstdarg>
#include <cstdio>
#include <string>

namespace predictor {

// printf and a newline at the end of `text`; a line is cut at 511 bytes.
__attribute__((format(printf, 2, 3))) inline void AppendLine(std::string* text, const char* format,
                                                             ...) {
  char line[512];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(line, sizeof line, format, arguments);
  va_end(arguments);
  *text += line;
  *text += '\n';
}

}  // namespace predictor
