// Motion of a frame that is rigidly fixed to another one.
#pragma once

#include "core/messages.h"

namespace predictor {

// Slower than this, a handle stands: by what is measured while its arm is at rest [m/s].
inline constexpr double kStandstillSpeed = 0.01;

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
