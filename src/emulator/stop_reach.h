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
StopBudget StopOfArms(const Scenario& scenario);

}  // namespace predictor
