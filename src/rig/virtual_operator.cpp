#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "models/object_model.h"
#include "rig/hand.h"
#include "rig/operator.h"
#include "rig/operator_body.h"
#include "rig/script.h"

namespace predictor {
namespace {

constexpr double kSlowest = 0.2;  // slowest pace of a person, relative to the average of 1
constexpr double kFastest = 1.8;

class VirtualOperator final : public Operator {
 public:
  VirtualOperator(const Scenario& scenario, HandInertia inertia);
  void Step(const OperatorInput& input, OperatorOutput* output) noexcept override;
  void Reset() noexcept override;
  void Archive(StateArchive& a) noexcept override {
    a(hands_, drift_, script_, dt_, run_time_, running_, intent_, held_, X_OH_, sight_, body_);
  }

 private:
  void BeginRun() noexcept;
  // Returns the object's pose from the handles that exist, because the object is rigidly attached
  // to them.
  Pose SeenObject(const OperatorInput& input) const noexcept;
  void RunScript(const OperatorInput& input, const Pose& X_WO) noexcept;
  void Anchor(const OperatorInput& input, const Pose& X_WO) noexcept;
  HandGoal Goal(int hand, const OperatorInput& input, const Vector3& seen) const noexcept;
  // Moves the goal to a point that the hand can reach.
  void Reach(int hand, HandGoal* goal) const noexcept;
  void StepBody(const OperatorInput& input) noexcept;
  void LimitMuscles(const OperatorInput& input, std::array<Wrench, kHands>* wrenches) noexcept;

  HandSpec spec_;
  std::array<Pose, kHands> X_OD_;
  const std::vector<HandModel> fresh_hands_;  // initial state, before any random draw
  const OrnsteinUhlenbeck fresh_drift_;
  std::vector<HandModel> hands_ = fresh_hands_;
  OrnsteinUhlenbeck drift_ = fresh_drift_;
  Script script_;
  std::optional<OperatorBody> body_;

