#include "core/format.h"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstddef>
#include <cstdio>
#include <numbers>

namespace predictor {
namespace {

void AppendArguments(std::string* text, const char* format, va_list arguments) {
  va_list again;
  va_copy(again, arguments);
  const auto length =
      static_cast<std::size_t>(std::max(0, std::vsnprintf(nullptr, 0, format, again)));
  va_end(again);
  const std::size_t before = text->size();
  text->resize(before + length);  // vsnprintf ends it by the zero that is there already
  std::vsnprintf(text->data() + before, length + 1, format, arguments);
}

}  // namespace

std::string Formatted(const char* format, ...) {
  std::string text;
  va_list arguments;
  va_start(arguments, format);
  AppendArguments(&text, format, arguments);
  va_end(arguments);
  return text;
}

void Append(std::string* text, const char* format, ...) {
  va_list arguments;
  va_start(arguments, format);
  AppendArguments(text, format, arguments);
  va_end(arguments);
}

void AppendLine(std::string* text, const char* format, ...) {
  va_list arguments;
  va_start(arguments, format);
  AppendArguments(text, format, arguments);
  va_end(arguments);
  *text += '\n';
}

namespace {

struct ReadableUnit {
  double scale;  // of the SI value
  const char* name;
};

ReadableUnit UnitOf(Quantity quantity) {
  constexpr double kDegrees = 180 / std::numbers::pi;
  switch (quantity) {
    case Quantity::kForce:
      return {1, " N"};
    case Quantity::kTorque:
      return {1, " N·m"};
    case Quantity::kLength:
      return {1e3, " mm"};
    case Quantity::kAngle:
      return {kDegrees, "°"};
    case Quantity::kSpeed:
      return {1e3, " mm/s"};
    case Quantity::kAngularSpeed:
      return {kDegrees, "°/s"};
    case Quantity::kTime:
    case Quantity::kArmAge:
    case Quantity::kSensorAge:
      return {1e3, " ms"};
    default:
      return {1, ""};
  }
}

// Counts and times of many digits keep them all before the point.
std::string Digits(double x, int digits) {
  const bool large = std::abs(x) >= std::pow(10.0, digits) - 0.5;
  return large ? Formatted("%.0f", x) : Formatted("%.*g", digits, x);
}

}  // namespace

std::string SeenAndAllowed(double seen, double allowed, Quantity quantity) {
  const auto [scale, unit] = UnitOf(quantity);
  std::string a, b;
  for (int digits = 3; digits <= 6 && a == b; ++digits) {
    a = Digits(scale * seen, digits);
    b = Digits(scale * allowed, digits);
    if (seen == allowed) break;
  }
  return a + unit + " seen, " + b + unit + " allowed";
}

}  // namespace predictor
