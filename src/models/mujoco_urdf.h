// A checked URDF as text that MuJoCo loads as it is meant.
#pragma once

#include <string>

#include "models/urdf.h"

namespace predictor {

// The URDF for mj_parseXMLString (or mj_loadXML through a virtual file), all angles in radians.
// No shapes: a cobot's bodies need no contact, and MuJoCo does not read every mesh format. Fixed
// links stay bodies of their own (fusestatic off), so that frames and the base's mass are kept; the
// root link is a body too, with its name. Nothing is guessed: inertia never comes from shapes,
// damping and friction in the file are dropped (the scenario gives joint friction), effort limits
// become the joints' actuator-force range. Joints keep their names; MuJoCo's order of joints is
// that of RobotModel.
std::string MujocoUrdf(const UrdfModel& urdf);

}  // namespace predictor
