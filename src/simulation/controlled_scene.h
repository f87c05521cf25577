// The scene and the controller of its cobot: what acts in it without the hands.
#pragma once

#include <memory>

#include "models/robot.h"
#include "simulation/controller.h"
#include "simulation/scene.h"

namespace predictor {

// The controller sees the robot alone (RobotModel), the world is simulated on the scene's model.
// With the load's inertia in Λ, damping is too large for the wrist and a heavy box makes a
// simulation of 1 ms steps unstable.
class ControlledScene {
 public:
  explicit ControlledScene(const Scenario& scenario);  // throws InputError

  mjModel* model() const { return scene_.model.get(); }
  const Scene& scene() const { return scene_; }
  const RobotModel& robot() const { return *robot_; }
  const JointVector& posture() const { return posture_; }
  const JointVector& effort_limit() const { return effort_limit_; }  // [N·m]

  // Position- and velocity-dependent quantities of `data` and of the cobot at its qpos and qvel;
  // the functions below refer to it. False on an error of the engine.
  bool Update(mjData* data) noexcept;

  // The controller's torques at time t [s], limited by the joints' effort limits [N·m], written
  // into qfrc_applied. False if they are not finite.
  bool ApplyController(double t, mjData* data) noexcept;

  // Of the controller, at the state of the last Update; `t` its time [s].
  void Tune(const ControllerTuning& tuning, double t) noexcept {
    controller_->Tune(tuning, Input(t));
  }
  void ResetTuning() noexcept { controller_->ResetTuning(); }
  void Archive(StateArchive& a) noexcept { a(torque_), controller_->Archive(a); }

  const JointVector& q() const { return q_; }            // of the cobot [rad]
  const JointVector& v() const { return v_; }            // [rad/s]
  const JointVector& torque() const { return torque_; }  // last applied [N·m]
  FrameMotion EndEffector() const;                       // X and V; A is zero
  FrameMotion Object(const mjData& data) const;          // X and V; A is zero

  // Kinetic energy, potential energy of the object, and what the controller's springs store [J].
  // The cobot's own potential energy is left out: its controllers carry its weight.
  double Energy(double t, mjData* data) const noexcept;

 private:
  ControllerInput Input(double t) const;

  std::shared_ptr<const RobotModel> robot_;
  FrameId end_effector_;
  double gravity_;  // [m/s²]
  Scene scene_;
  JointVector posture_;
  std::unique_ptr<Controller> controller_;
  JointVector effort_limit_;
  RobotData robot_data_;
  JointVector q_, v_, torque_;
};

}  // namespace predictor
