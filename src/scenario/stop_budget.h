// What a stop may take.
#pragma once

#include <string>

namespace predictor {

// The longest that a stop takes out of `speed` [m/s] by these bounds [m/s²], [m/s³], the arms' lag
// apart: begun while the handle still speeds up as hard as may be without passing `speed`.
struct StopBudget {
  double time, way;  // [s], [m]
};
StopBudget WorstStop(double speed, double acceleration, double jerk);

// What is wrong with a stop of these bounds [m/s²], [m/s³] where real handles go at up to `fastest`
// [m/s], as a sentence after their keys; "" if nothing.
std::string StopRefusal(double acceleration, double jerk, double fastest);

}  // namespace predictor
