#include "report/plot.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace predictor {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kPadding = 0.06;  // of the range, above and below the data
constexpr double kLimitReach = 3;  // a limit this many times the data's range away is not shown

std::string Fixed(double x, int decimals) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", decimals, x);
  // No minus before nothing.
  if (text[0] == '-' && std::string(text).find_first_not_of("-0.") == std::string::npos)
    return text + 1;
  return text;
}

double RoundStep(double rough) {
  const double power = std::pow(10, std::floor(std::log10(rough)));
  for (const double step : {1.0, 2.0, 5.0})
    if (rough <= step * power * (1 + 1e-9)) return step * power;
  return 10 * power;
}

void Widen(double value, PlotRange* range) {
  if (!std::isfinite(value)) return;
  range->low = std::min(range->low, value);
  range->high = std::max(range->high, value);
}

void WidenBySeries(const PlotSeries& series, const PlotRange& x, bool log, PlotRange* range) {
  for (std::size_t i = 0; i < series.y->size(); ++i) {
    const double at = (*series.x)[i], y = (*series.y)[i];
    if (at < x.low || at > x.high || (log && y <= 0)) continue;
    const double error = series.error ? (*series.error)[i] : 0;
    Widen(y - (log ? 0 : error), range);
    Widen(y + error, range);
  }
}

// What is asked of the axis beside the data; never empty.
void Complete(const PlotAxis& axis, bool limits, PlotRange* range) {
  if (!(range->low <= range->high)) *range = axis.log ? PlotRange{1, 10} : PlotRange{0, 1};
  if (axis.log) {
    range->low /= 1.5;
    range->high *= 1.5;
  } else {
    if (axis.zero) Widen(0, range);
    double length = range->high - range->low;
    const double least = std::max(axis.least, 1e-9 * std::max(1.0, std::abs(range->high)));
    if (length < least) {
      const double middle =
          axis.zero && range->low == 0 ? least / 2 : (range->low + range->high) / 2;
      *range = {middle - least / 2, middle + least / 2};
      length = least;
    }
    const bool at_zero = axis.zero && range->low == 0;
    if (limits || !at_zero) range->low -= at_zero ? 0 : kPadding * length;
    range->high += axis.zero && range->high == 0 ? 0 : kPadding * length;
  }
  if (axis.low) range->low = *axis.low;
  if (axis.high) range->high = *axis.high;
}

}  // namespace

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

AxisTicks LinearTicks(double low, double high, int count, bool exact) {
  AxisTicks ticks;
  const double step = RoundStep((high - low) / std::max(1, count));
  ticks.low = exact ? low : std::floor(low / step + 1e-9) * step;
  ticks.high = exact ? high : std::ceil(high / step - 1e-9) * step;
  const int decimals = std::clamp(static_cast<int>(std::ceil(-std::log10(step) - 1e-9)), 0, 9);
  const double first = std::ceil(ticks.low / step - 1e-9);
  const double last = std::floor(ticks.high / step + 1e-9);
  for (double k = first; k <= last; ++k) {
    ticks.at.push_back(k * step);
    ticks.text.push_back(Fixed(k * step, decimals));
  }
  return ticks;
}

AxisTicks LogTicks(double low, double high, int count) {
  AxisTicks ticks;
  ticks.low = low;
  ticks.high = high;
  const double decades = std::log10(high / low);
  const bool between = 3 * decades <= count;
  const int every = std::max(1, static_cast<int>(std::ceil(decades / std::max(1, count))));
  for (int p = static_cast<int>(std::floor(std::log10(low))); std::pow(10, p) <= high; ++p) {
    if (p % every != 0) continue;
    for (const double factor : {1.0, 2.0, 5.0}) {
      const double at = factor * std::pow(10, p);
      if (at < low || at > high || (factor > 1 && !between)) continue;
      ticks.at.push_back(at);
      ticks.text.push_back(Fixed(at, std::max(0, -p)));
    }
  }
  return ticks;
}

PlotRange RangeOfX(const Plot& plot) {
  if (!plot.x.categories.empty())
    return {-0.6, static_cast<double>(plot.x.categories.size()) - 0.4};
  PlotRange range{kInfinity, -kInfinity};
  for (const PlotPanel& panel : plot.panels)
    for (const PlotSeries& series : panel.series)
      for (const double x : *series.x)
        if (!plot.x.log || x > 0) Widen(x, &range);
  if (!(range.low < range.high)) {
    const double middle = std::isfinite(range.low) ? range.low : 0.5;
    range = {middle - 0.5, middle + 0.5};
  }
  if (plot.x.low) range.low = *plot.x.low;
  if (plot.x.high) range.high = *plot.x.high;
  return range;
}

PlotRange RangeOfY(const PlotPanel& panel, const PlotRange& x) {
  PlotRange range{kInfinity, -kInfinity};
  for (const PlotSeries& series : panel.series) WidenBySeries(series, x, panel.y.log, &range);
  if (panel.y.zero && !panel.y.log && range.low <= range.high) Widen(0, &range);
  const double reach = kLimitReach * std::max(range.high - range.low, panel.y.least);
  bool limits = false;
  const PlotRange data = range;
  for (const PlotLimit& limit : panel.limits) {
    const bool near = limit.value <= data.high + reach && limit.value >= data.low - reach;
    if (!near && data.low <= data.high) continue;
    Widen(limit.value, &range);
    limits = true;
  }
  Complete(panel.y, limits, &range);
  return range;
}

bool Shown(const PlotLimit& limit, const PlotRange& y) {
  return limit.value >= y.low && limit.value <= y.high;
}

}  // namespace predictor
