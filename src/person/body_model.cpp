#include "person/body_model.h"

#include <cmath>

namespace predictor::person {
namespace {

constexpr std::array<const char*, kBodyJoints> kNames = {"pelvis_x",
                                                         "pelvis_y",
                                                         "pelvis_z",
                                                         "pelvis_yaw",
                                                         "pelvis_tilt",
                                                         "pelvis_list",
                                                         "torso_flexion",
                                                         "torso_lateral",
                                                         "torso_twist",
                                                         "neck_flexion",
                                                         "neck_lateral",
                                                         "neck_twist",
                                                         "left_shoulder_flexion",
                                                         "left_shoulder_abduction",
                                                         "left_shoulder_rotation",
                                                         "left_elbow_flexion",
                                                         "left_pronation",
                                                         "left_wrist_flexion",
                                                         "left_wrist_deviation",
                                                         "right_shoulder_flexion",
                                                         "right_shoulder_abduction",
                                                         "right_shoulder_rotation",
                                                         "right_elbow_flexion",
                                                         "right_pronation",
                                                         "right_wrist_flexion",
                                                         "right_wrist_deviation"};

std::size_t At(int joint) { return static_cast<std::size_t>(joint); }
Vector3 Along(double x, double y, double z) { return {x, y, z}; }

}  // namespace

const char* JointName(int joint) { return kNames[At(joint)]; }

Pose GripInHand(const Anthropometry& a, int hand, GripKind kind) {
  const double palm = hand == 0 ? -1 : 1;  // sign of y on the palm's side
  const bool power = kind == GripKind::kPower;
  return {Vector3(0, palm * (power ? 0.025 : 0.02), -(power ? 0.9 : 1.2) * a.hand.length),
          Quaternion::Identity()};
}

void BodyModel::Set(int joint, int parent, const Vector3& offset, const Vector3& axis, double lower,
                    double upper) {
  BodyJoint& j = joints_[At(joint)];
  j.parent = parent;
  j.offset = offset;
  j.axis = axis;
  j.lower = lower;
  j.upper = upper;
}

void BodyModel::Carry(int joint, const Segment& segment, const Vector3& com) {
  BodyJoint& j = joints_[At(joint)];
  j.mass = segment.mass;
  j.inertia = segment.inertia;
  j.com = com;
}

// The limits of the torso come from the reference (R). The limits of the neck and the pelvis are
// our choice (D).
void BodyModel::AddTrunk() {
  const Anthropometry& a = anthropometry_;
  const Vector3 none = Vector3::Zero(), x = Vector3::UnitX(), y = Vector3::UnitY(),
                z = Vector3::UnitZ();
  Set(kPelvisX, -1, {0, 0, a.hip_height()}, x, -0.3, 0.3);
  Set(kPelvisY, kPelvisX, none, y, -0.2, 0.2);
  Set(kPelvisZ, kPelvisY, none, z, -0.6, 0);
  Set(kPelvisYaw, kPelvisZ, none, z, -0.8, 0.8);
  Set(kPelvisTilt, kPelvisYaw, none, y, -0.1, 1.2);
  Set(kPelvisList, kPelvisTilt, none, x, -0.35, 0.35);
  Carry(kPelvisList, a.pelvis, {0, 0, a.pelvis.com});
  const Vector3 l5s1(-a.l5s1_behind, 0, a.l5s1_height);
  Set(kTorsoFlexion, kPelvisList, l5s1, y, -0.35, 1.4);
  Set(kTorsoLateral, kTorsoFlexion, none, x, -0.52, 0.52);
  Set(kTorsoTwist, kTorsoLateral, none, z, -0.70, 0.70);
  Carry(kTorsoTwist, a.torso, Vector3(0, 0, a.pelvis.length + a.torso.com) - l5s1);
  Set(kNeckFlexion, kTorsoTwist, Vector3(0, 0, a.pelvis.length + a.torso.length) - l5s1, y, -0.9,
      0.9);
  Set(kNeckLateral, kNeckFlexion, none, x, -0.7, 0.7);
  Set(kNeckTwist, kNeckLateral, none, z, -1.2, 1.2);
  Carry(kNeckTwist, a.head, {0, 0, a.head.com});
}

// The limits of rotation, pronation and deviation are from the MyoArm model (V). The elbow can be
// flexed to 2.5 rad (D). The limits of wrist flexion and shoulder flexion are clinical values (R).
// The permitted abduction ends before the singularity of the sequence (D).
void BodyModel::AddArm(int hand) {
  const Anthropometry& a = anthropometry_;
  const double side = hand == 0 ? 1 : -1;  // sign of y on the arm's side
  const auto at = [&](ArmJoint joint) { return Of(hand, joint); };
  const Vector3 none = Vector3::Zero();
  const Vector3 shoulder(a.l5s1_behind, side * a.half_shoulder_width,
                         a.shoulder_height - a.l5s1_height);
  Set(at(ArmJoint::kShoulderFlexion), kTorsoTwist, shoulder, Along(0, -1, 0), -1.05, 3.14);
  Set(at(ArmJoint::kShoulderAbduction), at(ArmJoint::kShoulderFlexion), none, Along(side, 0, 0),
      -0.79, 1.4);
  Set(at(ArmJoint::kShoulderRotation), at(ArmJoint::kShoulderAbduction), none, Along(0, 0, -side),
      -1.57, 2.09);
  Carry(at(ArmJoint::kShoulderRotation), a.upper_arm, {0, 0, -a.upper_arm.com});
  Set(at(ArmJoint::kElbowFlexion), at(ArmJoint::kShoulderRotation), {0, 0, -a.upper_arm.length},
      Along(0, -1, 0), 0, 2.5);
  Carry(at(ArmJoint::kElbowFlexion), a.forearm, {0, 0, -a.forearm.com});
  Set(at(ArmJoint::kPronation), at(ArmJoint::kElbowFlexion), {0, 0, -a.forearm.length},
      Along(0, 0, -side), -1.57, 1.57);
  Set(at(ArmJoint::kWristFlexion), at(ArmJoint::kPronation), none, Along(-side, 0, 0), -1.2, 1.2);
  Set(at(ArmJoint::kWristDeviation), at(ArmJoint::kWristFlexion), none, Along(0, 1, 0), -0.35,
      0.52);
  Carry(at(ArmJoint::kWristDeviation), a.hand, {0, 0, -a.hand.com});
}

BodyModel::BodyModel(const Anthropometry& anthropometry) : anthropometry_(anthropometry) {
  AddTrunk();
  for (int hand = 0; hand < kHands; ++hand) AddArm(hand);
}

BodyVector BodyModel::lower() const {
  BodyVector x;
  for (int i = 0; i < kBodyJoints; ++i) x[i] = joint(i).lower;
  return x;
}

BodyVector BodyModel::upper() const {
  BodyVector x;
  for (int i = 0; i < kBodyJoints; ++i) x[i] = joint(i).upper;
  return x;
}

Pose Placement::FrameOf(int joint) const { return {p[At(joint)], Quaternion(R[At(joint)])}; }

Placement Place(const BodyModel& model, const BodyVector& q) {
  Placement at;
  for (int i = 0; i < kBodyJoints; ++i) {
    const BodyJoint& joint = model.joint(i);
    const bool root = joint.parent < 0;
    const Matrix3 R = root ? Matrix3::Identity() : at.R[At(joint.parent)];
    const Vector3 p = root ? Vector3::Zero() : at.p[At(joint.parent)];
    at.axis[At(i)] = R * joint.axis;
    at.p[At(i)] = p + R * joint.offset;
    at.R[At(i)] = R;
    if (IsPrismatic(i)) {
      at.p[At(i)] += at.axis[At(i)] * q[i];
    } else {
      at.R[At(i)] = R * Eigen::AngleAxisd(q[i], joint.axis);
    }
  }
  return at;
}

BodyJacobian JacobianAt(const BodyModel& model, const Placement& at, int joint, const Vector3& p) {
  BodyJacobian J = BodyJacobian::Zero();
  for (int i = joint; i >= 0; i = model.joint(i).parent) {
    if (IsPrismatic(i)) {
      J.col(i).head<3>() = at.axis[At(i)];
    } else {
      J.col(i).head<3>() = at.axis[At(i)].cross(p - at.p[At(i)]);
      J.col(i).tail<3>() = at.axis[At(i)];
    }
  }
  return J;
}

}  // namespace predictor::person
