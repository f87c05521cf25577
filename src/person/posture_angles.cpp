#include "person/posture_angles.h"

#include <algorithm>
#include <cmath>

namespace predictor::person {
namespace {

ArmAngles ArmAnglesOf(const BodyModel& model, const Placement& at, const BodyVector& q, int hand) {
  const double side = hand == 0 ? 1 : -1;
  const auto k = [&](ArmJoint joint) { return static_cast<std::size_t>(Of(hand, joint)); };
  const Pose torso = at.FrameOf(kTorsoTwist);
  const Vector3 shoulder = at.p[k(ArmJoint::kShoulderRotation)];
  const Vector3 upper_arm = (at.p[k(ArmJoint::kElbowFlexion)] - shoulder).normalized();
  const Vector3 in_torso = torso.q.conjugate() * upper_arm;
  ArmAngles arm;
  arm.upper_arm_flexion = std::atan2(in_torso.x(), -in_torso.z());
  arm.upper_arm_abduction = std::asin(std::clamp(side * in_torso.y(), -1.0, 1.0));
  arm.upper_arm_elevation = std::acos(std::clamp(-upper_arm.z(), -1.0, 1.0));
  arm.upper_arm_rotation = q[Of(hand, ArmJoint::kShoulderRotation)];
  arm.elbow_flexion = q[Of(hand, ArmJoint::kElbowFlexion)];
  arm.wrist_flexion = q[Of(hand, ArmJoint::kWristFlexion)];
  arm.wrist_deviation = q[Of(hand, ArmJoint::kWristDeviation)];
  arm.forearm_twist = q[Of(hand, ArmJoint::kPronation)];
  const Anthropometry& a = model.anthropometry();
  const Vector3 knuckles =
      at.FrameOf(Of(hand, ArmJoint::kWristDeviation)) * Vector3(0, 0, -a.hand.length);
  arm.hand_beside_midline = side * (torso.q.conjugate() * (knuckles - torso.p)).y();
  arm.hand_beside_shoulder = arm.hand_beside_midline - a.half_shoulder_width;
  return arm;
}

}  // namespace

PostureAngles AnglesOf(const BodyModel& model, const BodyVector& q, double stance_width) {
  const Placement at = Place(model, q);
  PostureAngles angles;
  for (int hand = 0; hand < kHands; ++hand)
    angles.arms[static_cast<std::size_t>(hand)] = ArmAnglesOf(model, at, q, hand);
  const Vector3 up = at.R[kTorsoTwist].col(2);
  const Vector3 ahead(std::cos(q[kPelvisYaw]), std::sin(q[kPelvisYaw]), 0);
  const Vector3 right(ahead.y(), -ahead.x(), 0);
  angles.trunk_flexion = std::atan2(up.dot(ahead), up.z());
  angles.trunk_side_bend = std::asin(std::clamp(up.dot(right), -1.0, 1.0));
  angles.trunk_twist = q[kTorsoTwist];
  angles.neck_flexion = q[kNeckFlexion];
  angles.neck_side_bend = q[kNeckLateral];
  angles.neck_twist = q[kNeckTwist];
  angles.knee_flexion = LegsOf(model, q, stance_width).knee_flexion;
  return angles;
}

}  // namespace predictor::person
