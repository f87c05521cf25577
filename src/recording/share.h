// Copies a recording without the data of the person, so that it can be shared.
#pragma once

#include <string>
#include <vector>

#include "recording/header.h"

namespace predictor {

// Removes operator.body and operator.stance from a header's scenario, and all labels except
// `condition`, because they may name a person. Returns the names of what was removed, such as
// "operator.body" or "label pseudonym". Throws InputError if a simulated operator moves on that
// body (operator.embodied). Such a run could not be repeated without the body, and the body does
// not belong to a real person.
std::vector<std::string> RemovePerson(RecordingHeader* header);

// Writes to the new file `out` all of `in` except the data of the person. These data are those that
// RemovePerson removes, the states of the person, which follow from the body, and the markers,
// whose text a person wrote. The ticks stay the same, so a replay repeats them. Throws InputError
// and RecordingError as Recover does. Returns what was removed.
std::vector<std::string> WriteShared(const std::string& in, const std::string& out);

}  // namespace predictor
