// Where the real arms stand when their handles are at given poses.
#pragma once

#include <array>
#include <memory>

#include "models/robot.h"
#include "scenario/scenario.h"

namespace predictor {

// Joints of each arm (absent sides empty) that bring handle H to X_WD, `offset` [m] above and
// behind it. Throws InputError naming the arm that cannot reach and what to change.
std::array<JointVector, kHands> PlaceArms(
    const Scenario& scenario, const std::array<std::shared_ptr<const RobotModel>, kHands>& models,
    const std::array<FrameId, kHands>& handles, const std::array<Pose, kHands>& X_WD,
    double offset);

// The same for one arm, out of the arm's posture. Returns whether it can; if not, q is the nearest
// that was found.
bool PlaceArm(const ArmSpec& spec, const RobotModel& model, const FrameId& handle, const Pose& X_WD,
              double offset, JointVector* q);

// Model of the arm of a hand; what the scenario says of its links and joints fits it. Throws
// InputError at the key that does not.
std::shared_ptr<const RobotModel> LoadArm(const Scenario& scenario, int hand);

// Joints from a list in a scenario; zero (or the middle of the range) where the list is empty.
JointVector StartingJoints(const ArmSpec& spec, const RobotModel& model);

}  // namespace predictor
