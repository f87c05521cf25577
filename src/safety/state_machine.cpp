#include "safety/state_machine.h"

namespace predictor {

const char* Name(RunEvent event) {
  static constexpr std::array<const char*, kRunEvents> kNames = {
      "started",         "self-test passed",  "align requested",    "aligned",
      "start requested", "stop requested",    "stop and power off", "standstill",
      "reset",           "recover requested", "recovered"};
  return kNames[static_cast<std::size_t>(event)];
}

const char* Name(RunCondition condition) {
  if (condition == internal::kStoppingPowerOff) return "STOPPING (power off)";
  if (condition == internal::kRecoveryHeld) return "RECOVERY (after a stop)";
  return Name(condition.state);
}

}  // namespace predictor
