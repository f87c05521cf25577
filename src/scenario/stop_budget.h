// Checks the time and the distance of a stop against the budget.
#pragma once

#include <string>

namespace predictor {

// The longest stop from `speed` [m/s] within these limits [m/s²], [m/s³], without the arms' lag. At
// the start of the stop, the handle is assumed to accelerate as hard as it can without exceeding
// `speed`.
struct StopBudget {
  double time, way;  // [s], [m]
};
StopBudget WorstStop(double speed, double acceleration, double jerk);

// Returns why the limits of a stop [m/s²], [m/s³] are not permitted if real handles move at up to
// `fastest` [m/s]. The result is the rest of a sentence that begins with the keys of the limits, or
// "" if there is no error.
std::string StopRefusal(double acceleration, double jerk, double fastest);

}  // namespace predictor
