#include "recording.h"

#include <tuple>

#include "emulator/run_loop.h"
#include "scenario/scenario_io.h"

namespace predictor::bench {
namespace {

FrameMotion ToMotion(const MotionRecord& r) {
  FrameMotion m;
  m.X_W = FromRecord(r.pose);
  m.V_W = Eigen::Map<const Vector6>(r.twist.data());
  return m;
}

JointVector ToJoints(const std::array<double, kMaxArmJoints>& from, int dof) {
  return Eigen::Map<const Eigen::VectorXd>(from.data(), dof);
}

}  // namespace

Scenario LoadNamed(const std::string& name) {
  return LoadScenario(std::string(PREDICTOR_SOURCE_DIR) + "/scenarios/" + name + ".yaml");
}

Recording Record(const std::string& name) {
  Recording r;
  r.scenario = LoadNamed(name);
  Emulator emulator(r.scenario);
  r.start = emulator.setup().start;
  r.lead = emulator.setup().lead.lead;
  r.dt = emulator.dt();
  Simulate(&emulator, r.scenario.duration, [&](const TickRecord& tick) {
    if (tick.state == RunState::kRun) r.ticks.push_back(tick);
  });
  return r;
}

WorldInput WorldInputAt(const Recording& recording, std::size_t k) {
  WorldInput input;
  input.coupled = true;
  for (std::size_t i = 0; i < kHands; ++i) {
    const HandRecord& hand = recording.ticks[k].hands[i];
    if (hand.present != 0) input.present.Add(static_cast<int>(i));
    input.F_H_W[i] = Eigen::Map<const Wrench>(hand.wrench.data());
    input.handle[i] = ToMotion(hand.real);
  }
  return input;
}

ArmSample ArmSampleAt(const Recording& recording, std::size_t k, int hand) {
  const TickRecord& tick = recording.ticks[k];
  const HandRecord& h = tick.hands[static_cast<std::size_t>(hand)];
  ArmSample sample;
  sample.present = true;
  sample.q = ToJoints(h.q, h.arm_dof);
  sample.v = ToJoints(h.v, h.arm_dof);
  sample.F_S_raw = Eigen::Map<const Wrench>(h.wrench_raw.data());
  sample.arm_sequence = sample.sensor_sequence = tick.tick;
  return sample;
}

DeviceCommand CommandAt(const Recording& recording, std::size_t k) {
  const TickRecord& tick = recording.ticks[k];
  DeviceCommand command;
  command.state = tick.state;
  command.run_time = tick.run_time;
  for (std::size_t i = 0; i < kHands; ++i)
    command.v[i] = ToJoints(tick.hands[i].command, tick.hands[i].arm_dof);
  return command;
}

RenderInput::RenderInput(const Recording& recording) {
  sides_.reserve(kHands);
  for (int i = 0; i < kHands; ++i) sides_.emplace_back(recording.scenario, i, recording.dt);
  target.speed_cap = recording.scenario.safety.handle_speed;
  target.rotation_cap = recording.scenario.safety.handle_rotation_speed;
}

void RenderInput::Load(const Recording& recording, std::size_t k) noexcept {
  for (std::size_t i = 0; i < kHands; ++i) {
    const auto& virtual_now = recording.ticks[k].hands[i].virtual_;
    const auto& virtual_next = recording.ticks[k + 1].hands[i].virtual_;
    FrameMotion& D = target.handle[i];
    D = ToMotion(virtual_now);
    const Twist before = D.V_W;
    D.V_W = Eigen::Map<const Twist>(virtual_next.twist.data());
    D.A_W = (D.V_W - before) / recording.dt;
    last[i] =
        ToJoints(recording.ticks[k - 1].hands[i].command, recording.ticks[k].hands[i].arm_dof);
    std::ignore = sides_[i].Update(ArmSampleAt(recording, k, static_cast<int>(i)));
    sides_[i].LookAhead(last[i]);
  }
}

void RenderInput::Place(const std::array<JointVector, kHands>& q,
                        const std::array<JointVector, kHands>& sent) noexcept {
  last = sent;
  for (std::size_t i = 0; i < kHands; ++i) {
    ArmSample sample;
    sample.present = true;
    sample.q = q[i];
    sample.v = sent[i];
    std::ignore = sides_[i].Update(sample);
    sides_[i].LookAhead(sent[i]);
  }
}

std::array<RenderArm, kHands> RenderInput::arms() const {
  std::array<RenderArm, kHands> arms;
  for (std::size_t i = 0; i < kHands; ++i) {
    const ArmSide& side = sides_[i];
    arms[i] = {true,          side.model().get(),  &side.data(),
               &side.ahead(), side.handle_frame(), &side.q()};
  }
  return arms;
}

std::array<std::shared_ptr<const RobotModel>, kHands> RenderInput::models() const {
  return {sides_[0].model(), sides_[1].model()};
}

}  // namespace predictor::bench
