// Loads a robot that a user describes and checks that the description fits the model.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "models/robot.h"
#include "scenario/scenario.h"

namespace predictor {

// Converts `posture` [rad], [m] to joint positions of `model`. Throws InputError at `key` if the
// number of values differs from the number of joints. Throws InputError at `key` with the joint's
// number (from 0) if a joint is beyond its limits.
JointVector PostureOf(const std::vector<double>& posture, const RobotModel& model,
                      const std::string& key);

// Loads the model of a scenario's cobot, with its base in W. Throws InputError at the invalid key
// within "cobot".
std::shared_ptr<const RobotModel> LoadCobotModel(const Scenario& scenario);

// Returns the effort limit of each joint, from cobot.effort_limit or otherwise from the model [N·m]
// (prismatic joints: [N]). Throws InputError if the number of values does not fit.
JointVector EffortLimit(const CobotSpec& spec, const RobotModel& robot);

// Returns, for each joint of the cobot, whether the joint is prismatic. Throws InputError if the
// cobot's model cannot be loaded.
std::vector<bool> PrismaticJoints(const Scenario& scenario);

// Refuses an angle for a prismatic joint and a length for a revolute joint, in the list at `key` of
// the tree from which a scenario was read. Throws InputError at the entry.
void CheckPostureUnits(const YamlNode& tree, const RobotModel& model, const std::string& key);

// Loads the model of an arm and checks its links and posture. `base` is the pose of the arm's base
// in the frame that the model uses. The frame of `base` is W for an emulation (Scenario::X_WB) and
// the rig's frame R for commissioning (BaseSpec::X_RB). Relative paths are resolved from `folder`.
// Throws InputError at the invalid key within `key` ("device.arms.left").
std::shared_ptr<const RobotModel> LoadArmModel(const ArmSpec& spec, const Pose& base,
                                               const std::filesystem::path& folder,
                                               const std::string& key);

}  // namespace predictor
