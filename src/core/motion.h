// Motion of a frame that is rigidly fixed to another one.
#pragma once

#include <algorithm>

#include "core/messages.h"

namespace predictor {

// Slower than this, a handle stands: by what is measured while its arm is at rest [m/s].
inline constexpr double kStandstillSpeed = 0.01;

// At which a handle's turning counts as motion [m]: a turn about its own axis moves no point there.
inline constexpr double kHandleLength = 0.1;
// How fast a handle moves or turns, whichever is more [m/s].
inline double HandleSpeed(const Twist& V, double length = kHandleLength) {
  return std::max(V.head<3>().norm(), length * V.tail<3>().norm());
}

// At which turning counts in what a stop brakes [m]. No scenario's to choose: turning that counts
// for more would make stops longer.
inline constexpr double kStopLength = 0.2;
// Of a handle, as a stop takes it [m/s].
inline double StopSpeed(const Twist& V) { return HandleSpeed(V, kStopLength); }

// Motion of B, fixed to A at X_AB, out of A's motion: twist and classical acceleration about B.
inline FrameMotion MotionOfFixed(const FrameMotion& A, const Pose& X_AB) {
  const Vector3 r_AB_W = A.X_W.q * X_AB.p;
  const Vector3 w = A.V_W.tail<3>();
  const Vector3 alpha = A.A_W.tail<3>();
  FrameMotion B;
  B.X_W = A.X_W * X_AB;
  B.V_W = ShiftTwist(A.V_W, r_AB_W);
  B.A_W = A.A_W;
  B.A_W.head<3>() += alpha.cross(r_AB_W) + w.cross(w.cross(r_AB_W));
  return B;
}

}  // namespace predictor
