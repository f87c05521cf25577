// A checked URDF as text that MuJoCo loads as it is meant.
#pragma once

#include <string>

#include "models/urdf.h"

namespace predictor {

enum class MujocoShapes { kNone, kCollisions };

// The URDF for mj_parseXMLString, angles in radians. kNone leaves out all shapes (a cobot needs no
// contact, and MuJoCo does not read every mesh format); kCollisions keeps those of <collision>.
// Fixed links stay bodies of their own (fusestatic off), so that frames and the base's mass are
// kept; the root link is a body too, the only child of MuJoCo's world. Links keep their names, but
// one named "world", MuJoCo's own name, becomes "world_link". Nothing is guessed: inertia never
// comes from shapes; damping and friction in the file are dropped (the scenario gives joint
// friction); effort limits become the joints' actuator-force range. Joints keep their names and
// RobotModel's order.
std::string MujocoUrdf(const UrdfModel& urdf, MujocoShapes shapes = MujocoShapes::kNone);

}  // namespace predictor
