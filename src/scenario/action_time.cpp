#include "scenario/action_time.h"

#include <algorithm>

namespace predictor {
namespace {

constexpr double kCircleRamp = 1.0;  // [s]

}  // namespace

double CircleRamp(const ActionSpec& action) noexcept {
  return std::min(kCircleRamp, action.cycles * action.period);
}

double ActionTime(const ActionSpec& action) noexcept {
  switch (action.action) {
    case ActionType::kCircle:
      return action.cycles * action.period + CircleRamp(action);
    case ActionType::kPush:
      return 2 * action.rise + action.duration;
    default:
      return action.duration;
  }
}

int ActionAt(const std::vector<ActionSpec>& script, double run_time) noexcept {
  int current = -1;
  for (std::size_t i = 0; i < script.size(); ++i) {
    const double start = script[i].start;
    if (run_time < start || run_time >= start + ActionTime(script[i])) continue;
    if (current < 0 || start >= script[static_cast<std::size_t>(current)].start)
      current = static_cast<int>(i);
  }
  return current;
}

}  // namespace predictor
