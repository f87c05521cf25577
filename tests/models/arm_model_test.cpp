// Checks a user's description of an arm against the arm's model.
#include "models/arm_model.h"

#include <gtest/gtest.h>

#include "core/error.h"

namespace predictor {
namespace {

ArmSpec Panda() {
  ArmSpec arm;
  arm.model = "package://example-robot-data/robots/panda_description/urdf/panda.urdf";
  arm.remove_links = {"panda_hand"};
  arm.end_effector = "panda_link8";
  arm.elbow = "panda_link4";
  arm.posture = {0, -0.5, 0, -2.3, 0, 1.8, 0.785};
  return arm;
}

std::string Refusal(const ArmSpec& arm) {
  try {
    LoadArmModel(arm, arm.base.X_RB(), {}, "arm");
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).rfind(error.key(), 0), 0u) << error.what();
    return error.what();
  }
  return "";
}

TEST(ArmModel, HasTheNamedLinksAndPosture) {
  ArmSpec arm = Panda();
  EXPECT_EQ(Refusal(arm), "");
  arm.posture.clear();
  EXPECT_EQ(Refusal(arm), "");
  arm.posture = {0, 1};
  EXPECT_EQ(Refusal(arm),
            "arm.posture has 2 values; the arm has 7 joints. Give one value per joint in rad.");
  arm = Panda();
  arm.elbow = "panda_lnk4";
  EXPECT_NE(Refusal(arm).find("arm.elbow: \"panda_lnk4\" is not a link"), std::string::npos);
  arm = Panda();
  arm.end_effector = "tool0";
  EXPECT_NE(Refusal(arm).find("arm.end_effector: \"tool0\" is not a link"), std::string::npos);
}

// The Panda's fingers are sliding joints.
TEST(ArmModel, RefusesAHapticArmWithASlidingJoint) {
  ArmSpec arm = Panda();
  arm.remove_links.clear();
  arm.posture.clear();
  EXPECT_EQ(Refusal(arm).rfind("arm.model: joint \"panda_finger_joint1\" is prismatic, but the "
                               "joints of a haptic arm must be revolute",
                               0),
            0U)
      << Refusal(arm);
}

TEST(ArmModel, RefusesAPostureBeyondItsLimitsAndSeesDegrees) {
  ArmSpec arm = Panda();
  arm.posture[3] = -90;
  EXPECT_EQ(
      Refusal(arm),
      "arm.posture.3: joint \"panda_joint4\" at -90 rad is outside its limits, -3.0718 to -0.0698 "
      "rad. Give a value within the limits. A number without a unit is in rad. For degrees, write "
      "-90 deg.");
  arm.posture[3] = 0.5;
  EXPECT_EQ(Refusal(arm).find("degrees"), std::string::npos) << Refusal(arm);
  EXPECT_NE(Refusal(arm).find("0.5 rad is outside its limits"), std::string::npos);
}

}  // namespace
}  // namespace predictor
