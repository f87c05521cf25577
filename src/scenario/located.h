// Where in its file a scenario is wrong, when that shows only once models are loaded.
#pragma once

#include "core/error.h"
#include "scenario/scenario.h"

namespace predictor {

// `error`, with the place of its key in front: "file:line:column: ", or "--set key: " if an
// override put it there; of a key that was left out, the place of the group that lacks it.
// Unchanged if it concerns no key, or the scenario was not read from text.
InputError Located(const InputError& error, const Scenario& scenario);

}  // namespace predictor
