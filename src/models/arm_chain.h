// Finds the arm in the model of a robot, without the robot's gripper and other parts that move.
#pragma once

#include <string>
#include <vector>

#include "models/urdf.h"

namespace predictor {

// The joints between the base and an end-effector.
struct ArmChain {
  std::string end_effector;               // link
  std::vector<std::string> joints;        // movable joints, from the base outwards
  std::vector<std::string> remove_links;  // links that other joints move (see RobotSource)
  double removed_mass = 0;                // mass of these links and all attached to them [kg]
};

// `end_effector` is the link that will carry the object. If `end_effector` is empty, the link that
// is carried by the largest number of an arm's joints is chosen. Two kinds of joints are not
// treated as joints of an arm. The first kind is the joints of grippers. A joint belongs to a
// gripper if its name says so or if it is coupled by mimic, and if no joint of an arm follows it.
// The second kind is all joints after a branch that is carried by at least kMinArmJoints joints.
// The second kind leads to the fingers of a hand. A branch closer to the base leads to several arms
// instead. Throws InputError if the link does not exist or if no joint moves the link.
inline constexpr int kMinArmJoints = 4;
ArmChain FindArm(const UrdfModel& urdf, const std::string& end_effector = "");

}  // namespace predictor
