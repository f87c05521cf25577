// printf into strings of any length. These functions are not for use in the tick.
#pragma once

#include <ctime>
#include <string>

#include "core/status.h"

namespace predictor {

__attribute__((format(printf, 1, 2))) std::string Formatted(const char* format, ...);

// Appends to `text`.
__attribute__((format(printf, 2, 3))) void Append(std::string* text, const char* format, ...);
// Appends text in the same way as Append, and then a newline.
__attribute__((format(printf, 2, 3))) void AppendLine(std::string* text, const char* format, ...);

// Formats a value with this number of decimals. A value that is rounded to zero has no minus sign.
std::string Fixed(double x, int decimals);

// Returns the local time in the format of strftime.
std::string LocalTime(const char* format, std::time_t time);

// Formats SI values in the units that the user sees, for example "30.5 N, limit 30 N". Uses three
// digits, or more if more are needed to distinguish the two values. Counts are plain numbers.
std::string SeenAndAllowed(double seen, double allowed, Quantity quantity);

}  // namespace predictor
