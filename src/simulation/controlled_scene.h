// The scene and the controller of its cobot. Together they are everything that acts in the virtual
// world, except the hands.
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
#include "simulation/pick_up.h"
#include "simulation/wrist_sensor.h"

namespace predictor {

// The controller uses a model of the robot alone (RobotModel), while the world simulates the
// scene's model. If Λ included the load's inertia, the damping would be too large for the wrist,
// and a heavy box would make a simulation with 1 ms steps unstable.
class ControlledScene {
 public:
  // `events` are the events that will disturb the scene. Throws InputError, for example for an
  // event that would have no effect on this cobot.
  ControlledScene(const Scenario& scenario, const EventSequence& events);

  // Returns the scene at present. At first, the cobot carries the object in this scene. From the
  // first event of the attachment on, it is the scene with a free object.
  Engine& engine() const { return is_loose_ ? *loose_->engine : *carried_; }
  Engine& start_engine() const { return *carried_; }
  // Returns the scene with a free object. If no event lets the object slip or break loose, returns
  // null.
  Engine* loose_engine() const noexcept { return loose_ ? loose_->engine.get() : nullptr; }
  const RobotModel& robot() const { return *robot_; }
  const JointVector& posture() const { return posture_; }
  const JointVector& effort_limit() const { return effort_limit_; }  // [N·m]

  // Updates the quantities in `engine` and in the cobot's model that follow from positions and
  // velocities. `engine` must be in a state of the present scene. The functions below use these
  // quantities. Returns false on an error of the engine.
  bool Update(Engine* engine) noexcept;

  // Writes the controller's torques at time t [s], limited by the joints' effort limits [N·m], to
  // the joint forces, as if the controller had no period and no delay. Returns false if they are
  // not finite.
  bool ApplyController(double t, Engine* engine) noexcept;

  // The controller's life has these stages. StartController is called once, at the equilibrium at
  // time 0. ResetController is called at every return to this equilibrium. In each sub-step,
  // StepController applies the torques that act (as ApplyController does, with period and delay).
  // SenseWrist reads the wrist sensor after the engine's forces are known and before Update. After
  // Update, AdvanceController advances the controller's memory.
  void StartController() noexcept;
  void ResetController() noexcept;
  bool StepController(double t) noexcept;
  void SenseWrist() noexcept;
  void AdvanceController(double t) noexcept;

  // The linearisation needs the states of sensor and controller, and their rates.
  bool has_wrist_sensor() const noexcept {
    return controller_->uses_wrist_sensor() || (standby_ && standby_->uses_wrist_sensor());
  }
  WristSensor& wrist() { return wrist_; }
  std::span<double> memory() { return controller_->memory(); }
  const ControlTiming& timing() const { return timing_; }
  void Advance(double t, double dt) noexcept { controller_->Advance(Input(t), dt); }
  // Returns the wrench of the load on the end-effector, about E, in axes of W. Call it after the
  // engine's forces are known.
  Wrench WristWrench(const Engine& engine) const noexcept;

  // Tunes the controller in the state of the last Update. `t` is the time of this state [s].
  void Tune(const ControllerTuning& tuning, double t) noexcept;
  // Sets what hazards do from now on, in the state of the last Update.
  void Disturb(const Disturbance& disturbance, double t) noexcept;
  // As above, but for use before a state is restored in which the hazards already acted.
  void Resume(const Disturbance& disturbance) noexcept;
  CobotStop cobot_stop() const noexcept { return safety_.stop(); }
  AttachmentState attachment() const noexcept {
    return is_loose_ ? loose_->attachment.state() : AttachmentState::kHolds;
  }
  bool is_loose() const noexcept { return is_loose_; }
  // Returns null unless an event lets the object pick up a movable object.
  const PickUp* pick_up() const noexcept { return pick_up_.get(); }
  // Returns whether the present events require the scene with a free object.
  bool must_loosen() const noexcept {
    return !is_loose_ && (disturbance_.grip != GripLimits() || disturbance_.gripper.was_opened());
  }
  // The fixtures that are absent at present. The number of a fixture is the number of its bit.
  std::uint64_t absent() const noexcept { return absent_; }
  // Frees the object. From now on, the scene is the one with the free object, with the same poses,
  // velocities and torques.
  void Loosen() noexcept;
  // Call this function before a state of the scene with the free object is restored.
  void SetLoose(bool loose) noexcept { is_loose_ = loose && loose_; }
  // These functions are called in each sub-step. Hold adds the forces of the grips after all others
  // are applied. A grip acts on a free object, or as the object's grip on a movable object.
  // `object_wrench` is the wrench that was set by SetObjectWrench. Follow is called after Update.
  // Both return false on an error of the engine. LandingOf returns the wrench that ends a fall of a
  // free object, about its centre of mass.
  bool Hold(const Wrench& object_wrench) noexcept;
  bool Follow() noexcept;
  Wrench LandingOf(const FrameMotion& object) const noexcept;
  // Returns the outcome of the last step of the controller that acts, and the status if the step
  // was refused.
  ControllerOutcome outcome() const noexcept {
    return disturbance_.frozen ? ControllerOutcome::kComputed : Acting().outcome();
  }
  Status failure() const noexcept { return Acting().failure(); }
  void SetRealTime(bool real_time) noexcept { controller_->SetRealTime(real_time); }
  std::string PrioritiseProcess(bool on) { return controller_->PrioritiseProcess(on); }
  // Returns null unless the controller is outside the program.
  TapedController* taped() const noexcept { return controller_->taped(); }
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
  Wrench PickedLoad() const noexcept;
  void AddModelErrors(JointVector* torque) const noexcept;
  void SetGains(double t, bool keeps_force) noexcept;
  void SetBrakes(bool closed) noexcept;
  void PlaceObstacles() noexcept;
  void RemoveFixtures() noexcept;
  Controller& Acting() const noexcept { return disturbance_.standby ? *standby_ : *controller_; }
  double step() const noexcept { return carried_->step(); }
  void WriteTorque(Engine* engine) const noexcept;

  std::shared_ptr<const RobotModel> robot_;
  FrameId end_effector_;
  double gravity_;  // [m/s²]
  JointVector posture_;
  std::unique_ptr<Controller> controller_, standby_;  // standby_ may be null
  std::optional<PayloadSpec> payload_;
  std::unique_ptr<Engine> carried_;
  std::unique_ptr<LooseObject> loose_;  // may be null
  bool is_loose_ = false;
  std::unique_ptr<PickUp> pick_up_;  // null unless an event picks up a movable object
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
