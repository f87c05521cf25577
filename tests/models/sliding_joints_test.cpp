// Compares prismatic and planar joints with closed forms. mujoco_test.cpp compares them with
// MuJoCo.
#include <gtest/gtest.h>

#include "core/error.h"
#include "models/robots.h"

namespace predictor::test {
namespace {

// Returns a mass of 12 kg on one joint. `joint` is the joint's element without parent and child.
std::string MassOn(const std::string& type, const std::string& parts) {
  return R"(<robot name="slider"><link name="rail"/>
  <link name="mass"><inertial><origin xyz="0.1 0.2 0.3"/><mass value="12"/>
    <inertia ixx="0.2" iyy="0.3" izz="0.25"/></inertial></link>
  <joint name="drive" type=")" +
         type + R"("><parent link="rail"/><child link="mass"/>)" + parts + "</joint></robot>";
}
const std::string kLimit = R"(<limit lower="-2" upper="3" velocity="1" effort="300"/>)";

std::string ErrorOf(const std::string& urdf) {
  try {
    ParseUrdf(urdf, "slider.urdf", ".");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

// The mass matrix must be M = m, and the force of the weight along the axis must be m g n_z at any
// velocity.
TEST(Prismatic, CarriesAMassAlongAnyAxis) {
  const Pose X_WB = SlantedBase();
  for (const Vector3& axis : {Vector3(0, 0, 1), Vector3(1, 0, 0), Vector3(0.3, -1, 0.2)}) {
    const std::string text = R"(<origin xyz="1 2 3" rpy="0.1 0.2 0.3"/><axis xyz=")" +
                             std::to_string(axis.x()) + " " + std::to_string(axis.y()) + " " +
                             std::to_string(axis.z()) + R"("/>)" + kLimit;
    const auto model =
        RobotModel::Build(ParseUrdf(MassOn("prismatic", text), "slider.urdf", "."), X_WB);
    ASSERT_EQ(model->dof(), 1);
    EXPECT_TRUE(model->is_prismatic(0));
    EXPECT_STREQ(model->position_unit(0), "m");
    EXPECT_STREQ(model->effort_unit(0), "N");
    const Pose X_WJ = X_WB * PoseFromXyzRpy({1, 2, 3}, {0.1, 0.2, 0.3});
    const Vector3 n = X_WJ.q * axis.normalized();
    RobotData data(*model);
    JointVector q(1), v(1);
    q << 0.7;
    v << -1.3;
    data.UpdateDynamics(*model, q, v, 9.81);
    EXPECT_NEAR(data.M()(0, 0), 12, 1e-12);
    EXPECT_NEAR(data.gravity()(0), 12 * 9.81 * n.z(), 1e-9);
    EXPECT_NEAR(data.bias()(0), 12 * 9.81 * n.z(), 1e-9);
    const FrameId frame = model->Frame("mass");
    EXPECT_LT((data.FramePose(*model, frame).p - (X_WJ.p + 0.7 * n)).norm(), 1e-12);
    EXPECT_LT((data.FrameTwist(*model, frame).head<3>() + 1.3 * n).norm(), 1e-12);
    EXPECT_LT(data.FrameTwist(*model, frame).tail<3>().norm(), 1e-12);
  }
}

TEST(Planar, IsTwoSlidesAndATurn) {
  const UrdfModel urdf = ParseUrdf(
      MassOn("planar", R"(<origin xyz="1 2 3" rpy="0 0 0.5"/><axis xyz="0 0 2"/>)" + kLimit),
      "slider.urdf", ".");
  const auto model = RobotModel::Build(urdf, SlantedBase());
  ASSERT_EQ(model->dof(), 3);
  EXPECT_EQ(model->joint_name(0), "drive_x");
  EXPECT_EQ(model->joint_name(1), "drive_y");
  EXPECT_EQ(model->joint_name(2), "drive_yaw");
  EXPECT_TRUE(model->is_prismatic(0) && model->is_prismatic(1) && !model->is_prismatic(2));
  EXPECT_EQ(model->position_lower()(1), -2);
  EXPECT_EQ(model->position_upper()(0), 3);
  EXPECT_TRUE(std::isinf(model->position_upper()(2)));
  EXPECT_EQ(model->effort_limit()(0), 300);
  EXPECT_TRUE(std::isinf(model->effort_limit()(2)));
  RobotData data(*model);
  JointVector q(3), v(3);
  q << 0.4, -0.7, 1.1;
  v << 0.2, 0.5, -0.9;
  data.UpdateDynamics(*model, q, v, 9.81);
  const Pose X_WP = SlantedBase() * PoseFromXyzRpy({1, 2, 3}, {0, 0, 0.5});
  const Pose expected = X_WP * PoseFromXyzRpy({0.4, -0.7, 0}, {0, 0, 1.1});
  const Pose X = data.FramePose(*model, model->Frame("mass"));
  EXPECT_LT((X.p - expected.p).norm(), 1e-12);
  EXPECT_LT(RotationError(X.q, expected.q).norm(), 1e-12);
  const Twist V = data.FrameTwist(*model, model->Frame("mass"));
  EXPECT_LT((V.head<3>() - X_WP.q * Vector3(0.2, 0.5, 0)).norm(), 1e-12);
  EXPECT_LT((V.tail<3>() - X_WP.q * Vector3(0, 0, -0.9)).norm(), 1e-12);
  // Each carrier weighs 1 mg.
  EXPECT_NEAR(data.M()(0, 0), 12, 3e-6);
  EXPECT_NEAR(data.M()(1, 1), 12, 3e-6);
}

// If the normal is along x (the default axis of a URDF), y of the joint's frame is the first
// direction.
TEST(Planar, OfAnUprightPlaneSlidesAlongYAndZ) {
  const auto model =
      RobotModel::Build(ParseUrdf(MassOn("planar", kLimit), "slider.urdf", "."), Pose::Identity());
  RobotData data(*model);
  JointVector q(3);
  q << 0.4, -0.7, 0;
  data.UpdateKinematics(*model, q, JointVector::Zero(3));
  EXPECT_LT((data.FramePose(*model, model->Frame("mass")).p - Vector3(0, 0.4, -0.7)).norm(), 1e-12);
}

TEST(Planar, ErrorsNameTheFilesLine) {
  EXPECT_EQ(ErrorOf(MassOn("planar", "")).rfind("slider.urdf:4: ", 0), 0U)
      << ErrorOf(MassOn("planar", ""));
  EXPECT_EQ(
      ErrorOf(MassOn("planar", R"(<axis xyz="0 0 0"/>)" + kLimit)).rfind("slider.urdf:4: ", 0), 0U);
  EXPECT_EQ(ErrorOf(MassOn("planar", R"(<limit lower="1" upper="1" velocity="1" effort="1"/>)"))
                .rfind("slider.urdf:4: Joint \"drive\" has the limits lower 1 and upper 1", 0),
            0U);
  std::string taken = MassOn("planar", kLimit);
  taken.replace(taken.find("<link name=\"rail\"/>"), 19,
                "<link name=\"rail\"/><link name=\"drive_y_link\"/>");
  EXPECT_NE(ErrorOf(taken).find("the link \"drive_y_link\" exists. Rename it."), std::string::npos)
      << ErrorOf(taken);
}

}  // namespace
}  // namespace predictor::test
