// Searches for postures in which a cobot can hold an object from above.
#pragma once

#include <vector>

#include "models/robot.h"

namespace predictor {

// The requirements on a posture.
struct PostureDemand {
  double mass = 0;                     // of the object [kg]
  Vector3 outward = Vector3::UnitZ();  // where the last link points (LastLinkDirection), in E
  double tilt = 0;                     // of the last link from straight down, outwards [rad]
  double lowest = 0.3;                 // least height of the end-effector above the floor [m]
};

struct InitPosture {
  double suitability = 0;  // smallest singular value of the end-effector's Jacobian
  JointVector q;
  Pose X_WE;
};

// Returns postures in which the end-effector is in front of the base and the last link has the
// demanded direction. In these postures, each joint carries the object with at most 60 % of the
// joint's effort limit. The best postures come first. Returns an empty list if no posture was
// found. The result is the same in each call.
std::vector<InitPosture> FindPostures(const RobotModel& model, const FrameId& end_effector,
                                      const PostureDemand& demand);

}  // namespace predictor
