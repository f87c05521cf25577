// The scene and the controller of its cobot, which is everything that acts in it except the hands.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "models/robot.h"
#include "simulation/attachment.h"
#include "simulation/cobot_safety.h"
#include "simulation/control_timing.h"
#include "simulation/controller.h"
#include "simulation/disturbance.h"
#include "simulation/engine.h"
#include "simulation/event_sequence.h"
#include "simulation/wrist_sensor.h"

namespace predictor {

// The controller uses a model of the robot alone (RobotModel), while the world simulates the
// scene's model. If Λ included the load's inertia, the damping would be too large for the wrist,
// and a heavy box would make a simulation with 1 ms steps unstable.
class ControlledScene {
 public:
  // `events` are those that will disturb it. Throws InputError, for example for an event that would
  // have no effect on this cobot.
  ControlledScene(const Scenario& scenario, const EventSequence& events);

  // Returns the scene at present. It is the one in which the cobot carries the object or, from the
  // first event of the attachment on, the one with a free object.
  Engine& engine() const { return is_loose_ ? *loose_->engine : *carried_; }
  Engine& start_engine() const { return *carried_; }
  // Returns the scene with a free object, or null unless an event lets it slip or break loose.
  Engine* loose_engine() const noexcept { return loose_ ? loose_->engine.get() : nullptr; }
  const RobotModel& robot() const { return *robot_; }
  const JointVector& posture() const { return posture_; }
  const JointVector& effort_limit() const { return effort_limit_; }  // [N·m]

  // Updates what follows from positions and velocities in `engine`, which is in a state of the
  // present scene, and in the model of the cobot. The functions below use it. Returns false on an
  // error of the engine.
  bool Update(Engine* engine) noexcept;

  // Writes the controller's torques at time t [s], limited by the joints' effort limits [N·m], to
  // the joint forces, as if the controller had no period and no delay. Returns false if they are
  // not finite.
  bool ApplyController(double t, Engine* engine) noexcept;

  // The controller's life has these stages. StartController is called once, at the equilibrium at
  // time 0, and ResetController at every return to it. In each sub-step, StepController applies the
  // torques that act (as ApplyController does, with period and delay). SenseWrist reads the wrist
  // sensor after the engine's forces are known and before Update. AdvanceController advances the
  // controller's memory after Update.
  void StartController() noexcept;
  void ResetController() noexcept;
  bool StepController(double t) noexcept;
  void SenseWrist() noexcept;
  void AdvanceController(double t) noexcept;

  // The linearisation needs the states of sensor and controller, and their rates.
  bool has_wrist_sensor() const noexcept { return has_wrist_sensor_; }
  WristSensor& wrist() { return wrist_; }
  std::span<double> memory() { return controller_->memory(); }
  const ControlTiming& timing() const { return timing_; }
  void Advance(double t, double dt) noexcept { controller_->Advance(Input(t), dt); }
  // Returns the wrench of the load on the end-effector, about E, in axes of W, after the engine's
  // forces are known.
  Wrench WristWrench(const Engine& engine) const noexcept;

  // Tunes the controller in the state of the last Update. `t` is its time [s].
  void Tune(const ControllerTuning& tuning, double t) noexcept;
  // Sets what hazards do from now on, in the state of the last Update.
  void Disturb(const Disturbance& disturbance, double t) noexcept;
  // As above, before a state is restored in which they already acted.
  void Resume(const Disturbance& disturbance) noexcept;
  CobotStop cobot_stop() const noexcept { return safety_.stop(); }
  AttachmentState attachment() const noexcept {
    return is_loose_ ? loose_->attachment.state() : AttachmentState::kHolds;
  }
  bool is_loose() const noexcept { return is_loose_; }
  // Returns whether the present events require the scene with a free object.
  bool must_loosen() const noexcept {
    return !is_loose_ && (disturbance_.grip != GripLimits() || disturbance_.gripper.was_opened());
  }
  // The fixtures that are not there at present: bit = number of the fixture.
  std::uint64_t absent() const noexcept { return absent_; }
  // Frees the object: from now on, the scene is the loose one, with the same poses, velocities and
  // torques.
  void Loosen() noexcept;
  // Call this before a state of that scene is restored.
  void SetLoose(bool loose) noexcept { is_loose_ = loose && loose_; }
  // For a free object, these functions are called in each sub-step. HoldObject adds the
  // attachment's forces after all others are applied, and returns false on an error of the engine.
  // FollowObject is called after Update. LandingOf returns the wrench about its centre of mass that
  // ends a fall.
  bool HoldObject() noexcept;
  void FollowObject() noexcept;
  Wrench LandingOf(const FrameMotion& object) const noexcept;
  // Returns how the last step of the controller that acts went, and the status of a refused step.
  ControllerOutcome outcome() const noexcept {
    return disturbance_.frozen ? ControllerOutcome::kComputed : Acting().outcome();
  }
  Status failure() const noexcept { return Acting().failure(); }
  void SetRealTime(bool real_time) noexcept { controller_->SetRealTime(real_time); }
  std::string PrioritiseProcess(bool on) { return controller_->PrioritiseProcess(on); }
  // Returns null unless the controller is outside the program.
  TapedController* taped() const noexcept { return taped_; }
  void Archive(StateArchive& a) noexcept;

