// printf into strings, of any length. Not for the tick.
#pragma once

#include <string>

#include "core/status.h"

namespace predictor {

__attribute__((format(printf, 1, 2))) std::string Formatted(const char* format, ...);

// At the end of `text`.
__attribute__((format(printf, 2, 3))) void Append(std::string* text, const char* format, ...);
// The same, and a newline.
__attribute__((format(printf, 2, 3))) void AppendLine(std::string* text, const char* format, ...);

// An SI value in the unit in which people read it: "31.25 N", "12.5 mm"; of a count, the number.
std::string Readable(double value, Quantity quantity);

}  // namespace predictor
