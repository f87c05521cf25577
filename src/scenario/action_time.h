// Computes the times of a script's actions, which are used to perform and to check the script.
#pragma once

#include <vector>

#include "scenario/scenario.h"

namespace predictor {

// Returns the time that an action takes at an average pace [s], or 0 if this time is unknown.
double ActionTime(const ActionSpec& spec);

// The times of an action in a run, at an average pace [s].
struct ActionSpan {
  double start = 0, end = 0;
};
std::vector<ActionSpan> SpansOf(const std::vector<ActionSpec>& script);

// Returns the index in the script of the action in progress at `run_time` [s], or −1 if no action
// is in progress. The action in progress is the last action that has started. A person at the
// handles follows this action.
int ActionAt(const std::vector<ActionSpan>& script, double run_time) noexcept;

}  // namespace predictor
