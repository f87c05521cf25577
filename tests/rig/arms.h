// Scenarios with Pandas for the tests of the rig, the device and the sensing.
#pragma once

#include <array>
#include <optional>

#include "scenario/scenario.h"

namespace predictor {

inline constexpr const char* kPanda =
    "package://example-robot-data/robots/panda_description/urdf/panda.urdf";

inline ArmSpec PandaArm(double y) {
  ArmSpec arm;
  arm.model = kPanda;
  arm.remove_links = {"panda_hand"};
  arm.base.xyz = {0, y, 0};
  arm.end_effector = "panda_link8";
  arm.handle.xyz = {0, 0, 0.1};
  arm.handle.rpy = {3.14159265, 0, -0.78539816};
  arm.sensor.pose.xyz = {0, 0, 0.02};
  arm.sensor.pose.rpy = {0.1, -0.2, 0.5};
  arm.elbow = "panda_link4";
  return arm;
}

// Returns two arms (or the left one) with a person who does nothing.
inline Scenario ArmScenario(int arms) {
  Scenario scenario;
  HandleSpec left, right;
  left.pose.xyz = {0, 0.3, 0};
  right.pose.xyz = {0, -0.3, 0};
  scenario.left_handle = left;
  scenario.device.left = PandaArm(0.3);
  if (arms == 2) {
    scenario.right_handle = right;
    scenario.device.right = PandaArm(-0.3);
  }
  return scenario;
}

inline std::array<JointVector, kHands> ArmStart(int arms) {
  JointVector q(7);
  q << 0.1, -0.4, 0.2, -2.1, 0.1, 1.8, 0.6;
  std::array<JointVector, kHands> start;
  start[0] = q;
  if (arms == 2) start[1] = q;
  return start;
}

// Removes noise, quantisation and bias, and makes the sensor respond immediately.
inline void MakeExact(Scenario* scenario) {
  scenario->rig.encoder_resolution = scenario->rig.velocity_noise = 0;
  scenario->rig.sensor_bias.fill(0);
  for (std::optional<ArmSpec>* arm : {&scenario->device.left, &scenario->device.right}) {
    if (!*arm) continue;
    SensorSpec& sensor = (*arm)->sensor;
    sensor.noise_force = sensor.noise_torque = sensor.force_resolution = sensor.torque_resolution =
        0;
    sensor.cutoff_frequency = sensor.delay = 0;
  }
}

}  // namespace predictor
