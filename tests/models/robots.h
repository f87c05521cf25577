// The robots that the model tests use.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "core/random.h"
#include "models/robot.h"
#include "models/urdf.h"
#include "scenario/paths.h"

namespace predictor::test {

// This tree has features that the arms lack. The features are continuous, revolute and prismatic
// joints along slanted axes, a branch, fixed links with and without mass, and inertias with
// products.
inline constexpr const char* kTreeUrdf = R"(<robot name="tree">
  <link name="base"><inertial><origin xyz="0.1 0 0.2"/><mass value="3"/>
    <inertia ixx="0.1" iyy="0.12" izz="0.09" ixy="0.01" ixz="-0.02" iyz="0.005"/></inertial></link>
  <link name="a"><inertial><origin xyz="0.05 -0.1 0.2" rpy="0.3 -0.5 0.7"/><mass value="2"/>
    <inertia ixx="0.05" iyy="0.04" izz="0.03" ixy="0.004" ixz="-0.002" iyz="0.001"/></inertial></link>
  <joint name="turn" type="continuous"><parent link="base"/><child link="a"/>
    <origin xyz="0.1 0.2 0.3" rpy="0.4 0.5 -0.6"/><axis xyz="1 2 -0.5"/></joint>
  <link name="plate"><inertial><origin xyz="0 0.02 0"/><mass value="0.5"/>
    <inertia ixx="0.002" iyy="0.003" izz="0.004" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="weld" type="fixed"><parent link="a"/><child link="plate"/>
    <origin xyz="0 0.1 0.3" rpy="0.2 0 1"/></joint>
  <link name="b"><inertial><origin xyz="0 0 0.1"/><mass value="1.5"/>
    <inertia ixx="0.02" iyy="0.02" izz="0.01"/></inertial></link>
  <joint name="slide" type="prismatic"><parent link="plate"/><child link="b"/>
    <origin xyz="0.1 0 0.1" rpy="-0.7 0.1 0"/><axis xyz="0.3 -1 0.2"/>
    <limit lower="-0.2" upper="0.3" velocity="1" effort="50"/></joint>
  <link name="c"><inertial><mass value="0.7"/>
    <inertia ixx="0.003" iyy="0.002" izz="0.002" ixy="0.0001"/></inertial></link>
  <joint name="default_axis" type="revolute"><parent link="b"/><child link="c"/>
    <origin xyz="0 0.3 0"/><limit lower="-2" upper="1" velocity="2" effort="20"/></joint>
  <link name="tip"/>
  <joint name="tip_joint" type="fixed"><parent link="c"/><child link="tip"/>
    <origin xyz="0 0 0.25" rpy="0 1 0"/></joint>
  <link name="branch"><inertial><origin xyz="0.2 0 0"/><mass value="0.9"/>
    <inertia ixx="0.001" iyy="0.004" izz="0.004"/></inertial></link>
  <joint name="branch_joint" type="revolute"><parent link="a"/><child link="branch"/>
    <origin xyz="0 -0.2 0.1" rpy="0 0.3 0"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" velocity="2" effort="20"/></joint>
</robot>)";

// A mobile base on a slanted plane carries a slanted lift and two rotating joints.
inline constexpr const char* kMobileUrdf = R"(<robot name="mobile">
  <link name="ground"/>
  <link name="base"><inertial><origin xyz="0.02 0 0.2"/><mass value="40"/>
    <inertia ixx="1.1" iyy="1.2" izz="0.9" ixy="0.01" ixz="-0.02" iyz="0.05"/></inertial></link>
  <joint name="drive" type="planar"><parent link="ground"/><child link="base"/>
    <origin xyz="0.1 0.2 0.3" rpy="0.4 0.5 -0.6"/><axis xyz="0.2 -0.1 1"/>
    <limit lower="-2" upper="3" velocity="1" effort="300"/></joint>
  <link name="column"><inertial><origin xyz="0 0.02 0.3"/><mass value="8"/>
    <inertia ixx="0.2" iyy="0.22" izz="0.04" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="lift" type="prismatic"><parent link="base"/><child link="column"/>
    <origin xyz="0.1 0 0.4" rpy="0.1 0 0"/><axis xyz="0.1 0 1"/>
    <limit lower="0" upper="0.4" velocity="0.1" effort="2000"/></joint>
  <link name="arm"><inertial><origin xyz="0 0 0.1"/><mass value="2"/>
    <inertia ixx="0.02" iyy="0.02" izz="0.01"/></inertial></link>
  <joint name="shoulder" type="revolute"><parent link="column"/><child link="arm"/>
    <origin xyz="0 0 0.6"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="1" velocity="2" effort="100"/></joint>
  <link name="hand"><inertial><origin xyz="0 0 0.1"/><mass value="1"/>
    <inertia ixx="0.01" iyy="0.01" izz="0.005"/></inertial></link>
  <joint name="wrist" type="continuous"><parent link="arm"/><child link="hand"/>
    <origin xyz="0 0 0.4"/><axis xyz="1 0 0.3"/></joint>
