// Checks whether the events of a scenario can act on its cobot.
#pragma once

#include <string>

#include "simulation/controller.h"
#include "simulation/event_sequence.h"

namespace predictor {

// `joint` is the joint of the attachment, `type` the name of the controller. `standby` is null if
// the cobot has no standby controller. Throws InputError for an event that would have no effect on
// this cobot.
void CheckEvents(const EventSequence& events, JointType joint, const std::string& type,
                 const Controller& controller, const Controller* standby);

}  // namespace predictor
