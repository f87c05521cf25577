// The last link of real robots must point out of the flange or the hand, as their makers draw it.
#include "models/last_link.h"

#include <gtest/gtest.h>

#include "models/arm_chain.h"
#include "models/robots.h"

namespace predictor {
namespace {

struct Direction {
  const char *urdf, *link;
  Vector3 outward;          // in the axes of this link, from the drawing in the URDF
  double tolerance = 1e-6;  // [rad]
};

TEST(LastLink, PointsOutOfTheFlange) {
  const std::string robots = "package://example-robot-data/robots/";
  const Direction cases[] = {
      {"panda_description/urdf/panda.urdf", "panda_link8", {0, 0, 1}},
      {"ur_description/urdf/ur5_robot.urdf", "tool0", {0, 0, 1}},
      {"ur_description/urdf/ur5_robot.urdf", "ee_link", {1, 0, 0}},
      {"z1_description/urdf/z1.urdf", "gripperStator", {1, 0, 0}},
      {"baxter_description/urdf/baxter.urdf", "left_gripper", {0, 0, 1}},
      {"kinova_description/robots/kinova.urdf", "j2s6s200_end_effector", {1, 0, 0}},
      // The fingertips of this gripper are 5° off the axis of its last joint.
      {"so_arm_description/urdf/so101.urdf", "gripper_frame_link", {0, 0, 1}, 0.1},
      // Each of the following frames is at the origin of its joint.
      {"xarm_description/urdf/xarm7.urdf", "link7", {0, 0, 1}},
      {"xarm_description/urdf/xarm7.urdf", "link_eef", {0, 0, 1}},
      {"so_arm_description/urdf/so100.urdf", "gripper", {0, -1, 0}}};
  for (const Direction& c : cases) {
    const UrdfModel all = ReadUrdf(ResolveModelPath(robots + c.urdf, "."));
    const auto model =
        RobotModel::Load({robots + c.urdf, ".", FindArm(all, c.link).remove_links, {}});
    const Vector3 outward = LastLinkDirection(*model, model->Frame(c.link));
    EXPECT_NEAR(outward.norm(), 1, 1e-12) << c.urdf;
    EXPECT_LE(std::atan2(outward.cross(c.outward).norm(), outward.dot(c.outward)),
              c.tolerance + 1e-5)  // the files' angles are rounded
        << c.urdf << ", " << c.link << ": " << outward.transpose();
  }
}

// The last link of this arm is bent, so only its centre of mass shows where it points.
TEST(LastLink, PointsToTheCentreOfMassOfALinkThatBends) {
  const UrdfModel urdf = ParseUrdf(R"(<robot name="arm"><link name="base"/>
    <link name="hand"><inertial><origin xyz="0.02 0.2 0"/><mass value="1"/>
      <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial></link>
    <joint name="wrist" type="revolute"><parent link="base"/><child link="hand"/>
      <origin xyz="0 0 0.5"/><axis xyz="1 0 0"/>
      <limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>)",
                                   "arm.urdf", ".");
  const auto model = RobotModel::Build(urdf, {});
  EXPECT_LT((LastLinkDirection(*model, model->Frame("hand")) - Vector3(0, 1, 0)).norm(), 1e-12);
}

}  // namespace
}  // namespace predictor
