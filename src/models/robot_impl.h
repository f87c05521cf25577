// Defines the data members of RobotModel and RobotData.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

#include "models/rigid_body_engine.h"
#include "models/robot.h"

namespace predictor {

struct RobotModel::Impl {
  EngineModel engine;
  Pose X_WB;
  std::string name;
  std::vector<std::string> joint_names, link_names;
  std::vector<bool> prismatic;  // whether each joint is prismatic
  JointVector lower, upper, velocity, effort;
  double mass = 0;  // [kg]
  std::unordered_map<std::string, FrameId> links;
  std::array<std::uint32_t, kMaxJoints + 1> support = {};  // for each body, the joints that move it
};

struct RobotData::Impl {
  EngineState state;
};

}  // namespace predictor
