#include "scenario/action_time.h"

#include "scenario/actions/action.h"

namespace predictor {

double ActionTime(const ActionSpec& spec) {
  const ActionKind* kind = FindAction(spec.action);
  return kind ? kind->time(*ParametersIn(spec, *kind)) : 0;
}

std::vector<ActionSpan> SpansOf(const std::vector<ActionSpec>& script) {
  std::vector<ActionSpan> spans;
  for (const ActionSpec& entry : script)
    spans.push_back({entry.start, entry.start + ActionTime(entry)});
  return spans;
}

int ActionAt(const std::vector<ActionSpan>& script, double run_time) noexcept {
  int current = -1;
  for (std::size_t i = 0; i < script.size(); ++i) {
    const double start = script[i].start;
    if (run_time < start || run_time >= script[i].end) continue;
    if (current < 0 || start >= script[static_cast<std::size_t>(current)].start)
      current = static_cast<int>(i);
  }
  return current;
}

}  // namespace predictor
