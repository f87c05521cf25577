#include "core/status.h"

#include <array>

namespace predictor {

const char* Name(StopCause cause) {
  static constexpr std::array<const char*, kStopCauses> kNames = {
      "none",     "force",  "torque",   "sensor",      "stale",    "tracking",
      "coupling", "elbow",  "joint",    "oscillation", "qp",       "physics",
      "deadline", "device", "operator", "headset",     "enabling", "runaway"};
  return kNames[static_cast<std::size_t>(cause)];
}

const char* Name(RunState state) {
  static constexpr std::array<const char*, kRunStates> kNames = {
      "INIT", "SELFTEST", "IDLE", "ALIGN",     "ARMED",
      "RUN",  "STOPPING", "HELD", "UNPOWERED", "RECOVERY"};
  return kNames[static_cast<std::size_t>(state)];
}

const char* Sentence(Refusal refusal) {
  static constexpr std::array<const char*, kRefusals> kSentences = {
      "",
      "Nobody holds the enabling key. Hold it, then ask again.",
      "A joint is beyond its limit. Bring the arm back by `recover` first.",
      "Two links are nearer than their security distance. Bring the arms apart by `recover` first.",
      "What the run was stopped for is still there. Remove it, wait for half a second, then reset. "
      "An arm that has lost power or connection is found again by starting the program anew.",
      "Something presses on a handle. Let go of the handles; if a hand is caught, `recover` moves "
      "away from it; then reset.",
      "A sensor reads a force where hands must be off. Let go of the handles; if nothing touches "
      "them, the sensor has drifted: start the program again, which tares it.",
      "An arm moves, though nothing was sent: it is led by hand, or sinks. Wait until both stand, "
      "then reset.",
      "A handle is no longer where aligning brought it: its arm gave way, or was led. Stop with q, "
      "reset, and align anew."};
  return kSentences[static_cast<std::size_t>(refusal)];
}

}  // namespace predictor
