// Motion of a frame that is rigidly fixed to another frame.
#pragma once

#include <algorithm>

#include "core/messages.h"

namespace predictor {

// A handle slower than this counts as stationary [m/s]. The speeds that arms report at rest are
// lower than this speed.
inline constexpr double kStandstillSpeed = 0.01;

// Lever arm [m] by which a handle's rotation is multiplied so that the detection of motion includes
// rotation. A rotation about the handle's own axis would otherwise not be detected.
inline constexpr double kHandleLength = 0.1;
// Returns a handle's speed or its angular speed times `length`, whichever is larger [m/s].
inline double HandleSpeed(const Twist& V, double length = kHandleLength) {
  return std::max(V.head<3>().norm(), length * V.tail<3>().norm());
}

// Lever arm that converts rotation to the speed that a stop must brake [m]. A scenario cannot
// change this value, because a longer lever arm would make stops longer.
inline constexpr double kStopLength = 0.2;
// Returns the speed of a handle that is used for a stop [m/s].
inline double StopSpeed(const Twist& V) { return HandleSpeed(V, kStopLength); }

// Computes the twist and the classical acceleration of frame B from the motion of frame A. B is
// fixed to A with the pose X_AB.
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
