// The file of a machine with two arms, and variations of it.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "core/error.h"
#include "scenario/machine.h"

namespace predictor {

inline constexpr const char* kMachine = R"(predictor_machine: 1
name: Two UR5
arms:
  left:
    connection: {make: ur, host: 192.0.2.10}
    sensor: {make: net_ft, host: 192.0.2.20}
    arm:
      model: package://example-robot-data/robots/ur_description/urdf/ur5_robot.urdf
      end_effector: tool0
      elbow: forearm_link
      sample_rate: 500
  right:
    connection: {make: franka, host: 192.0.2.11}
    arm:
      model: package://example-robot-data/robots/panda_description/urdf/panda.urdf
      end_effector: panda_link8
      elbow: panda_link4
limits: {force: 25, handle_speed: 0.2}
)";

// Returns `text` with its first `what` replaced by `by`.
inline std::string With(std::string text, const std::string& what, const std::string& by) {
  const auto at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), by);
}

// Returns the error when the machine is parsed, or "" if it is accepted.
inline std::string MachineRefusal(const std::string& text) {
  try {
    ParseMachine(text, "lab.yaml");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace predictor
