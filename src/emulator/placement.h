// Finds joint positions at which the handles of the arms have given poses.
#pragma once

#include <array>
#include <memory>

#include "models/robot.h"
#include "scenario/scenario.h"

namespace predictor {

// Returns the joint positions of each arm (empty for absent sides) that place the handle H `offset`
// [m] above and behind X_WD. Throws InputError, which names the arm that cannot reach this pose and
// states the remedy.
std::array<JointVector, kHands> PlaceArms(
    const Scenario& scenario, const std::array<std::shared_ptr<const RobotModel>, kHands>& models,
    const std::array<FrameId, kHands>& handles, const std::array<Pose, kHands>& X_WD,
    double offset);

// Places one arm, starting from the arm's posture. Returns false if the arm cannot reach the pose,
// in which case q is the nearest solution found.
bool PlaceArm(const ArmSpec& spec, const RobotModel& model, const FrameId& handle, const Pose& X_WD,
              double offset, JointVector* q);

// Loads the model of a hand's arm. Throws InputError for a key of the scenario whose links or
// joints do not fit the model.
std::shared_ptr<const RobotModel> LoadArm(const Scenario& scenario, int hand);

// Returns joint positions from a list in a scenario. If the list is empty, each joint is in the
// middle of its range. For this purpose, the range is limited to ±3.
JointVector StartingJoints(const ArmSpec& spec, const RobotModel& model);

}  // namespace predictor
