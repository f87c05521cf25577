#include "person/skeleton.h"

namespace predictor::person {

Skeleton SkeletonOf(const BodyModel& model, const BodyVector& q, double width) {
  const Anthropometry& a = model.anthropometry();
  const Placement at = Place(model, q);
  const BodyLegs legs = LegsOf(model, q, width);
  const Footprint foot = FootprintOf(a, width);
  Skeleton s;
  s.pelvis = at.p[kPelvisList];
  s.lower_back = at.p[kTorsoFlexion];
  s.neck = at.p[kNeckFlexion];
  const Pose head = at.FrameOf(kNeckTwist);
  s.head = head * Vector3(0, 0, a.head.length / 2);
  s.face = head.q * Vector3::UnitX();
  for (int side = 0; side < kHands; ++side) {
    const auto k = static_cast<std::size_t>(side);
    const auto joint = [&](ArmJoint j) { return at.p[static_cast<std::size_t>(Of(side, j))]; };
    SkeletonSide& points = s.sides[k];
    points.shoulder = joint(ArmJoint::kShoulderFlexion);
    points.elbow = joint(ArmJoint::kElbowFlexion);
    points.wrist = joint(ArmJoint::kWristFlexion);
    points.knuckles =
        at.FrameOf(Of(side, ArmJoint::kWristDeviation)) * Vector3(0, 0, -a.hand.length);
    points.hip = legs.joints[k][0];
    points.knee = legs.joints[k][1];
    points.ankle = legs.joints[k][2];
    points.heel = {foot.back, points.ankle.y(), 0};
    points.toes = {foot.front, points.ankle.y(), 0};
  }
  return s;
}

}  // namespace predictor::person
