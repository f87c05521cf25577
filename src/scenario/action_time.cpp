#include "scenario/action_time.h"

#include "scenario/actions/action.h"

namespace predictor {

double ActionTime(const ActionSpec& action) noexcept {
  const ActionKind* kind = FindAction(action.action);
  return kind && kind->time ? kind->time(action) : action.duration;
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
