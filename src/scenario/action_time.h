// The times of a script's actions, both for performing and for checking them.
#pragma once

#include <vector>

#include "scenario/scenario.h"

namespace predictor {

// From an action's start to its end, at an average pace [s]; 0 if it is unknown.
double ActionTime(const ActionSpec& spec);

// The times of an action in a run, at an average pace [s].
struct ActionSpan {
  double start = 0, end = 0;
};
std::vector<ActionSpan> SpansOf(const std::vector<ActionSpec>& script);

// Index in the script of the action in progress at `run_time` [s], which is the last one that has
// started; −1: none. A person at the handles follows it.
int ActionAt(const std::vector<ActionSpan>& script, double run_time) noexcept;

}  // namespace predictor
