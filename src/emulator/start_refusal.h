// Explains to the user why the arms cannot start from their current position. It must not
// be used in the tick.
#pragma once

#include <array>
#include <string>

#include "core/status.h"
#include "haptics/recovery.h"
#include "haptics/render_arm.h"
#include "scenario/scenario.h"

namespace predictor {

// Names the two parts that are too near to each other, the key in the scenario's file, and the
// remedy. If no parts are too near, returns the sentence of `refusal`.
std::string StartRefusal(const Scenario& scenario, const BeyondPlace& at,
                         const std::array<RenderArm, kHands>& arms, Refusal refusal);

}  // namespace predictor
