// Statistics of a set of values. For some of the values, only a lower bound was observed.
//
// The emulator stops a run when the force reaches its limit. The largest force of such a run is a
// lower bound of what the person would have felt without the stop. Such a lower bound is a
// right-censored observation.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace predictor {

struct CensoredValue {
  double value = 0;
  bool at_least = false;  // the true value is at least this large
};

// A step of the product-limit estimate of Kaplan & Meier (1958), J. Am. Stat. Assoc. 53, 457–481.
struct SurvivalStep {
  double value = 0;           // the exact value that was observed
  std::size_t at_risk = 0;    // number of values and bounds that are not smaller
  std::size_t observed = 0;   // number of exact values here
  double share_above = 1;     // estimated probability of a larger value
  double standard_error = 0;  // standard error of share_above, by Greenwood's formula
};

// Returns the steps in ascending order. By convention, a lower bound counts as larger than an
// observed value that equals this bound. The estimate assumes that censoring is independent of the
// true values. This assumption holds for a stop at a fixed limit but is doubtful for other stops.
std::vector<SurvivalStep> KaplanMeier(std::span<const CensoredValue> values);

// Returns the smallest observed value that at most a share of 1 − probability of the values
// exceeds. If too many values are censored, the estimate does not reach this probability. In this
// case, the result is a lower bound. It is the quantile of all values, censored or not (Quantile),
// or the largest exact value if that value is larger. Without censored values, the result equals
// Quantile. If there are no values, the result is kUndefined.
CensoredValue CensoredQuantile(std::span<const CensoredValue> values, double probability);

// Returns "31.2 N" or "at least 31.2 N".
std::string BoundText(const CensoredValue& value, const char* format);

}  // namespace predictor
