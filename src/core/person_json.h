// Writes a person's state as JSON, for pages and recordings. Not for use in the tick.
#pragma once

#include <string>

#include "core/person_state.h"

namespace predictor {

// Returns {"type": "person", "tick": …, …} on one line. Times have nine digits, and other numbers
// have five. The state may come from another process. The text is valid JSON for every content of
// the state.
std::string PersonJson(const PersonState& state);
// Returns the JSON Schema (draft-07) of PersonJson.
std::string PersonSchema();

}  // namespace predictor
