// Finds the arm in the model of a robot, without its gripper and other parts that move.
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

// `end_effector` is the link that is to carry the object. If it is empty, the link that most joints
// of an arm carry is chosen. Two kinds of joints do not count as joints of an arm. The first are
// the joints of grippers: joints with such a name, and joints that are coupled by mimic, if no
// joint of an arm follows. The second are all joints after a branch that is carried by
// kMinArmJoints joints or more (the fingers of a hand; a branch closer to the base leads to several
// arms). Throws InputError if there is no such link, or no joint moves it.
inline constexpr int kMinArmJoints = 4;
ArmChain FindArm(const UrdfModel& urdf, const std::string& end_effector = "");

}  // namespace predictor
