// The rows of the joints of both arms: torque, the part of it that the hands' forces cause, the
// share of people who are strong enough, and stiffness.
#pragma once

#include <string>
#include <vector>

#include "assessment/quantities.h"

namespace predictor::assessment {

struct Assessment;

// Group of the torques.
inline constexpr const char* kJointTorques = "Joint torque";

// Returns the rows of the table of quantities for the joints of both arms, marked `of_joint`. Each
// group contains one quantity of all joints that have this quantity:
// - the magnitude of the torque [N·m]
// - the magnitude of the part of this torque that the hands' wrenches cause [N·m]
// - the share of people of the operator's sex who are strong enough for the torque (flexion of
//   shoulder and elbow only, because the program knows no strength of the other joints)
// - the stiffness [N·m/rad] that the muscles give to the joint while the other joints do not move
//   (nominal person only; see muscles::JointStiffness)
// The values of a raised shoulder (see IsRaised) are not a number.
std::vector<QuantityKind> JointQuantities();

// Returns the joint quantities of an assessment as a table with a heading, in which a row is a
// joint and a column is a group. A cell contains the tail and its 90 % interval.
std::vector<std::vector<std::string>> JointTable(const Assessment& a);
// Returns the explanation of this table.
std::string JointTableWords();

}  // namespace predictor::assessment
