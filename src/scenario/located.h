// Where in its file a scenario is wrong, when that shows only once models are loaded.
#pragma once

#include "core/error.h"
#include "scenario/scenario.h"

namespace predictor {

// `error`, with the place of its key in front: "file:line:column: ", or "--set key: " if an
// override put it there; of a key that was left out, the place of the group that lacks it. What is
// wrong with a machine's arm is told with its place and key in the machine's file. Unchanged if it
// concerns no key, or the scenario was not read from text.
InputError Located(const InputError& error, const Scenario& scenario);

// What a person calls the arm of a hand: "device.arms.left" of the scenario, or, on a machine,
// "arms.left.arm".
std::string ArmKey(const Scenario& scenario, int hand);

// Of a scenario on a machine: at which of its tree's keys, which none of its own has, the machine's
// tree stands.
inline constexpr const char* kMachineKey = "machine file";

}  // namespace predictor
