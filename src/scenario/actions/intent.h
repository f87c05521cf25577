// The operator's intent: the desired pose of the object, the hands that hold the object, and their
// forces.
#pragma once

#include <array>

#include "core/types.h"

namespace predictor {

// What the operator intends. The actions write the intent, and the hands read it. Both hands share
// one reference for the object.
struct Intent {
  Pose X_WO;                   // set-point of the object
  Twist V_WO = Twist::Zero();  // velocity of the object, the sum over all actions [m/s], [rad/s]
  // feed-forward force, in W [N]
  std::array<Vector3, kHands> push = {Vector3::Zero(), Vector3::Zero()};
  std::array<bool, kHands> hold = {false, false};     // the hand holds its handle
  std::array<double, kHands> grip_time = {0.3, 0.3};  // time in which a grip closes [s]

  // Moves the reference by a displacement [m] in W, whose rate is v [m/s].
  void Move(const Vector3& displacement, const Vector3& v) {
    X_WO.p += displacement;
    V_WO.head<3>() += v;
  }
  // Rotates the reference about O by a rotation vector [rad] in W. The present angular velocity is
  // w [rad/s].
  void Turn(const Vector3& rotation, const Vector3& w) {
    X_WO.q = (RotationFromVector(rotation) * X_WO.q).normalized();
    V_WO.tail<3>() += w;
  }
  template <class A>
  void Archive(A& a) {
    a(X_WO, V_WO, push, hold, grip_time);
  }
  bool AnyHold() const { return hold[0] || hold[1]; }
};

}  // namespace predictor
