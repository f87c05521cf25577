// Limits that the supervisor applies to people, pages and programs around a run.
#pragma once

namespace predictor {

// Duration of a headset's silence after which its wearer no longer sees the moving arms [s].
inline constexpr double kHeadsetSilence = 0.25;

// Duration of the watchdog's silence after which motion ends [s].
inline constexpr double kWatchdogSilence = 1;

// Duration of the silence of the enabling key or device after which it counts as released [s].
inline constexpr double kEnablingSilence = 0.1;

// A run may be reset only if its fault has been absent for this time [s], no hand exerts more than
// this force [N] and torque [N·m] on a handle, and the handles do not move.
inline constexpr double kCauseAbsent = 0.5, kFreeForce = 5, kFreeTorque = 1;

}  // namespace predictor
