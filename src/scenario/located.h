// Finds the place in the file for an error in a scenario that is detected only after the models are
// loaded.
#pragma once

#include "core/error.h"
#include "scenario/scenario.h"

namespace predictor {

// Returns `error` preceded by the place of its key: "file:line:column: ", or "--set key: " if an
// override set it. For a missing key, the place is that of the group that lacks the key. If the
// error concerns a machine's arm, the result contains the place and the key in the machine's file.
// The error is unchanged if it has no key or if the scenario was not read from text.
InputError Located(const InputError& error, const Scenario& scenario);

// Returns the key of a hand's arm in a scenario, such as "device.arms.left".
std::string DeviceArmKey(int hand);
// Returns the name of a hand's arm for the user: "device.arms.left" of the scenario or, on a
// machine, "arms.left.arm".
std::string ArmKey(const Scenario& scenario, int hand);
// Returns the advice to the user if a hand's arm cannot reach a place: "move device.arms.left.base"
// or, if the arms are fixed, "change environment.shift".
std::string PlacementRemedy(const Scenario& scenario, int hand);

// The key under which the machine's tree is stored in the tree of a scenario on a machine. No
// scenario file can contain this key.
inline constexpr const char* kMachineKey = "machine file";

}  // namespace predictor
