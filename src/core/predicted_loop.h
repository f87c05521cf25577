// Prediction of a run's haptic loop, which is computed before the first tick of the run.
#pragma once

namespace predictor {

struct PredictedLoop {
  double lead = 0;    // time by which the reference leads the arms [s]
  double margin = 0;  // factor of the hands' impedance at which the loop becomes unstable

  bool stable() const { return margin >= 1; }
};

}  // namespace predictor
