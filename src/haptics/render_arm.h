// The input of haptic rendering in a tick: the state of the arms, and the target of the handles.
#pragma once

#include <array>

#include "core/messages.h"
#include "models/robot.h"

namespace predictor {

// Target motion of the handles.
struct RenderTarget {
  std::array<FrameMotion, kHands> handle;  // virtual handles D
  double speed_cap = 0;                    // of a handle [m/s]
  double rotation_cap = 0;                 // [rad/s]
  bool aligning = false;                   // ALIGN: no lead, separate gains
};

// The model, the state and the handle of one arm, for rendering.
struct RenderArm {
  bool present = false;
  const RobotModel* model = nullptr;
  const RobotData* data = nullptr;   // kinematics at the measured (q, v)
  const RobotData* ahead = nullptr;  // kinematics at the time when the arm obeys the command
  FrameId handle;                    // H
  const JointVector* q = nullptr;    // measured [rad]
};

}  // namespace predictor
