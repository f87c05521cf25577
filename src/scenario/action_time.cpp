#include "scenario/action_time.h"

#include <algorithm>

namespace predictor {
namespace {

constexpr double kCircleRamp = 1.0;  // [s]

}  // namespace

double CircleRamp(const ActionSpec& action) {
  return std::min(kCircleRamp, action.cycles * action.period);
}

double ActionTime(const ActionSpec& action) {
  switch (action.action) {
    case ActionType::kCircle:
      return action.cycles * action.period + CircleRamp(action);
    case ActionType::kPush:
      return 2 * action.rise + action.duration;
    default:
      return action.duration;
  }
}

}  // namespace predictor
