#include "report/plot.h"

#include <algorithm>
#include <cmath>

#include "core/format.h"

namespace predictor {

std::string Significant(double x, int digits, int decimals) {
  if (std::isnan(x)) return "–";
  if (std::isinf(x)) return x > 0 ? "∞" : "−∞";
  if (x == 0) return "0";
  const int exponent = static_cast<int>(std::floor(std::log10(std::abs(x)) + 1e-12));
  const std::string text = Fixed(x, std::clamp(digits - 1 - exponent, 0, decimals));
  return text.find_first_not_of("0.") == std::string::npos ? "0" : text;
}

std::string Round(double x, int digits) {
  std::string text = Significant(x, digits);
  if (text.find('.') == std::string::npos) return text;
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

std::string AxisTitle(const PlotAxis& axis) {
  if (axis.unit.empty()) return axis.label;
  return axis.label.empty() ? "[" + axis.unit + "]" : axis.label + " [" + axis.unit + "]";
}

}  // namespace predictor
