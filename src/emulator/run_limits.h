// Limits that the supervisor applies to people, pages and programs around a run.
#pragma once

namespace predictor {

// Silence of a headset after which its wearer no longer sees the moving arms [s].
inline constexpr double kHeadsetSilence = 0.25;

// Silence of the watchdog after which motion ends [s].
inline constexpr double kWatchdogSilence = 1;

// Silence of the enabling key or device after which it counts as released [s].
inline constexpr double kEnablingSilence = 0.1;

// A run may be reset only after its fault has been absent for this long [s], while no hand exerts
// more than this force [N] and torque [N·m] on a handle and the handles do not move.
inline constexpr double kCauseAbsent = 0.5, kFreeForce = 5, kFreeTorque = 1;

}  // namespace predictor
