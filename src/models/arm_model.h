// A robot as a person wrote of it: whether what was written fits its model.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "models/robot.h"
#include "scenario/scenario.h"

namespace predictor {

// `posture` [rad], [m] as the joints of `model`. Throws InputError at `key` (of a joint: with its
// number from 0): it has not one value a joint, or a joint is beyond its limits.
JointVector PostureOf(const std::vector<double>& posture, const RobotModel& model,
                      const std::string& key);

// The model of an arm, whose links and posture fit it. `folder`: where relative paths start. Throws
// InputError at the key that does not, within `key` ("device.arms.left").
std::shared_ptr<const RobotModel> LoadArmModel(const ArmSpec& spec,
                                               const std::filesystem::path& folder,
                                               const std::string& key);

}  // namespace predictor
