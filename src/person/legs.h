// The legs extend from the pelvis to the feet, which stay on the ground. The legs are not part of
// the body's tree.
#pragma once

#include <array>

#include "person/body_model.h"

namespace predictor::person {

struct BodyLegs {
  // The centres of mass of thigh, shank and foot of each leg, in S [m].
  std::array<std::array<Vector3, 3>, kHands> com;
  // The hip, knee and ankle of each leg, in S [m].
  std::array<std::array<Vector3, 3>, kHands> joints;
  std::array<double, kHands> knee_flexion = {};  // 0 straight [rad]
  // The amount by which the distance from hip joints to ankles exceeds the length of the legs [m],
  // or 0 if the legs are long enough.
  double stretched = 0;
};

// Returns legs from the hip joints to ankles at ± width / 2 [m], below the hips of the zero
// posture. Thigh and shank form a triangle in the plane through hip and ankle that contains the
// pelvis's forward axis. The feet are flat. The legs' mass contributes only its weight and no
// inertia.
BodyLegs LegsOf(const BodyModel& model, const BodyVector& q, double width);

// The rectangle around both feet, which are parallel to x of S. The heel is 0.25 of the foot's
// length behind the ankle, and the foot's width is 0.055 of the body's height (Drillis & Contini,
// R).
struct Footprint {
  double back = 0, front = 0, half_width = 0;  // x = back ... front, |y| ≤ half_width [m]
  // Returns the distance of (x, y) from the nearest edge of the rectangle [m], positive inside.
  double MarginOf(double x, double y) const;
};
Footprint FootprintOf(const Anthropometry& a, double width);

}  // namespace predictor::person
