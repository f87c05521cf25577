// Haptic rendering: joint velocities that make the real handles follow the virtual ones, by a QP.
#pragma once

#include <array>
#include <memory>

#include "core/messages.h"
#include "models/robot.h"
#include "scenario/scenario.h"

namespace predictor {

// Where rendering should bring the handles.
struct RenderTarget {
  std::array<FrameMotion, kHands> handle;  // virtual handles; A_W is the lead's acceleration
  double speed_cap = 0;                    // of a handle [m/s]
  double rotation_cap = 0;                 // [rad/s]
  bool lead = true;                        // false while aligning
};

// One arm as rendering sees it: model, state, frames.
struct RenderArm {
  bool present = false;
  const RobotModel* model = nullptr;
  const RobotData* data = nullptr;  // UpdateKinematics done at the measured (q, v)
  FrameId handle;                   // H
  const JointVector* q = nullptr;
};

class Renderer {
 public:
  Renderer(const Scenario& scenario, const std::array<std::shared_ptr<const RobotModel>, kHands>& models,
           const std::array<FrameId, kHands>& handles, double lead, double dt);
  ~Renderer();

  // kQp only after three ticks without a verified solution, kTracking when the relative slack
  // stays above its limit. `last`: the command last sent. No heap, lock or exception.
  Status Render(const std::array<RenderArm, kHands>& arms, const RenderTarget& target,
                const std::array<JointVector, kHands>& last, RenderResult* result) noexcept;
  void Reset() noexcept;

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace predictor
