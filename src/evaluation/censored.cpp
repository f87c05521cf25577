#include "evaluation/censored.h"

#include <algorithm>
#include <cmath>

#include "core/format.h"
#include "evaluation/statistics_samples.h"

namespace predictor {

std::vector<SurvivalStep> KaplanMeier(std::span<const CensoredValue> values) {
  std::vector<CensoredValue> sorted(values.begin(), values.end());
  std::ranges::sort(sorted, {}, &CensoredValue::value);
  std::vector<SurvivalStep> steps;
  double share = 1, variance = 0;  // variance: Greenwood's sum
  for (std::size_t i = 0; i < sorted.size();) {
    SurvivalStep step;
    step.value = sorted[i].value;
    step.at_risk = sorted.size() - i;
    for (; i < sorted.size() && sorted[i].value == step.value; ++i)
      step.observed += sorted[i].at_least ? 0 : 1;
    if (step.observed == 0) continue;
    const auto risk = static_cast<double>(step.at_risk);
    const double left = risk - static_cast<double>(step.observed);
    share *= left / risk;
    if (left > 0) variance += static_cast<double>(step.observed) / (risk * left);
    step.share_above = share;
    step.standard_error = share * std::sqrt(variance);
    steps.push_back(step);
  }
  return steps;
}

CensoredValue CensoredQuantile(std::span<const CensoredValue> values, double probability) {
  std::vector<double> bounds;
  bounds.reserve(values.size());
  for (const CensoredValue& value : values) bounds.push_back(value.value);
  const double of_bounds = Quantile(bounds, probability);
  if (std::ranges::none_of(values, &CensoredValue::at_least)) return {of_bounds, false};
  constexpr double kRounding = 1e-12;
  double below = of_bounds;  // the quantile is at least this value
  for (const SurvivalStep& step : KaplanMeier(values)) {
    if (step.share_above <= 1 - probability + kRounding) return {step.value, false};
    below = std::max(below, step.value);
  }
  return {below, true};
}

std::string BoundText(const CensoredValue& value, const char* format) {
  return (value.at_least ? "at least " : "") + Formatted(format, value.value);
}

}  // namespace predictor
