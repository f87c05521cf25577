// Explains to the user why the arms cannot start from their current position. Do not use this in
// the tick.
#pragma once

#include <array>
#include <string>

#include "core/status.h"
#include "haptics/recovery.h"
#include "haptics/render_arm.h"
#include "scenario/scenario.h"

namespace predictor {

// Names the two parts that are too close to each other, the key in the scenario's file, and the
// remedy. If no two parts are too close to each other, returns the sentence of `refusal`.
std::string StartRefusal(const Scenario& scenario, const BeyondPlace& at,
                         const std::array<RenderArm, kHands>& arms, Refusal refusal);

}  // namespace predictor
