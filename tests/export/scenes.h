// Scenes whose cobots, attachments and names differ from those of the shipped scenarios.
#pragma once

#include <filesystem>
#include <string>

#include "export/files.h"
#include "scenario/scenario.h"

namespace predictor::scene_export {

// A cobot with slanted axes, an upright pitch axis, a prismatic joint, a continuous joint and a
// branch. Some of its links and joints have names that the scene itself uses.
inline constexpr const char* kOddCobot = R"(<robot name="odd">
  <link name="world"><inertial><origin xyz="0.1 0 0.2"/><mass value="3"/>
    <inertia ixx="0.1" iyy="0.12" izz="0.09" ixy="0.01" ixz="-0.02" iyz="0.005"/></inertial></link>
  <link name="object"><inertial><origin xyz="0.05 -0.1 0.2" rpy="0.3 -0.5 0.7"/><mass value="2"/>
    <inertia ixx="0.05" iyy="0.04" izz="0.03" ixy="0.004" ixz="-0.002" iyz="0.001"/></inertial>
    <visual><geometry><cylinder radius="0.05" length="0.3"/></geometry></visual></link>
  <joint name="attachment" type="continuous"><parent link="world"/><child link="object"/>
    <origin xyz="0.1 0.2 0.3" rpy="0.4 1.5707963267948966 -0.6"/><axis xyz="1 2 -0.5"/></joint>
  <link name="cobot_object"><inertial><mass value="0.5"/>
    <inertia ixx="0.002" iyy="0.003" izz="0.004" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="attachment_x" type="prismatic"><parent link="object"/><child link="cobot_object"/>
    <origin xyz="0 0.1 0.3" rpy="0.2 -1.5707963267948966 1"/><axis xyz="0.3 -1 0.2"/>
    <limit lower="-0.2" upper="0.3" velocity="1" effort="50"/></joint>
  <link name="tip"/>
  <joint name="tip" type="fixed"><parent link="cobot_object"/><child link="tip"/>
    <origin xyz="0 0 0.25" rpy="0 1 0"/></joint>
  <link name="branch"><inertial><origin xyz="0.2 0 0"/><mass value="0.9"/>
    <inertia ixx="0.001" iyy="0.004" izz="0.004"/></inertial></link>
  <joint name="branch_joint" type="revolute"><parent link="object"/><child link="branch"/>
    <origin xyz="0 -0.2 0.1" rpy="0 0.3 0"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" velocity="2" effort="20"/></joint>
</robot>)";

// The object has two links whose axes are not parallel to any other axis.
inline constexpr const char* kOddObject = R"(<robot name="lopsided">
  <material name="red"><color rgba="1 0 0 0.5"/></material>
  <link name="a"><inertial><origin xyz="0.1 -0.2 0.05" rpy="0.3 0.2 0.1"/><mass value="2"/>
    <inertia ixx="0.05" iyy="0.04" izz="0.03" ixy="0.004" ixz="-0.002" iyz="0.001"/></inertial>
    <visual><geometry><sphere radius="0.1"/></geometry><material name="red"/></visual>
    <collision><geometry><sphere radius="0.1"/></geometry></collision></link>
  <link name="b"><inertial><origin xyz="0 0 0.3"/><mass value="1"/>
    <inertia ixx="0.01" iyy="0.02" izz="0.015" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><origin xyz="0 0 0.1"/><geometry><box size="0.1 0.2 0.3"/></geometry></visual></link>
  <joint name="weld" type="fixed"><parent link="a"/><child link="b"/>
    <origin xyz="0.2 0.1 0" rpy="1 -0.5 0.3"/></joint></robot>)";

inline Scenario OddScene(const std::filesystem::path& folder, JointType joint) {
  Write(folder / "cobot.urdf", kOddCobot);
  Write(folder / "object.urdf", kOddObject);
  Scenario s;
  s.file = folder / "odd.yaml";
  s.cobot.model = "cobot.urdf";
  s.cobot.base = {{0.3, -0.2, 0.7}, {0.1, M_PI / 2, -0.4}};
  s.cobot.end_effector = "tip";
  s.cobot.effort_limit = {30, 40, 50};
  s.cobot.joint_friction.viscous = {0.5, 0.6, 0.7};
  s.cobot.joint_friction.coulomb = {0.1};
  s.object.model = "object.urdf";
  s.object.attachment.joint = joint;
  s.object.attachment.on_end_effector = {{0.1, 0.02, -0.03}, {0.5, -M_PI / 2, 0.2}};
  s.object.attachment.on_object = {{0.05, 0.1, 0.1}, {-0.3, M_PI / 2, 0.8}};
  s.object.attachment.axis = {1, -2, 0.5};
  s.object.attachment.damping = 0.3;
  s.left_handle = HandleSpec{{{0.1, 0.05, 0.02}, {0.3, -0.2, 0.5}}};
  s.environment.table = TableSpec{{0.8, 1.2, 0.05}, {0.5, 0, 0.2}};
  for (const FixtureShape shape :
       {FixtureShape::kBox, FixtureShape::kCylinder, FixtureShape::kCapsule, FixtureShape::kSphere,
        FixtureShape::kPlane}) {
    FixtureSpec fixture;
    fixture.shape = shape;
    fixture.size = {0.2, 0.3, 0.4};
    fixture.xyz = {2.0 + static_cast<double>(s.environment.fixtures.size()), -1, 0.5};
    fixture.rpy = {0.3, -0.4, 1.2};
    s.environment.fixtures.push_back(fixture);
  }
  s.environment.gravity = 1.62;
  return s;
}

}  // namespace predictor::scene_export