</robot>)";

struct RobotCase {
  std::string name;
  std::string uri;  // if empty, kTreeUrdf is used; may be the URDF itself
  std::vector<std::string> remove_links;
  std::string end_effector;
  int dof;
};

inline std::ostream& operator<<(std::ostream& out, const RobotCase& robot) {
  return out << robot.name;
}

inline std::vector<RobotCase> RobotCases() {
  const std::string robots = "package://example-robot-data/robots/";
  const std::string panda = robots + "panda_description/urdf/panda.urdf";
  const std::string ur = robots + "ur_description/urdf/";
  return {{"Panda", panda, {"panda_hand"}, "panda_link8", 7},
          {"PandaWithHand", panda, {}, "panda_hand_tcp", 9},
          {"UR5", ur + "ur5_robot.urdf", {}, "tool0", 6},
          {"UR10", ur + "ur10_robot.urdf", {}, "tool0", 6},
          {"Tree", "", {}, "tip", 4},
          {"Mobile", kMobileUrdf, {}, "hand", 6}};
}

inline UrdfModel UrdfOf(const RobotCase& robot) {
  if (robot.uri.empty()) return ParseUrdf(kTreeUrdf, "tree.urdf", ".");
  if (robot.uri[0] == '<') return ParseUrdf(robot.uri, "robot.urdf", ".");
  return ReadUrdf(ResolveModelPath(robot.uri, "."), robot.remove_links);
}

// Returns the pose of a base that is neither at the origin nor upright.
inline Pose SlantedBase() { return PoseFromXyzRpy({0.3, -0.4, 0.2}, {0.1, -0.2, 0.7}); }

// A robot in a random state.
class RobotTest : public testing::TestWithParam<RobotCase> {
 protected:
  RobotTest()
      : urdf(UrdfOf(GetParam())),
        model(RobotModel::Build(urdf, SlantedBase())),
        data(*model),
        n(model->dof()),
        // This frame differs from the link's origin, so that errors in lever arms affect the
        // results.
        frame(model->Frame(GetParam().end_effector,
                           PoseFromXyzRpy({0.1, -0.05, 0.2}, {0.3, 1, -2}))) {
    Shake();
  }

  JointVector RandomVector(double size) {
    JointVector x(n);
    for (int j = 0; j < n; ++j) x(j) = size * (2 * random.Uniform() - 1);
    return x;
  }

  // Draws a random state with joints within their limits and velocities up to 2.
  void Shake() {
    q.resize(n);
    for (int j = 0; j < n; ++j) {
      const double lower = std::max(-3.1, model->position_lower()(j));
      const double upper = std::min(3.1, model->position_upper()(j));
      q(j) = lower + (upper - lower) * random.Uniform();
    }
    v = RandomVector(2);
  }

  JointVector Unit(int j) const { return JointVector::Unit(n, j); }

  UrdfModel urdf;
  std::shared_ptr<const RobotModel> model;
  RobotData data;
  int n;
  FrameId frame;
  RandomStream random{1, "robot test"};
  JointVector q, v;
};

inline std::string NameOf(const testing::TestParamInfo<RobotCase>& info) { return info.param.name; }

}  // namespace predictor::test
