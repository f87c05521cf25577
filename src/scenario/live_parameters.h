// What may be changed while a run is on, and how far.
#pragma once

#include "core/run_input.h"
#include "scenario/scenario.h"

namespace predictor {

struct ParameterRange {
  double min = 0, max = 0;
  double start = 0;  // the scenario's own value; as a factor 1
};

// Thresholds can only be made tighter than the scenario's. With real arms stiffness can only be
// lowered and damping only raised.
ParameterRange RangeOf(const Scenario& scenario, Parameter parameter);

}  // namespace predictor
