#include "simulation/control_timing.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/error.h"
#include "core/text.h"

namespace predictor {
namespace {

int WholeSteps(double time, double step, const char* key, const std::string& value) {
  const double steps = time / step;
  const double whole = std::round(steps);
  if (std::abs(steps - whole) > 1e-6)
    throw InputError::At(key, std::string(key) + " is " + value +
                                  ", but the simulation's step is " + FormatNumber(1e3 * step) +
                                  " ms. Give a time that is a whole number of these steps.");
  return static_cast<int>(whole);
}

}  // namespace

ControlTiming::ControlTiming(const ControlSpec& spec, double step, double max_added)
    : step_(step),
      period_(
          WholeSteps(1 / spec.rate, step, "cobot.control.rate", FormatNumber(spec.rate) + " Hz")),
      delay_(WholeSteps(spec.delay, step, "cobot.control.delay",
                        FormatNumber(1e3 * spec.delay) + " ms")),
      past_(static_cast<std::size_t>(delay_ + std::lround(max_added / step)) + 1) {}

void ControlTiming::Reset(const JointVector& torque) noexcept {
  count_ = 0;
  std::fill(past_.begin(), past_.end(), torque);
}

void ControlTiming::AddDelay(double time) noexcept {
  const int most = static_cast<int>(past_.size()) - 1 - delay_;
  added_ = std::clamp(static_cast<int>(std::lround(time / step_)), 0, most);
}

const JointVector& ControlTiming::Apply(const JointVector& torque) noexcept {
  const auto size = static_cast<std::uint32_t>(past_.size());
  past_[count_ % size] = torque;
  const JointVector& acting =
      past_[(count_ + size - static_cast<std::uint32_t>(delay_ + added_)) % size];
  ++count_;
  return acting;
}

}  // namespace predictor
