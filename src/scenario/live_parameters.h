// Parameters that may be changed during a run, and their limits.
#pragma once

#include "core/run_input.h"
#include "scenario/scenario.h"

namespace predictor {

struct ParameterRange {
  double min = 0, max = 0;
  double start = 0;  // the scenario's value; 1 for a factor
};

// Thresholds may only be lowered below the scenario's values. With real arms, stiffness may only be
// lowered and damping only raised.
ParameterRange RangeOf(const Scenario& scenario, Parameter parameter);

}  // namespace predictor
