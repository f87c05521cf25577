// Describes the trigger of an event in words.
#pragma once

#include <string>

#include "scenario/scenario.h"

namespace predictor {

// Returns a text that states when the event begins, such as "at a random time between 2 and 4 s,
// when every hand grips". If the time was drawn at random, the text does not contain this time.
std::string TriggerWords(const TriggerSpec& trigger);

}  // namespace predictor