  const JointVector& q() const { return q_; }            // of the cobot [rad]
  const JointVector& v() const { return v_; }            // [rad/s]
  const JointVector& torque() const { return torque_; }  // last applied [N·m]
  void SetTorque(const JointVector& torque) noexcept { torque_ = torque; }
  const FrameMotion& end_effector() const noexcept { return E_; }  // X and V; A is zero

  // Returns the kinetic energy, the potential energy of the object and of the movable objects, and
  // the energy stored in the controller's springs [J]. The cobot's own potential energy is
  // excluded, because its controllers compensate its weight.
  double Energy(double t) const noexcept;

 private:
  struct LooseObject {
    LooseObject(const Scenario& scenario, const RobotModel& robot);
    std::unique_ptr<Engine> engine;
    Attachment attachment;
    double landing = 0;  // height at which a fall ends [m]
    void Archive(StateArchive& a) noexcept { a(attachment, landing); }
  };
  ControllerInput Input(double t) const;
  // Computes the controller's torques at time t [s], within the effort limits [N·m]. Returns false
  // if they are not finite.
  bool ComputeTorque(double t, JointVector* torque) noexcept;
  double PayloadShare() const noexcept;
  void AddPayload(JointVector* torque) const noexcept;
  void AddModelErrors(JointVector* torque) const noexcept;
  void SetGains(double t, bool keeps_force) noexcept;
  void SetBrakes(bool closed) noexcept;
  void CheckEvents(const EventSequence& events) const;
  std::string Missing(HazardNeeds needs) const;
  void PlaceObstacles() noexcept;
  void RemoveFixtures() noexcept;
  bool IsBlocked(std::uint64_t fixtures) const noexcept;
  void CheckAttachmentEvent(const EventSequence& events, std::size_t i) const;
  void CheckGripper(const EventSequence& events, std::size_t i) const;
  Controller& Acting() const noexcept { return disturbance_.standby ? *standby_ : *controller_; }
  double step() const noexcept { return carried_->step(); }
  void WriteTorque(Engine* engine) const noexcept;

  std::shared_ptr<const RobotModel> robot_;
  FrameId end_effector_;
  double gravity_;  // [m/s²]
  JointVector posture_;
  std::unique_ptr<Controller> controller_, standby_;  // standby_ may be null
  TapedController* const taped_;                      // may be null
  const bool has_wrist_sensor_;
  JointType joint_;  // of the attachment
  std::optional<PayloadSpec> payload_;
  std::unique_ptr<Engine> carried_;
  std::unique_ptr<LooseObject> loose_;  // may be null
  bool is_loose_ = false;
  WristSensor wrist_;
  ControlTiming timing_;
  Wrench wrist_at_start_ = Wrench::Zero();
  JointVector effort_limit_;
  RobotData robot_data_;
  JointVector q_, v_, torque_;
  Pose X_WO_;                          // at the last Update
  FrameMotion E_;                      // likewise
  JointVector computed_;               // by the controller, before its delay [N·m]
  std::vector<DofFriction> friction_;  // of each joint, with open brakes
  CobotSafety safety_;
  Disturbance disturbance_;
  const std::uint64_t obstacles_;  // fixtures that events let appear
  std::uint64_t absent_;           // those of them that are not there
  ControllerTuning tuning_;        // by the last Tune
};

}  // namespace predictor
