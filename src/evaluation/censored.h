// Statistics of values for some of which only a lower bound was observed.
//
// The emulator stops a run at its limit of force. The largest force of such a run is a lower bound
// of what the person would have felt without the stop. Such a lower bound is a right-censored
// observation.
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

// Returns the steps in ascending order. By convention, a bound counts as larger than an observed
// value that equals it. The estimate assumes that whether a value is censored does not depend on
// what the value would have been. This assumption is true for a stop at a fixed limit, but doubtful
// for other stops.
std::vector<SurvivalStep> KaplanMeier(std::span<const CensoredValue> values);

// Returns the smallest observed value that is exceeded by a share of at most 1 − probability. If
// too many values are censored, the estimate does not reach this probability. In this case, the
// result is a lower bound: the quantile of all values, censored or not (Quantile), or the largest
// exact value if this value is larger. Without censored values, the result equals Quantile. Without
// any values, the result is kUndefined.
CensoredValue CensoredQuantile(std::span<const CensoredValue> values, double probability);

// Returns "31.2 N" or "at least 31.2 N".
std::string BoundText(const CensoredValue& value, const char* format);

}  // namespace predictor
