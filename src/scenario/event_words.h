// Describes the trigger of an event in words.
#pragma once

#include <string>
#include <vector>

#include "scenario/scenario.h"

namespace predictor {

// Returns a text that states when the event begins, such as "at a random time between 2 and 4 s,
// when every hand grips". If the time was drawn at random, the text does not contain this time.
std::string TriggerWords(const TriggerSpec& trigger);

// Returns a sentence for each event whose trigger asks for a time at or after the end of the run.
// Such an event never begins. This is not an error, because a run may be cut short on purpose.
std::vector<std::string> EventsAfterTheEnd(const Scenario& scenario);

}  // namespace predictor
