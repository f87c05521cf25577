// The first alarm of a detector.
#pragma once

namespace predictor {

struct Alarm {
  double time = -1;  // [s]; −1: none
  double amplitude = 0;
};

}  // namespace predictor
