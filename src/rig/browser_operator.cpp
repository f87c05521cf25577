// Models a person who moves the handles with a mouse or VR controllers. The page sends the hand's
// pose. This file computes the resulting force, which is that of a spring and a damper between hand
// and handle, up to a limit. The hand releases its handle when the page stops sending messages.
#include <algorithm>
#include <string>
#include <vector>

#include "rig/hand.h"
#include "rig/operator.h"
#include "scenario/action_time.h"

namespace predictor {
namespace {

// If a page sends no message for this time, the page's hands release the handles [s].
constexpr double kSilence = 0.250;
constexpr double kMaxForce = 25;          // maximum force of a hand [N]
constexpr double kMaxTorque = 2;          // [N·m]
constexpr double kStiffness = 300;        // stiffness between hand and handle [N/m]
constexpr double kRotationStiffness = 4;  // [N·m/rad]
constexpr double kDampingRatio = 0.7;
constexpr double kGripTime = 0.2;  // [s]
// Cut-off of the critically damped filter of the hand's motion [Hz]
constexpr double kSmoothing = 6.0;

HandSpec HandOf(const Scenario& scenario) {
  HandSpec hand;
  hand.stiffness.setConstant(kStiffness);
  hand.rotation_stiffness = kRotationStiffness;
  hand.damping_ratio = kDampingRatio;
  hand.mass = scenario.operator_.hand.mass;
  hand.release_time = scenario.operator_.hand.release_time;
  hand.max_force = kMaxForce;
  hand.max_torque = kMaxTorque;
  // The pointer's motion already contains the person's reflexes, tremor and visual feedback.
  hand.reflex_gain = hand.tremor_force = hand.force_noise = hand.force_noise_floor = 0;
  hand.visual_stiffness.setZero();
  hand.internal_force = 0;
  return hand;
}

// Follows, with a continuous velocity, a pose that changes in steps.
class SmoothPose {
 public:
  void Reset(const Pose& X) noexcept { X_ = X, V_.setZero(); }
  void Step(const Pose& goal, double dt) noexcept {
    const double w = 2 * 3.14159265358979323846 * kSmoothing;
    const Vector6 error = PoseError(goal, X_);
    // The step is implicit in the velocity, so it is stable for any step size.
    V_ = (V_ + dt * w * w * error) / (1 + 2 * w * dt + w * w * dt * dt);
    X_.p += dt * V_.head<3>();
    X_.q = (RotationFromVector(dt * V_.tail<3>()) * X_.q).normalized();
  }
  void Archive(StateArchive& a) noexcept { a(X_, V_); }
  const Pose& X() const noexcept { return X_; }
  const Twist& V() const noexcept { return V_; }

 private:
  Pose X_;
  Twist V_ = Twist::Zero();
};

class BrowserOperator final : public Operator {
 public:
  BrowserOperator(const Scenario& scenario, HandInertia inertia)
      : script_(SpansOf(scenario.operator_.script)), mass_(HandOf(scenario).mass) {
    for (const char* name : kHandNames)
      hands_.emplace_back(HandOf(scenario), inertia, scenario.seed,
                          std::string("operator.") + name);
  }

  void Step(const OperatorInput& input, OperatorOutput* output) noexcept override {
    *output = OperatorOutput();
    // The script does not move the hands. The script only shows the person what to do and when.
    if (input.running) output->action = ActionAt(script_, input.run_time);
    if (input.dt != dt_) {
      dt_ = input.dt;
      for (HandModel& hand : hands_) hand.Reset(dt_);
    }
    for (const int i : input.present) {
      const HandInput& said = input.hands[i];
      HandGoal goal;
      goal.hold = input.running && said.grip && said.age < kSilence;
      goal.grip_time = kGripTime;
      if (!goal.hold)
        pointer_[i].Reset(input.handle[i].X_W);
      else
        pointer_[i].Step(said.X_WH, dt_);
      goal.X_WH = pointer_[i].X();
      goal.V_WH = pointer_[i].V();
      output->F_H_W[i] = hands_[i].Step(goal, input.handle[i]);
      output->grip[i] = hands_[i].grip();
      output->hand_mass[i] = hands_[i].grip() * mass_;
    }
  }

  void Reset() noexcept override {
    for (HandModel& hand : hands_) hand.Reset(dt_);
  }

  void Archive(StateArchive& a) noexcept override { a(dt_, hands_, pointer_); }

 private:
  std::vector<ActionSpan> script_;
  double mass_;  // [kg]
  double dt_ = 0.001;
  std::vector<HandModel> hands_;
  std::array<SmoothPose, kHands> pointer_;
};

}  // namespace

std::unique_ptr<Operator> MakeBrowserOperator(const Scenario& scenario, HandInertia inertia) {
  return std::make_unique<BrowserOperator>(scenario, inertia);
}

}  // namespace predictor
