// One simulated arm with its sensor and handle. Rig consists of these.
#pragma once

#include <memory>
#include <vector>

#include "core/archive.h"
#include "core/messages.h"
#include "models/robot.h"
#include "rig/force_sensor.h"
#include "rig/velocity_loop.h"
#include "scenario/scenario.h"

namespace predictor {

class SimulatedArm {
 public:
  // `dt` is the step [s]. Throws InputError.
  SimulatedArm(const Scenario& scenario, int hand, const JointVector& start, double dt);

  // Takes a new command [rad/s]. Ignores a command that is not finite or has the wrong number of
  // joints.
  void Command(const JointVector& v) noexcept;
  // Advances the joints and the handle by one step.
  void Move() noexcept;
  // Measures, at the same instant, the hand's wrench F_H_W and the handle's load.
  void Sense(const Wrench& F_H_W) noexcept;

  void Read(ArmSample* sample) noexcept;
  void Archive(StateArchive& a) noexcept;

  const FrameMotion& handle() const { return handle_; }  // true motion of H

 private:
  void UpdateKinematics() noexcept;
  void Measure() noexcept;
  Wrench SensorWrench(const Wrench& F_H_W) const noexcept;

  ArmSpec spec_;
  RigSpec rig_;
  double gravity_, dt_;
  Pose X_ES_, X_EH_;
  std::shared_ptr<const RobotModel> model_;
  FrameId end_effector_;
  RobotData data_;
  std::vector<VelocityLoop> loops_;
  JointVector q_, v_, a_;  // true joint positions, velocities and accelerations
  JointVector q_measured_, v_measured_;
  JointVector command_;       // command as modified by the watchdog
  JointVector acceleration_;  // acceleration limits [rad/s²]
  double since_command_ = 0;  // time since the last command [s]
  bool fault_ = false;
  FrameMotion handle_, sensor_frame_;
  ForceSensor sensor_;
  RandomStream velocity_noise_;
  std::uint64_t sequence_ = 0;
};

}  // namespace predictor
