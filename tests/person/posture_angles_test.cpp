// Tests the computed angles with postures whose angles follow from their descriptions.
#include "person/posture_angles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>

#include "people.h"

namespace predictor::person {
namespace {

const BodyModel kModel{Man()};

PostureAngles Angles(const BodyVector& q) { return AnglesOf(kModel, q, 0.25); }

TEST(PostureAngles, AreZeroUpright) {
  PostureAngles angles = Angles(BodyVector::Zero());
  ForEachAngle(angles, [](const char* name, double& value) {
    if (std::string(name).find("hand_beside") == std::string::npos) {
      EXPECT_NEAR(value, 0, 0.15) << name;  // the feet are farther apart than the hips
    }
  });
  EXPECT_NEAR(angles.arms[0].hand_beside_shoulder, 0, 1e-12);
  EXPECT_NEAR(angles.arms[0].hand_beside_midline, kModel.anthropometry().half_shoulder_width,
              1e-12);
}

TEST(PostureAngles, OfTheArmsHaveTheSignsOfTheWorksheets) {
  for (int hand = 0; hand < kHands; ++hand) {
    const auto k = static_cast<std::size_t>(hand);
    const auto with = [&](ArmJoint joint, double angle, ArmJoint second = ArmJoint::kPronation,
                          double other = 0) {
      BodyVector q = BodyVector::Zero();
      q[Of(hand, joint)] = angle;
      q[Of(hand, second)] += other;
      return Angles(q).arms[k];
    };
    EXPECT_NEAR(with(ArmJoint::kShoulderFlexion, 1).upper_arm_flexion, 1, 1e-12);
    EXPECT_NEAR(with(ArmJoint::kShoulderFlexion, -0.5).upper_arm_flexion, -0.5, 1e-12);
    EXPECT_NEAR(with(ArmJoint::kShoulderFlexion, 2).upper_arm_elevation, 2, 1e-12);
    const ArmAngles out = with(ArmJoint::kShoulderAbduction, 0.8);
    EXPECT_NEAR(out.upper_arm_abduction, 0.8, 1e-12);
    EXPECT_NEAR(out.upper_arm_elevation, 0.8, 1e-12);
    EXPECT_NEAR(out.upper_arm_flexion, 0, 1e-12);
    EXPECT_GT(out.hand_beside_shoulder, 0.3);
    EXPECT_NEAR(with(ArmJoint::kElbowFlexion, 1.2).elbow_flexion, 1.2, 1e-12);
    EXPECT_NEAR(with(ArmJoint::kPronation, 0.7).forearm_twist, 0.7, 1e-12);
    // An inward rotation of the upper arm moves the bent forearm across the body.
    EXPECT_LT(
        with(ArmJoint::kElbowFlexion, kPi / 2, ArmJoint::kShoulderRotation, 1).hand_beside_midline,
        0);
    // The palm faces the body. Flexion moves the knuckles towards the body, and ulnar deviation
    // moves them backward.
    EXPECT_LT(with(ArmJoint::kWristFlexion, 0.5).hand_beside_shoulder, -0.02);
  }
}

// Uses the positions of the fingers, the thumb and the palm to check that they move as documented.
TEST(PostureAngles, OfTheHandMoveItAsTheirNamesSay) {
  for (int hand = 0; hand < kHands; ++hand) {
    const double side = hand == 0 ? 1 : -1;
    const auto hand_frame = [&](ArmJoint joint, double angle) {
      BodyVector q = BodyVector::Zero();
      q[Of(hand, ArmJoint::kElbowFlexion)] = kPi / 2;  // the forearm forward, the thumb up
      q[Of(hand, joint)] += angle;
      return Place(kModel, q).FrameOf(Of(hand, ArmJoint::kWristDeviation));
    };
    const Vector3 thumb(1, 0, 0), palm(0, -side, 0), fingers(0, 0, -1);
    const Pose rest = hand_frame(ArmJoint::kPronation, 0);
    EXPECT_NEAR((rest.q * thumb - Vector3(0, 0, 1)).norm(), 0, 1e-12);
    EXPECT_NEAR((rest.q * fingers - Vector3(1, 0, 0)).norm(), 0, 1e-12);
    EXPECT_NEAR((rest.q * palm - Vector3(0, -side, 0)).norm(), 0, 1e-12);
    const Pose prone = hand_frame(ArmJoint::kPronation, kPi / 2);
    EXPECT_NEAR((prone.q * palm - Vector3(0, 0, -1)).norm(), 0, 1e-12);
    const Pose flexed = hand_frame(ArmJoint::kWristFlexion, 0.5);
    EXPECT_GT((flexed.q * fingers).dot(rest.q * palm), 0.4);
    const Pose ulnar = hand_frame(ArmJoint::kWristDeviation, 0.4);
    EXPECT_LT((ulnar.q * fingers).dot(rest.q * thumb), -0.3);
  }
}

TEST(PostureAngles, OfTheTrunkCountFromTheVertical) {
  BodyVector q = BodyVector::Zero();
  q[kPelvisYaw] = 0.5;
  q[kPelvisTilt] = 0.3;
  q[kTorsoFlexion] = 0.4;
  EXPECT_NEAR(Angles(q).trunk_flexion, 0.7, 1e-12);
  EXPECT_NEAR(Angles(q).trunk_side_bend, 0, 1e-12);
  // The upper arms hang along the torso, so they have the inclination of the torso.
  EXPECT_NEAR(Angles(q).arms[0].upper_arm_elevation, 0.7, 1e-12);
  EXPECT_NEAR(Angles(q).arms[0].upper_arm_flexion, 0, 1e-12);
  q.setZero();
  q[kTorsoLateral] = 0.2;
  q[kNeckLateral] = 0.1;
  EXPECT_NEAR(Angles(q).trunk_side_bend, 0.2, 1e-12);
  EXPECT_LT((Place(kModel, q).p[kNeckTwist]).y(), -0.05);  // to the right
  EXPECT_EQ(Angles(q).neck_side_bend, 0.1);
  q.setZero();
  q[kTorsoTwist] = 0.3;
  EXPECT_EQ(Angles(q).trunk_twist, 0.3);
  // the left shoulder moves back
  EXPECT_LT((Place(kModel, q).p[Of(0, ArmJoint::kElbowFlexion)]).x(), 0);
}

// A mirrored posture must have mirrored angles.
TEST(PostureAngles, MirrorWithThePosture) {
  RandomStream random(1, "mirror");
  for (int i = 0; i < 100; ++i) {
    const BodyVector q = RandomPosture(kModel, &random);
    BodyVector mirrored = q;
    for (const int joint :
         {kPelvisY, kPelvisYaw, kPelvisList, kTorsoLateral, kTorsoTwist, kNeckLateral, kNeckTwist})
      mirrored[joint] = -q[joint];
    mirrored.segment<kArmJoints>(kLeftArm) = q.segment<kArmJoints>(kRightArm);
    mirrored.segment<kArmJoints>(kRightArm) = q.segment<kArmJoints>(kLeftArm);
    std::map<std::string, double> expected;
    PostureAngles a = Angles(q), b = Angles(mirrored);
    ForEachAngle(a, [&](std::string name, double& value) {
      if (name.starts_with("left_"))
        name.replace(0, 4, "right");
      else if (name.starts_with("right_"))
        name.replace(0, 5, "left");
      const bool changes =
          name.ends_with("side_bend") || name == "trunk_twist" || name == "neck_twist";
      expected[name] = changes ? -value : value;
    });
    ForEachAngle(b, [&](const std::string& name, double& value) {
      EXPECT_NEAR(value, expected.at(name), 1e-9) << name;
    });
  }
}

}  // namespace
}  // namespace predictor::person
