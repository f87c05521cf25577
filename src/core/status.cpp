#include "core/status.h"

#include <array>

namespace predictor {

const char* Name(StopCause cause) {
  static constexpr std::array<const char*, kStopCauses> kNames = {
      "none",     "force",   "torque",      "sensor",  "stale",   "tracking", "coupling",
      "elbow",    "joint",   "oscillation", "qp",      "physics", "deadline", "device",
      "operator", "headset", "enabling",    "runaway", "watchdog"};
  return kNames[static_cast<std::size_t>(cause)];
}

const char* Name(CobotStop stop) {
  static constexpr std::array<const char*, kCobotStops> kNames = {"none", "force", "speed",
                                                                  "momentum", "joint_torque"};
  return kNames[static_cast<std::size_t>(stop)];
}

const char* Name(RunState state) {
  static constexpr std::array<const char*, kRunStates> kNames = {
      "INIT", "SELFTEST", "IDLE", "ALIGN",     "ARMED",
      "RUN",  "STOPPING", "HELD", "UNPOWERED", "RECOVERY"};
  return kNames[static_cast<std::size_t>(state)];
}

}  // namespace predictor
