// One simulated arm with its sensor and handle: what Rig is made of.
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
  // dt: step [s]. Throws InputError.
  SimulatedArm(const Scenario& scenario, int hand, const JointVector& start, double dt);

  // Takes a new command [rad/s]; refuses one that is not finite or not one number a joint.
  void Command(const JointVector& v) noexcept;
  // One step: moves the joints and the handle.
  void Move() noexcept;
  // At the same instant: what the sensor measures of the hand's wrench F_H_W and the handle's load.
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
  JointVector q_, v_, a_;  // true joints
  JointVector q_measured_, v_measured_;
  JointVector command_;       // as the watchdog lets it through
  JointVector acceleration_;  // limits [rad/s²]
  double since_command_ = 0;  // [s]
  bool fault_ = false;
  FrameMotion handle_, sensor_frame_;
  Jacobian J_;
  ForceSensor sensor_;
  RandomStream velocity_noise_;
  std::uint64_t sequence_ = 0;
};

}  // namespace predictor
