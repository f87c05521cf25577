// The positions of the joints, for pictures of the body.
#pragma once

#include <array>

#include "person/legs.h"

namespace predictor::person {

// The points of one side of the body, in S [m].
struct SkeletonSide {
  Vector3 shoulder, elbow, wrist, knuckles, hip, knee, ankle, heel, toes;
};

struct Skeleton {
  Vector3 pelvis;      // middle of the hip joints
  Vector3 lower_back;  // L5/S1
  Vector3 neck;        // C7
  Vector3 head;        // middle of the head
  Vector3 face;        // unit vector in the direction of the nose
  std::array<SkeletonSide, kHands> sides;
};

// `width` is the distance between the ankles [m], see LegsOf.
Skeleton SkeletonOf(const BodyModel& model, const BodyVector& q, double width);
}  // namespace predictor::person
