// The legs, which are not part of the body's tree: from the pelvis to feet that stay on the ground.
#pragma once

#include <array>

#include "person/body_model.h"

namespace predictor::person {

struct BodyLegs {
  // Centres of mass of thigh, shank and foot of each leg, in S [m].
  std::array<std::array<Vector3, 3>, kHands> com;
  // Hip, knee and ankle of each leg, in S [m].
  std::array<std::array<Vector3, 3>, kHands> joints;
  std::array<double, kHands> knee_flexion = {};  // 0 straight [rad]
  // How much farther the hip joints are from the ankles than the legs are long [m]; 0 if they
  // reach.
  double stretched = 0;
};

// Legs from the hip joints to ankles at ± width / 2 [m], below the zero posture's hips. Thigh and
// shank form a triangle in the plane through hip and ankle that contains the pelvis's forward axis.
// The feet are flat. Mass of the legs acts by its weight only; it has no inertia.
BodyLegs LegsOf(const BodyModel& model, const BodyVector& q, double width);

// The rectangle around both feet, parallel in the direction x of S: the ankle is 0.25 of the foot's
// length before the heel, and the foot is 0.055 of the height wide (Drillis & Contini, R).
struct Footprint {
  double back = 0, front = 0, half_width = 0;  // x = back ... front, |y| ≤ half_width [m]
  // Distance of (x, y) from the nearest edge [m], positive inside.
  double MarginOf(double x, double y) const;
};
Footprint FootprintOf(const Anthropometry& a, double width);

}  // namespace predictor::person
