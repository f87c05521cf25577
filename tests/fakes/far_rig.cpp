#include "fakes/far_rig.h"

#include <algorithm>
#include <sstream>

#include "core/motion.h"
#include "emulator/emulator.h"

namespace predictor {
namespace {

// Returns the scenario's start joints with a small offset. The simulated device and operator
// replace those of the scenario.
std::array<JointVector, kHands> Beside(Scenario scenario, const FarRig::Start& change) {
  constexpr double kBeside = 0.01;  // [rad]
  scenario.device.type = "simulated";
  scenario.operator_.type = "virtual";
  std::array<JointVector, kHands> start = Emulator(scenario).setup().start;
  for (JointVector& q : start)
    if (q.size() > 0) q[0] += kBeside;
  if (change) change(&start);
  return start;
}

}  // namespace

FarRig::FarRig(const Scenario& scenario, const Start& start)
    : rig_(std::make_unique<Rig>(scenario, Beside(scenario, start),
                                 MakeVirtualOperator(scenario, HandInertia::kInWrench))) {
  for (int hand = 0; hand < kHands; ++hand)
    if (scenario.Has(hand))
      by_hand_[static_cast<std::size_t>(hand)].X_HS =
          scenario.arm(hand).handle.ToPose().Inverse() * scenario.arm(hand).sensor.pose.ToPose();
  rig_->Read(&sample_);
}

Mechanics* FarRig::Hang(int hand) {
  places_.push_back({hand, std::make_unique<Mechanics>()});
  Fill();
  return places_.back().mechanics.get();
}

// Returns the wrench of a person's push, about S and in the axes of S.
Wrench FarRig::Pressed(std::size_t hand) const {
  const ByHand& by = by_hand_[hand];
  const Pose& X_WH = rig_->true_handles()[hand].X_W;
  const Pose X_WS = X_WH * by.X_HS;
  const Vector3 torque = (X_WH.p - X_WS.p).cross(by.press);
  Wrench F_S;
  F_S << X_WS.q.conjugate() * by.press, X_WS.q.conjugate() * torque;
  return F_S;
}

void FarRig::Fill() {
  rig_->Read(&sample_);
  for (Place& place : places_) {
    const auto hand = static_cast<std::size_t>(place.hand);
    ArmSample& sampled = place.mechanics->sample;
    sampled = sample_.arms[hand];
    const Disturbance& disturbance = disturbances_[hand];
    if (disturbance.q.size() == sampled.q.size()) sampled.q += disturbance.q;
    const Wrench F_S = sampled.F_S_raw + Pressed(hand);
    sampled.F_S_raw << by_hand_[hand].axes * F_S.head<3>(), by_hand_[hand].axes * F_S.tail<3>();
    sampled.F_S_raw += disturbance.F_S + disturbance.drifted;
    place.mechanics->command.resize(0);
  }
}

void FarRig::Lead(int hand, const JointVector& q) {
  by_hand_[static_cast<std::size_t>(hand)].lead = q;
}

bool FarRig::Led(int hand) const {
  constexpr double kThere = 5e-5;  // [rad]
  const ByHand& by = by_hand_[static_cast<std::size_t>(hand)];
  return by.lead.size() > 0 && (by.lead - joints(hand)).cwiseAbs().maxCoeff() < kThere;
}

void FarRig::Press(int hand, const Vector3& F_W) {
  by_hand_[static_cast<std::size_t>(hand)].press = F_W;
}

void FarRig::Wire(int hand, const Matrix3& axes) {
  by_hand_[static_cast<std::size_t>(hand)].axes = axes;
}

JointVector FarRig::joints(int hand) const {
  return sample_.arms[static_cast<std::size_t>(hand)].q;
}

void FarRig::Step() {
  DeviceCommand command;
  command.state = running_ ? RunState::kRun : RunState::kArmed;
  command.run_time = run_time_;
  for (std::size_t hand = 0; hand < kHands; ++hand)
    command.v[hand].setZero(sample_.arms[hand].q.size());
  // The places of sensors contain no command.
  for (const Place& place : places_)
    if (place.mechanics->command.size() > 0)
      command.v[static_cast<std::size_t>(place.hand)] = place.mechanics->command;
  constexpr double kGain = 8, kBrisk = 2.5;  // [1/s], [rad/s]
  for (std::size_t hand = 0; hand < kHands; ++hand) {
    if (const JointVector& goal = by_hand_[hand].lead; goal.size() == command.v[hand].size())
      command.v[hand] = (kGain * (goal - sample_.arms[hand].q)).cwiseMax(-kBrisk).cwiseMin(kBrisk);
    commanded_[hand].push_front(command.v[hand]);
    if (commanded_[hand].size() > kMaxLate) commanded_[hand].pop_back();
    command.v[hand] = commanded_[hand][std::min(late_[hand], commanded_[hand].size() - 1)];
  }
  rig_->Step(command, 0.001);
  for (Disturbance& disturbance : disturbances_) disturbance.drifted += 0.001 * disturbance.drift;
  if (running_) run_time_ += 0.001;
  Watch();
  Fill();
}

void FarRig::Mark() {
  motion_ = {};
  since_mark_ = 0;
  way_ = {};
}

void FarRig::Watch() {
  constexpr double kRest = 1e-3;  // [m/s]
  since_mark_ += 0.001;
  for (std::size_t i = 0; i < kHands; ++i) {
    const Vector3 v = rig_->true_handles()[i].V_W.head<3>();
    const double moving = HandleSpeed(rig_->true_handles()[i].V_W);
    motion_.moving = std::max(motion_.moving, moving);
    motion_.fastest = std::max(motion_.fastest, v.norm());
    motion_.hardest = std::max(motion_.hardest, (v - v_[i]).norm() / 0.001);
    if (const JointVector& turning = sample_.arms[i].v; turning.size() > 0)
      motion_.joint = std::max(motion_.joint, turning.cwiseAbs().maxCoeff());
    if (commanded_[i].size() > kWindow && commanded_[i][0].size() > 0)
      motion_.braking = std::max(
          motion_.braking,
          (commanded_[i][0] - commanded_[i][kWindow]).cwiseAbs().maxCoeff() / (0.001 * kWindow));
    way_[i] += 0.001 * v.norm();
    motion_.distance = std::max(motion_.distance, way_[i]);
    if (moving > kRest) motion_.rest_after = since_mark_;
    v_[i] = v;
  }
}

void FarRig::Disturb(int hand, const JointVector& q, const Wrench& F_S) {
  Disturbance& disturbance = disturbances_[static_cast<std::size_t>(hand)];
  disturbance.q = q;
  disturbance.F_S = F_S;
}

void FarRig::Drift(int hand, const Wrench& rate) {
  disturbances_[static_cast<std::size_t>(hand)].drift = rate;
}

void FarRig::Hinder(int hand, std::size_t milliseconds) {
  late_[static_cast<std::size_t>(hand)] = milliseconds;
}

void FarRig::SetRunning(bool running) {
  if (running && !running_) run_time_ = 0;
  running_ = running;
}

std::string FarRig::ToString() {
  std::ostringstream text;
  for (std::size_t hand = 0; hand < kHands; ++hand) {
    const ArmSample& arm = sample_.arms[hand];
    if (arm.present)
      text << kHandNames[hand] << " q " << arm.q.transpose() << " rad v " << arm.v.transpose()
           << " rad/s  ";
  }
  return text.str();
}

}  // namespace predictor
