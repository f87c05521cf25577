// How long and how far the handles go on after the decision to stop, with what the arms add to it.
#pragma once

#include "scenario/scenario.h"
#include "scenario/stop_budget.h"

namespace predictor {

// The way by which an arm goes on after its commands rest, as time at the speed before [s]: by its
// loop's lag, or by nothing where it comes to where its velocities lead. dt: tick [s].
double CoastingOf(const ArmSpec& arm, double dt);

// The longest that a stop of the scenario's arms takes out of `safety.handle_speed`, from the
// decision until no handle is faster than 5 mm/s, and the handles' longest way: WorstStop as the
// velocity loops of the arms obey it (`arm.loop`, and the pull of one that follows a position), the
// later of two arms waited for, and what one arm may go further to follow the other.
// `acceleration`: with which the handles are braked [m/s²].
StopBudget StopOfArms(const Scenario& scenario, double acceleration);
// Where no joint is asked for more than it may: with `safety.stop_acceleration`.
inline StopBudget StopOfArms(const Scenario& scenario) {
  return StopOfArms(scenario, scenario.safety.stop_acceleration);
}
// Where a joint turns as fast as its limits let it, it brakes by its own share
// (StopController::kShareOfJoints), and the handles with it, however hard they might [m/s²]. Throws
// InputError as LoadArm.
double LeastStopAcceleration(const Scenario& scenario);

}  // namespace predictor
