// The scene as the page gets it (docs/viewer-protocol.md, "The scene").
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "core/record.h"
#include "scenario/scenario.h"
#include "viewer/asset_store.h"

namespace predictor {

// Reads the models of the scenario into `assets` and describes the scene. object_start: where the
// object's frame O is in W when the run starts [m]. Throws InputError.
nlohmann::ordered_json DescribeScene(const Scenario& scenario, const Vector3& object_start,
                                     AssetStore* assets);

// What the operator is to do in an action, as a sentence. facing: +1 if the operator looks along +x
// (left is +y), −1 if along −x.
std::string Instruction(const ActionSpec& action, int facing);

// Along which way of x the operator looks, told by which handle is the left one; with one hand,
// across from the cobot. object_start: O in W [m].
int OperatorFacing(const Scenario& scenario, const Vector3& object_start);

// What a reset kept tighter than the scenario says, as a sentence; empty if nothing. `record`: one
// after the reset.
std::string KeptThresholds(const Scenario& scenario, const TickRecord& record);

}  // namespace predictor
