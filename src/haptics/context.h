// The data that is available to a task or a limit of rendering: the setup of a run and the state of
// a tick.
#pragma once

#include <array>
#include <memory>

#include "core/messages.h"
#include "haptics/render_arm.h"
#include "models/arm_limits.h"
#include "models/robot.h"
#include "scenario/formulation.h"
#include "scenario/scenario.h"

namespace predictor {

// Constant during a run. Tasks and limits are created from this setup.
struct RenderSetup {
  // Each of the `models` has a handle frame. The entries of absent sides are null. The values lead
  // and dt are in [s]. Throws InputError.
  RenderSetup(const Scenario& scenario,
              const std::array<std::shared_ptr<const RobotModel>, kHands>& models, double lead,
              double dt);

  const Scenario& scenario;
  std::array<std::shared_ptr<const RobotModel>, kHands> models;
  std::array<ArmLimits, kHands> limits;  // empty for an absent side
  int joints = 0;                        // of both arms
  double lead;                           // `rendering.lead`, resolved from `auto` [s]
  double dt;                             // tick [s]
  RepairSet repairs;                     // of the paper's formulation
};

// State of one tick. The joints of both arms, left before right, are the variables x of the QP.
struct RenderContext {
  RenderContext() = default;
  // `last` contains the last joint velocities that were sent [rad/s]. Does not use the heap or
  // throw.
  RenderContext(const std::array<RenderArm, kHands>& arms, const RenderTarget& target,
                const std::array<JointVector, kHands>& last, double dt) noexcept;

  bool Has(int hand) const { return arms[hand].present; }

  std::array<RenderArm, kHands> arms;
  std::array<Jacobian, kHands> J;       // of the handles, axes of W; no columns for an absent side
  std::array<Pose, kHands> X_WH;        // measured poses of the handles
  std::array<Pose, kHands> X_WH_ahead;  // poses of the handles after the arms' delay
  std::array<int, kHands> offset = {};  // index of each arm's first joint in x
  int joints = 0;                       // of both arms
  RenderTarget target;
  std::array<JointVector, kHands> last;  // [rad/s]
  double dt = 0;                         // [s]
};

}  // namespace predictor
