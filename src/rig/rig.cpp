#include "rig/rig.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "rig/simulated_arm.h"

namespace predictor {
namespace {

constexpr double kLongestStep = 0.001;  // [s]

// Returns the longest step of at most 1 ms that divides a tick evenly.
double StepTime(double rate) {
  const double tick = 1 / rate;
  return tick / std::max(1.0, std::ceil(tick / kLongestStep - 1e-9));
}

}  // namespace

struct Rig::Impl {
  double dt = kLongestStep;
  std::array<std::optional<SimulatedArm>, kHands> arms;
  std::unique_ptr<Operator> person;
  OperatorInput felt;
  std::array<FrameMotion, kHands> handles;
  OperatorOutput hands;

  void StepOnce() noexcept;
};

void Rig::Impl::StepOnce() noexcept {
  // The arms' motion within a step does not depend on the person's reaction in this step, so there
  // is no algebraic loop. In each step, the arms move, the person reacts, and the sensors measure
  // the resulting wrench.
  for (std::size_t i = 0; i < kHands; ++i) {
    if (!arms[i]) continue;
    arms[i]->Move();
    felt.handle[i] = handles[i] = arms[i]->handle();
  }
  if (person) person->Step(felt, &hands);
  for (std::size_t i = 0; i < kHands; ++i) {
    if (arms[i]) arms[i]->Sense(hands.F_H_W[i]);
  }
}

Rig::Rig(const Scenario& scenario, const std::array<JointVector, kHands>& start,
         std::unique_ptr<Operator> person)
    : impl_(std::make_unique<Impl>()) {
  impl_->dt = impl_->felt.dt = StepTime(scenario.rate);
  impl_->person = std::move(person);
  for (int hand = 0; hand < kHands; ++hand) {
    const std::size_t i = static_cast<std::size_t>(hand);
    const std::optional<ArmSpec>& arm = hand == 0 ? scenario.device.left : scenario.device.right;
    if (!scenario.Has(hand) || !arm) continue;
    impl_->arms[i].emplace(scenario, hand, start[i], impl_->dt);
    impl_->felt.present.Add(hand);
    impl_->felt.handle[i] = impl_->handles[i] = impl_->arms[i]->handle();
  }
}

Rig::~Rig() = default;

void Rig::Read(DeviceSample* sample) noexcept {
  for (std::size_t i = 0; i < kHands; ++i) {
    if (impl_->arms[i]) {
      impl_->arms[i]->Read(&sample->arms[i]);
    } else {
      sample->arms[i].present = false;
    }
  }
}

void Rig::Step(const DeviceCommand& command, double dt) noexcept {
  for (std::size_t i = 0; i < kHands; ++i) {
    if (impl_->arms[i]) impl_->arms[i]->Command(command.v[i]);
  }
  impl_->felt.running = command.state == RunState::kRun;
  impl_->felt.run_time = command.run_time;
  impl_->felt.hands = command.hands;
  Pass(dt);
}

void Rig::Pass(double dt) noexcept {
  const int steps = static_cast<int>(std::lround(dt / impl_->dt));
  for (int n = 0; n < steps; ++n) {
    impl_->StepOnce();
    if (impl_->felt.running) impl_->felt.run_time += impl_->dt;
  }
}

void Rig::Archive(StateArchive& a) noexcept {
  a(impl_->arms, impl_->felt, impl_->handles, impl_->hands);
  for (std::size_t i = 0; i < kHands; ++i)
    if (impl_->felt.present.Has(static_cast<int>(i)) != impl_->arms[i].has_value()) a.Fail();
  if (impl_->felt.dt != impl_->dt) a.Fail();
  if (impl_->person) impl_->person->Archive(a);
}

const std::array<FrameMotion, kHands>& Rig::true_handles() const { return impl_->handles; }
const OperatorOutput& Rig::true_operator() const { return impl_->hands; }

}  // namespace predictor
