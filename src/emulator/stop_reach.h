// Computes for how long and how far the handles move after the decision to stop, including the
// response of the arms.
#pragma once

#include "scenario/scenario.h"
#include "scenario/stop_budget.h"

namespace predictor {

// Returns the overrun of an arm [s]. This is the distance travelled after the command has reached
// zero, divided by the speed before the command changed. The overrun equals the lag of the arm's
// velocity loop, or one tick if the arm follows positions. `dt` is the duration of a tick [s].
double Overrun(const ArmSpec& arm, double dt);

// Returns the longest time and the longest distance of a stop from `safety.handle_speed`. The stop
// begins with the decision and ends when no handle is faster than 5 mm/s. The stop is that of
// WorstStop, executed by the velocity loops of the scenario's arms (`arm.loop`) and by the position
// loop of an arm that follows positions. The time includes the time for which one arm waits for the
// other. `acceleration` is the deceleration of the handles [m/s²].
StopBudget StopOfArms(const Scenario& scenario, double acceleration);
// The stop uses `safety.stop_acceleration`, provided that no joint exceeds its acceleration limit.
inline StopBudget StopOfArms(const Scenario& scenario) {
  return StopOfArms(scenario, scenario.safety.stop_acceleration);
}
// Returns the smallest deceleration of the handles in a stop [m/s²]. A stop has this deceleration
// if a joint at its velocity limit brakes with a share (StopController::kShareOfJoints) of its
// acceleration limit. Throws the same InputError as LoadArm.
double MinStopAcceleration(const Scenario& scenario);

}  // namespace predictor
