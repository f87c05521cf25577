// Finds the direction in which the last link of a robot points.
#pragma once

#include "core/types.h"
#include "models/robot.h"

namespace predictor {

// Returns the direction in which the last link points outwards, as a unit vector in the axes of
// `frame`, a frame fixed to that link. The result is the direction from the origin of the last
// joint to the frame. If the frame is at this origin and the last joint turns a flange, the result
// is the axis of this joint, away from the joint before it. If the frame is at this origin and the
// last joint bends, the result is the direction to the link's centre of mass. For a frame fixed to
// the base, the result is the frame's z axis.
Vector3 LastLinkDirection(const RobotModel& model, const FrameId& frame);

}  // namespace predictor
