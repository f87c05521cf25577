// What haptic rendering is told in a tick: the arms as they are, and where the handles should go.
#pragma once

#include <array>

#include "core/messages.h"
#include "models/robot.h"

namespace predictor {

// Where rendering should bring the handles.
struct RenderTarget {
  std::array<FrameMotion, kHands> handle;  // virtual handles D
  double speed_cap = 0;                    // of a handle [m/s]
  double rotation_cap = 0;                 // [rad/s]
  bool aligning = false;                   // ALIGN: no lead, gains of its own
};

// One arm as rendering sees it: model, state, handle.
struct RenderArm {
  bool present = false;
  const RobotModel* model = nullptr;
  const RobotData* data = nullptr;   // UpdateKinematics done at the measured (q, v)
  const RobotData* ahead = nullptr;  // the same where the arm will be when it obeys the command
  FrameId handle;                    // H
  const JointVector* q = nullptr;    // measured [rad]
};

}  // namespace predictor
