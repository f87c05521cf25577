// Time and distance permitted for a stop.
#pragma once

#include <string>

namespace predictor {

// The longest stop from `speed` [m/s] within these limits [m/s²], [m/s³], without the arms' lag. At
// its start, the handle still accelerates as hard as possible without exceeding `speed`.
struct StopBudget {
  double time, way;  // [s], [m]
};
StopBudget WorstStop(double speed, double acceleration, double jerk);

// Returns the error in a stop with these limits [m/s²], [m/s³] if real handles move at up to
// `fastest` [m/s], as a sentence that follows their keys, or "" without an error.
std::string StopRefusal(double acceleration, double jerk, double fastest);

}  // namespace predictor
