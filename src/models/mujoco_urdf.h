// Converts a checked URDF to text that MuJoCo loads with the same meaning.
#pragma once

#include <string>

#include "models/urdf.h"

namespace predictor {

enum class MujocoShapes { kNone, kCollisions };

// Returns the URDF for mj_parseXMLString, with angles in radians. The value kNone omits all shapes,
// because a cobot needs no contact and MuJoCo does not read every mesh format. The value
// kCollisions keeps the <collision> shapes. Fixed links remain separate bodies (fusestatic is off),
// so that their frames and the mass of the base are preserved. The root link also becomes a body,
// which is the only child of MuJoCo's world. Links keep their names, except that "world", which
// MuJoCo reserves, becomes "world_link". Inertia is never computed from shapes. Damping and
// friction in the file are dropped, because the scenario specifies joint friction. Effort limits
// become the joints' actuator-force range. The joints keep their names, and their order is that of
// RobotModel.
std::string MujocoUrdf(const UrdfModel& urdf, MujocoShapes shapes = MujocoShapes::kNone);

}  // namespace predictor