  double dt_ = 0;        // 0: no step yet
  double run_time_ = 0;  // time of the last step of a run [s]
  bool running_ = false;
  Intent intent_;
  std::array<bool, kHands> held_ = {false, false};
  std::array<Pose, kHands> X_OH_;  // grip pose of each hand relative to the reference
  FractionalDelay<Vector3, 1024> sight_;
};

OrnsteinUhlenbeck Drift(const Scenario& scenario) {
  return {scenario.operator_.hand.speed_drift_time, RandomStream(scenario.seed, "operator.pace")};
}

std::vector<HandModel> Hands(const Scenario& scenario, HandInertia inertia) {
  std::vector<HandModel> hands;
  hands.reserve(kHands);
  for (const char* name : kHandNames) {
    hands.emplace_back(scenario.operator_.hand, inertia, scenario.seed,
                       std::string("operator.") + name);
  }
  return hands;
}

void CheckHand(const HandSpec& hand) {
  if (std::max(hand.reflex_delay, hand.visual_delay) > HandModel::kMaxDelay) {
    throw InputError("operator.hand",
                     "The reflex delay and the visual delay can be at most 0.5 s. Reduce them.");
  }
}

VirtualOperator::VirtualOperator(const Scenario& scenario, HandInertia inertia)
    : spec_(scenario.operator_.hand),
      fresh_hands_(Hands(scenario, inertia)),
      fresh_drift_(Drift(scenario)),
      script_(scenario.operator_.script) {
  CheckHand(spec_);
  for (int i = 0; i < kHands; ++i) {
    if (scenario.Has(i)) X_OD_[static_cast<std::size_t>(i)] = HandlePose(scenario, i);
  }
  if (scenario.operator_.embodied) body_.emplace(scenario);
}

void VirtualOperator::Reset() noexcept {
  dt_ = run_time_ = 0;
  running_ = false;
  intent_ = Intent();
  held_ = {false, false};
  script_.Reset();
  if (body_) body_->Reset();
}

// Every run uses the same random numbers, even if the operator drew any number of them before the
// run began.
void VirtualOperator::BeginRun() noexcept {
  Reset();
  drift_ = fresh_drift_;
  hands_ = fresh_hands_;
}

Pose VirtualOperator::SeenObject(const OperatorInput& input) const noexcept {
  std::array<Pose, kHands> X_WO;
  for (std::size_t i = 0; i < kHands; ++i) X_WO[i] = input.handle[i].X_W * X_OD_[i].Inverse();
  if (!input.present.Has(0)) return X_WO[1];
  if (!input.present.Has(1)) return X_WO[0];
  // Rotates the mean position of the handles by the mean orientation.
  const Quaternion q = X_WO[0].q.slerp(0.5, X_WO[1].q);
  const Vector3 p = input.handle[0].X_W.p + input.handle[1].X_W.p - q * (X_OD_[0].p + X_OD_[1].p);
  return {p / 2, q};
}

void VirtualOperator::Anchor(const OperatorInput& input, const Pose& X_WO) noexcept {
  // If no hand holds the object yet, the first hand starts from the object's present pose. A hand
  // that joins the other hand uses the same reference. In both cases, the force of a hand starts at
  // zero when the hand begins to hold.
  if (!held_[0] && !held_[1] && intent_.AnyHold()) intent_.X_WO = X_WO;
  for (std::size_t i = 0; i < kHands; ++i) {
    if (intent_.hold[i] && !held_[i]) X_OH_[i] = intent_.X_WO.Inverse() * input.handle[i].X_W;
  }
  held_ = intent_.hold;
}

void VirtualOperator::RunScript(const OperatorInput& input, const Pose& X_WO) noexcept {
  script_.Begin(input.run_time, &intent_);
  Anchor(input, X_WO);
  const double drift = spec_.speed_drift * drift_.Step(input.dt);
  const double pace = std::clamp(1 + drift, kSlowest, kFastest);
  script_.Advance(input.dt, pace, &intent_);
}

HandGoal VirtualOperator::Goal(int hand, const OperatorInput& input,
                               const Vector3& seen) const noexcept {
  const std::size_t i = static_cast<std::size_t>(hand);
  HandGoal goal;
  goal.hold = intent_.hold[i];
  goal.grip_time = intent_.grip_time[i];
  goal.X_WH = intent_.X_WO * X_OH_[i];
  goal.V_WH = ShiftTwist(intent_.V_WO, goal.X_WH.p - intent_.X_WO.p);
  goal.object_error = intent_.X_WO.p - seen;
  goal.force = intent_.push[i];
  if (intent_.hold[0] && intent_.hold[1]) {
    const Vector3 line = input.handle[1 - i].X_W.p - input.handle[i].X_W.p;
    const double length = line.norm();
    if (length > 1e-6) goal.force += spec_.internal_force / length * line;
  }
  return goal;
}

void VirtualOperator::Reach(int hand, HandGoal* goal) const noexcept {
  const Vector3 p = body_->Reachable(hand, goal->X_WH.p);
  const Vector3 missing = goal->X_WH.p - p;
  const double distance = missing.norm();
  if (!(distance > 0)) return;
  // The reference must not move further out of reach.
  const Vector3 away = missing / distance;
  goal->V_WH.head<3>() -= away * std::max(0.0, away.dot(goal->V_WH.head<3>()));
  goal->X_WH.p = p;
  goal->object_error -= missing;
}

void VirtualOperator::StepBody(const OperatorInput& input) noexcept {
  std::array<bool, kHands> holds = {false, false};
  for (const int hand : input.present) {
    const auto i = static_cast<std::size_t>(hand);
    holds[i] = intent_.hold[i] || hands_[i].grip() > 0;
  }
  body_->Step(input.handle, holds, input.dt);
}

void VirtualOperator::LimitMuscles(const OperatorInput& input,
                                   std::array<Wrench, kHands>* wrenches) noexcept {
  std::array<Vector3, kHands> forces;
  for (std::size_t i = 0; i < kHands; ++i) forces[i] = hands_[i].grip() * (*wrenches)[i].head<3>();
  std::array<Vector3, kHands> limited = forces;
  body_->LimitForces(input.handle, &limited);
  for (std::size_t i = 0; i < kHands; ++i)
    if (hands_[i].grip() > 0) (*wrenches)[i].head<3>() = limited[i] / hands_[i].grip();
  std::array<Wrench, kHands> felt = *wrenches;
  for (std::size_t i = 0; i < kHands; ++i) felt[i] *= hands_[i].grip();
  body_->Feel(felt);
}

void VirtualOperator::Step(const OperatorInput& input, OperatorOutput* output) noexcept {
  *output = OperatorOutput();
  if (input.running && !running_) BeginRun();
  running_ = input.running;
  if (running_) run_time_ = input.run_time;
  const Pose X_WO = SeenObject(input);
  if (input.dt != dt_) {
    dt_ = input.dt;
    for (HandModel& hand : hands_) hand.Reset(dt_);
    sight_.Reset(spec_.visual_delay / dt_, X_WO.p);
  }
  const Vector3 seen = sight_.Update(X_WO.p);

  intent_.V_WO.setZero();
  intent_.push = {Vector3::Zero(), Vector3::Zero()};
  if (input.running) {
    RunScript(input, X_WO);
  } else {
    intent_.hold = held_ = {false, false};  // when the machine stops, the person lets go
  }

  if (body_) StepBody(input);
  std::array<Wrench, kHands> muscles = {Wrench::Zero(), Wrench::Zero()};
  for (const int hand : input.present) {
    const std::size_t i = static_cast<std::size_t>(hand);
    HandGoal goal = Goal(hand, input, seen);
    if (body_) Reach(hand, &goal);
    muscles[i] = hands_[i].Intend(goal, input.handle[i], body_ ? &body_->arm(hand) : nullptr);
  }
  if (body_) LimitMuscles(input, &muscles);
  for (const int hand : input.present) {
    const std::size_t i = static_cast<std::size_t>(hand);
    output->F_H_W[i] = hands_[i].Deliver(muscles[i], input.handle[i]);
    output->grip[i] = hands_[i].grip();
    output->hand_mass[i] = hands_[i].grip() * spec_.mass;
  }
  output->action = script_.current();
}

}  // namespace

std::unique_ptr<Operator> MakeVirtualOperator(const Scenario& scenario, HandInertia inertia) {
  return std::make_unique<VirtualOperator>(scenario, inertia);
}

}  // namespace predictor
