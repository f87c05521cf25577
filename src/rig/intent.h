// What the virtual operator wants: where the object should be, which hands hold, how hard they
// push.
#pragma once

#include <array>

#include "core/types.h"

namespace predictor {

// Written by actions (actions.h), read by the hands. One reference of the object for both hands.
struct Intent {
  Pose X_WO;                   // where the object should be
  Twist V_WO = Twist::Zero();  // how it should move there, sum of all actions
  std::array<Vector3, kHands> push = {Vector3::Zero(), Vector3::Zero()};  // feed-forward, W [N]
  std::array<bool, kHands> hold = {false, false};     // the hand is to hold its handle
  std::array<double, kHands> grip_time = {0.3, 0.3};  // in which a grip closes [s]

  // Moves the reference by a displacement [m] in W; v [m/s] is its velocity now.
  void Move(const Vector3& displacement, const Vector3& v) {
    X_WO.p += displacement;
    V_WO.head<3>() += v;
  }
  // Turns the reference about O by a rotation vector [rad] in W; w [rad/s] is its velocity now.
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
