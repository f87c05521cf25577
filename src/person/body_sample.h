// The measurements of a person at one time, and the place where the person stands.
#pragma once

#include <array>
#include <optional>

#include "core/types.h"
#include "person/body_model.h"

namespace predictor::person {

// Where the person stands. The origin of S is on the ground between the feet. Its x axis points in
// the direction that the person faces, and its z axis points up.
struct Stance {
  Pose X_WS;
  double width = 0.25;  // distance between the ankles [m]
};
// Returns the stance at the point `ground` of W [m]. The person faces the horizontal part of
// `direction`. Throws InputError if the horizontal part is zero, or if the width is outside 0 to
// 1 m.
Stance StanceAt(const Vector3& ground, const Vector3& direction, double width = 0.25);
// Returns the stance of a scenario.
Stance StanceOf(const StanceSpec& spec);

// The grip of a hand on its handle D, as the pose of the grip frame G (see GripInHand).
struct Grip {
  GripKind kind = GripKind::kPower;
  Pose X_DG;
  // Whether the hand may grip at any angle about the bar (x of G) and may hold the bar obliquely.
  // The arm's comfort then determines these angles.
  bool turns = true;
};
// Returns X_DG of a hand that holds a bar at D's origin. The bar has the direction `bar` (towards
// the thumb), and the wrist lies in the direction `wrist` from the origin. The two directions are
// in D. Throws InputError if they are parallel.
Pose GripOn(const Vector3& bar, const Vector3& wrist);

struct HandSample {
  bool present = false;  // the hand holds the handle
  Pose X_WD;             // pose of the handle
  // The wrench that the hand exerts on the handle, about D's origin, in the axes of W. The hand
  // itself feels the opposite wrench.
  Wrench F_D_W = Wrench::Zero();
};

struct BodySample {
  double time = 0;  // [s]
  std::array<HandSample, kHands> hands;
  std::optional<Pose> X_WHead;         // frame at the eyes, x forward, z up
  bool head_rotation_measured = true;  // otherwise only the position of X_WHead counts
  std::array<std::optional<Vector3>, kHands> p_WElbow = {};  // elbow joints [m]
};

// Returns the external wrenches, in S, that act on the body at the hands of the sample.
std::array<ExternalWrench, kHands> WrenchesOn(const BodySample& sample, const Stance& stance);

}  // namespace predictor::person
