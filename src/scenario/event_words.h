// Describes the trigger of an event in words.
#pragma once

#include <string>

#include "scenario/scenario.h"

namespace predictor {

// Returns when the event begins, such as "at a random time between 2 and 4 s, when every hand
// grips". This text does not contain the time that was drawn.
std::string TriggerWords(const TriggerSpec& trigger);

}  // namespace predictor
