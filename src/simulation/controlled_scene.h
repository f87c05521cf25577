// The scene and the controller of its cobot: everything that acts in it except the hands.
#pragma once

#include <memory>

#include "models/robot.h"
#include "simulation/controller.h"
#include "simulation/scene.h"

namespace predictor {

// The controller uses a model of the robot alone (RobotModel), while the world simulates the
// scene's model. If Λ included the load's inertia, the damping would be too large for the wrist,
// and a heavy box would make a simulation with 1 ms steps unstable.
class ControlledScene {
 public:
  explicit ControlledScene(const Scenario& scenario);  // throws InputError

  mjModel* model() const { return scene_.model.get(); }
  const Scene& scene() const { return scene_; }
  const RobotModel& robot() const { return *robot_; }
  const JointVector& posture() const { return posture_; }
  const JointVector& effort_limit() const { return effort_limit_; }  // [N·m]

  // Updates the position- and velocity-dependent quantities of `data`, and of the cobot at its qpos
  // and qvel. The functions below use them. Returns false on an error of the engine.
  bool Update(mjData* data) noexcept;

  // Writes the controller's torques at time t [s], limited by the joints' effort limits [N·m], to
  // qfrc_applied. Returns false if they are not finite.
  bool ApplyController(double t, mjData* data) noexcept;

  // Tunes the controller at the state of the last Update; `t` is its time [s].
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

  // Kinetic energy, potential energy of the object, and energy stored in the controller's springs
  // [J]. The cobot's own potential energy is excluded, because its controllers compensate its
  // weight.
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
