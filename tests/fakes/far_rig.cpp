#include "fakes/far_rig.h"

#include <algorithm>
#include <sstream>

#include "emulator/emulator.h"

namespace predictor {
namespace {

// As the scenario has them, but for the program's own idea of who moves them.
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
                                 MakeVirtualOperator(scenario, HandInertia::kInWrench))) {}

Mechanics* FarRig::Hang(int hand) {
  places_.push_back({hand, std::make_unique<Mechanics>()});
  Fill();
  return places_.back().mechanics.get();
}

void FarRig::Fill() {
  DeviceSample sample;
  rig_->Read(&sample);
  for (Place& place : places_) {
    ArmSample& sampled = place.mechanics->sample;
    sampled = sample.arms[static_cast<std::size_t>(place.hand)];
    const Disturbance& disturbance = disturbances_[static_cast<std::size_t>(place.hand)];
    if (disturbance.q.size() == sampled.q.size()) sampled.q += disturbance.q;
    sampled.F_S_raw += disturbance.F_S;
    const Vector3 force = disturbance.mounted * Vector3(sampled.F_S_raw.head<3>());
    const Vector3 torque = disturbance.mounted * Vector3(sampled.F_S_raw.tail<3>());
    sampled.F_S_raw << force, torque;
    place.mechanics->command.resize(0);
  }
}

void FarRig::Step() {
  DeviceSample sample;
  rig_->Read(&sample);
  DeviceCommand command;
  command.state = running_ ? RunState::kRun : RunState::kArmed;
  command.run_time = run_time_;
  for (std::size_t hand = 0; hand < kHands; ++hand)
    command.v[hand].setZero(sample.arms[hand].q.size());
  // A sensor asks for no motion.
  for (const Place& place : places_)
    if (place.mechanics->command.size() > 0)
      command.v[static_cast<std::size_t>(place.hand)] = place.mechanics->command;
  for (std::size_t hand = 0; hand < kHands; ++hand) {
    told_[hand].push_front(command.v[hand]);
    if (told_[hand].size() > kMostLate) told_[hand].pop_back();
    command.v[hand] = told_[hand][std::min(late_[hand], told_[hand].size() - 1)];
  }
  rig_->Step(command, 0.001);
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
    motion_.fastest = std::max(motion_.fastest, v.norm());
    motion_.hardest = std::max(motion_.hardest, (v - v_[i]).norm() / 0.001);
    way_[i] += 0.001 * v.norm();
    motion_.distance = std::max(motion_.distance, way_[i]);
    if (v.norm() > kRest) motion_.rest_after = since_mark_;
    v_[i] = v;
  }
}

void FarRig::Disturb(int hand, const JointVector& q, const Wrench& F_S) {
  Disturbance& disturbance = disturbances_[static_cast<std::size_t>(hand)];
  disturbance.q = q;
  disturbance.F_S = F_S;
}

void FarRig::Mount(int hand, const Matrix3& R) {
  disturbances_[static_cast<std::size_t>(hand)].mounted = R;
}

void FarRig::Hinder(int hand, std::size_t milliseconds) {
  late_[static_cast<std::size_t>(hand)] = milliseconds;
}

void FarRig::SetRunning(bool running) {
  if (running && !running_) run_time_ = 0;
  running_ = running;
}

std::string FarRig::ToString() {
  DeviceSample sample;
  rig_->Read(&sample);
  std::ostringstream text;
  for (std::size_t hand = 0; hand < kHands; ++hand) {
    const ArmSample& arm = sample.arms[hand];
    if (arm.present)
      text << kHandNames[hand] << " q " << arm.q.transpose() << " v " << arm.v.transpose() << "  ";
  }
  return text.str();
}

}  // namespace predictor
