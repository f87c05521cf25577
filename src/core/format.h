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

// SI values in the unit in which people read them: "30.5 N seen, 30 N allowed", to three digits or
// as many more as tell the two apart; of counts, the numbers.
std::string SeenAndAllowed(double seen, double allowed, Quantity quantity);

}  // namespace predictor
