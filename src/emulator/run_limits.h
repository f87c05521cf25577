// Limits that the supervisor applies to people, pages and programs.
#pragma once

namespace predictor {

// If a headset is silent for this time [s], its wearer no longer sees the moving arms.
inline constexpr double kHeadsetSilence = 0.25;

// If the watchdog is silent for this time [s], motion ends.
inline constexpr double kWatchdogSilence = 1;

// If the enabling key or device is silent for this time [s], it counts as released.
inline constexpr double kEnablingSilence = 0.1;

// A run may be reset only if three conditions are met: the fault has been absent for this time [s],
// no hand exerts more than this force [N] or torque [N·m] on a handle, and the handles do not move.
inline constexpr double kCauseAbsent = 0.5, kFreeForce = 5, kFreeTorque = 1;

}  // namespace predictor
