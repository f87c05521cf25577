// The decisions that a page may make about a whole run. They require simulated arms.
#pragma once

#include "core/status.h"

namespace predictor {

// RunInput::value of a kStop input that ends a run as planned. In this case, the arms brake, and no
// cause is recorded.
inline constexpr double kEndAsPlanned = 1;

// Returns whether a page may select the next scenario. A page may select the next scenario only if
// nothing moves.
constexpr bool MayChooseScenario(RunState state) noexcept {
  return state == RunState::kIdle || state == RunState::kHeld || state == RunState::kUnpowered;
}

}  // namespace predictor
