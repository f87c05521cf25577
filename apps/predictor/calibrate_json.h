// Writes the results of `calibrate` as JSON, with the half-widths of their 95 % intervals. The axes
// are the same as in the structs of the commissioning module.
#pragma once

#include <nlohmann/json.hpp>

#include "commissioning/bases.h"
#include "commissioning/handle.h"
#include "commissioning/loop_fit.h"

namespace predictor {

nlohmann::ordered_json ToJson(const commissioning::HandleCalibration& found);
// `X_WB` is the new pose of the base.
nlohmann::ordered_json ToJson(const commissioning::BaseCalibration& found, const Pose& X_WB);
nlohmann::ordered_json ToJson(const commissioning::LoopFit& found);

}  // namespace predictor
