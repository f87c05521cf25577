// The physical part of a tick, from the device's sample to the joint velocities that may be sent.
// The pipeline has no state except the state of its models. All other data is passed as values.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "emulator/arm_side.h"
#include "emulator/perturbation.h"
#include "emulator/saved_state.h"
#include "emulator/supervisor.h"
#include "emulator/tick_data.h"
#include "haptics/recovery.h"
#include "haptics/renderer.h"
#include "haptics/stability.h"
#include "rig/operator.h"
#include "safety/guard.h"
#include "safety/stop.h"
#include "scenario/scenario.h"
#include "simulation/world.h"

namespace predictor {

class Pipeline {
 public:
  // Loads the models, finds the world's equilibrium and prepares rendering. Throws InputError.
  explicit Pipeline(const Scenario& scenario);

  // -- Stages of a tick, in this order. They do not use the heap or a lock, and do not throw. --

  // Computes the handles and the hands' wrenches from the sample. In direct mode, the operator acts
  // on the virtual handles instead.
  void Sense(const TickPlan& plan, TickData* data) noexcept;
  // Advances the virtual world by one step if simulated time passes.
  void Simulate(const TickPlan& plan, TickData* data) noexcept;
  // Computes joint velocities with the QP if the plan requires rendering.
  void Render(const TickPlan& plan, TickData* data) noexcept;
  // Computes joint velocities for every kind of motion except braking.
  void Command(const MotionOrder& order, TickData* data) noexcept;
  // Returns the motion of the handles at the time when the arms will follow a stop's next command.
  StopGeometry GeometryForStop(const MotionOrder& order, const TickData& data) noexcept;
  // Limits the command so that the limits of the handles and of each joint are kept. Updates
  // data->sent.
  void ApplyGuard(const MotionOrder& order, TickData* data) noexcept;

  // -- Between the stages. These do not use the heap or a lock, and do not throw. --

  // Returns the condition that prevents the arms from starting at their current position.
  Beyond FindBeyond() const noexcept;
  // Returns a text for the user that describes the place of this condition and the remedy. It must
  // not be called in a tick.
  std::string DescribeBeyond(Refusal refusal) const;
  void BeginTare() noexcept;
  // Returns kSensor and the hand if a sensor was not quiet.
  Status FinishTare() noexcept;
  // Brings the virtual world back to the scenario's start.
  void Reset(SentMotion* sent) noexcept;
  // After a state was loaded, this function updates `sent` from the guard's state.
  void UpdateSent(SentMotion* sent) const noexcept;

  bool direct() const { return direct_; }
  const World& world() const { return world_; }
  World& world() { return world_; }
  const ArmsSpec& arms() const { return spec_; }
  const LeadChoice& lead() const { return lead_; }
  // Returns the joint positions at which the real handles coincide with the virtual handles [rad].
  const std::array<JointVector, kHands>& start() const { return start_; }
  // Returns the joint positions that place the real handles `offset` [m] above and behind the
  // virtual handles. Throws InputError.
  std::array<JointVector, kHands> StartJoints(double offset) const;

 private:
  friend void ArchiveState(StateArchive& a, const SavedState& state) noexcept;

  void SenseDirectly(const TickPlan& plan, TickData* data) noexcept;
  void SenseArm(const TickPlan& plan, int hand, TickData* data) noexcept;
  std::array<RenderArm, kHands> View() const noexcept;
  void Perturb(const TickPlan& plan, TickData* data) noexcept;
  int KeepToCap(const MotionOrder& order, const std::array<Jacobian, kHands>& J,
                std::array<JointVector, kHands>* v) const noexcept;

  const Scenario scenario_;
  const double dt_;  // [s]
  const bool direct_;
  const bool predicts_;  // Jacobians at the predicted joint positions
  Hands hands_;
  World world_;
  std::array<std::optional<ArmSide>, kHands> arms_;
  ArmsSpec spec_;
  std::array<JointVector, kHands> start_;
  LeadChoice lead_;
  std::unique_ptr<Operator> person_;  // direct mode: holds the object's own handles
  std::optional<Perturbation> perturbation_;
  std::optional<Renderer> renderer_;
  std::optional<Recovery> recovery_;
  Guard guard_;
};

}  // namespace predictor
