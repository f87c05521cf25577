#include "core/format.h"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstddef>
#include <cstdio>

#include "core/message_catalogue.h"
#include "core/units.h"

namespace predictor {
namespace {

void AppendArguments(std::string* text, const char* format, va_list arguments) {
  va_list again;
  va_copy(again, arguments);
  const auto length =
      static_cast<std::size_t>(std::max(0, std::vsnprintf(nullptr, 0, format, again)));
  va_end(again);
  const std::size_t before = text->size();
  text->resize(before + length);  // vsnprintf writes its terminating zero over the string's own
  std::vsnprintf(text->data() + before, length + 1, format, arguments);
}

}  // namespace

std::string Fixed(double x, int decimals) {
  const std::string text = Formatted("%.*f", decimals, x);
  const bool is_minus_zero = text[0] == '-' && text.find_first_not_of("-0.") == std::string::npos;
  return is_minus_zero ? text.substr(1) : text;
}

std::string LocalTime(const char* format, std::time_t time) {
  std::tm local{};
  char text[64];
  if (!localtime_r(&time, &local) || std::strftime(text, sizeof text, format, &local) == 0)
    return "";
  return text;
}

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
  double scale;  // displayed unit per SI unit
  const char* name;
};

ReadableUnit UnitOf(Quantity quantity) {
  switch (quantity) {
    case Quantity::kForce:
    case Quantity::kVibration:
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
    case Quantity::kAcceleration:
      return {1, " m/s²"};
    case Quantity::kAngularAcceleration:
      return {1, " rad/s²"};
    case Quantity::kTime:
    case Quantity::kArmAge:
    case Quantity::kSensorAge:
      return {1e3, " ms"};
    default:
      return {1, ""};
  }
}

// Counts and long times are written with all digits before the decimal point.
std::string Digits(double x, int digits) {
  const bool large = std::abs(x) >= std::pow(10.0, digits) - 0.5;
  return large ? Formatted("%.0f", x) : Formatted("%.*g", digits, x);
}

}  // namespace

std::string SeenAndAllowed(double seen, double allowed, Quantity quantity) {
  constexpr double kLong = 10;  // [s]
  const auto [scale, unit] =
      quantity == Quantity::kTime && seen >= kLong ? ReadableUnit{1, " s"} : UnitOf(quantity);
  std::string a, b;
  for (int digits = 3; digits <= 6 && a == b; ++digits) {
    a = Digits(scale * seen, digits);
    b = Digits(scale * allowed, digits);
    if (seen == allowed) break;
  }
  return Message("value", {{"value", a + unit}, {"limit", b + unit}});
}

}  // namespace predictor
