// Connects an arm of the rig through a driver's interface in virtual time. This connection behaves
// like a perfect driver with an adjustable sampling rate.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "commissioning/calibrate.h"
#include "commissioning/session.h"
#include "devices/arm.h"
#include "devices/wire/network.h"
#include "rig/arms.h"
#include "rig/rig.h"

namespace predictor::commissioning {

// In this network, time passes only during Wait, which calls the registered functions.
class VirtualTime : public Network {
 public:
  std::unique_ptr<Stream> Connect(const Address& peer, double) override {
    throw DeviceError(peer, "does not answer.");
  }
  std::unique_ptr<Datagrams> Open(const Address& peer, std::uint16_t) override {
    throw DeviceError(peer, "does not answer.");
  }
  std::uint64_t Now() const noexcept override { return now_; }
  void Wait(double time) override {
    now_ += static_cast<std::uint64_t>(std::llround(1e9 * time));
    for (const auto& step : steps_) step(time);
  }
  // Registers a function that is called with the elapsed time [s].
  void OnStep(std::function<void(double)> step) { steps_.push_back(std::move(step)); }

 private:
  std::uint64_t now_ = 5'000'000'000;  // [ns]
  std::vector<std::function<void(double)>> steps_;
};

// The left arm of a rig. A test models the person who guides the arm as a velocity.
class RigHand {
 public:
  RigHand(const Scenario& scenario, VirtualTime* time, JointVector start, double rate = 1000)
      : rig_(scenario, {start, {}}, nullptr), period_(1 / rate) {
    Sample();
    time->OnStep([this](double dt) {
      for (int n = static_cast<int>(std::lround(dt / kStep)); n > 0; --n) Pass(kStep);
    });
  }

  Rig& rig() { return rig_; }
  const ArmSample& sample() const { return sample_.arms[0]; }
  std::uint64_t sequence() const { return sequence_; }
  double age() const { return age_; }
  void Command(const JointVector& v, bool motion) {
    if (command_.size() == v.size())
      hardest_ = std::max(hardest_, (v - command_).cwiseAbs().maxCoeff() / kStep);
    command_ = v;
    motion_ = motion;
  }
  // The following functions return the last command [rad/s], whether the arm is in motion mode, and
  // the largest rate at which commands have changed so far [rad/s²].
  const JointVector& command() const { return command_; }
  bool motion() const { return motion_; }
  double hardest() const { return hardest_; }
  // Sets the joint velocity of an arm that a person guides [rad/s], or ends the guiding if empty.
  void Lead(const JointVector& v) { lead_ = v; }
  // The following disturbances are added to the measured wrench and joint angles.
  Wrench touch = Wrench::Zero();
  std::function<double(int joint, double time)> wobble;
  std::function<void(ArmSample* arm)> spoil;  // corrupts a sample
  std::uint64_t inputs = 0;                   // digital inputs, one bit each
  std::string trouble;
  bool silent = false;

 private:
  void Sample() {
    rig_.Read(&sample_);
    ++sequence_;
    age_ = 0;
    ArmSample& arm = sample_.arms[0];
    arm.F_S_raw += touch;
    for (int j = 0; wobble && j < arm.q.size(); ++j) arm.q[j] += wobble(j, time_);
    if (spoil) spoil(&arm);
  }
  void Pass(double dt) {
    time_ += dt;
    DeviceCommand command;
    command.state = RunState::kRun;
    command.v[0] = lead_.size() > 0 ? lead_ : command_;
    if (command.v[0].size() == 0) command.v[0].setZero(sample_.arms[0].q.size());
    rig_.Step(command, dt);
    age_ += dt;
    since_ += dt;
    if (since_ < period_ - 1e-9 || silent) return;
    since_ -= period_;
    Sample();
  }

  static constexpr double kStep = 0.001;  // [s]
  Rig rig_;
  DeviceSample sample_;
  JointVector command_, lead_;
  bool motion_ = false;
  double hardest_ = 0;
  double period_, since_ = 0, age_ = 0, time_ = 0;
  std::uint64_t sequence_ = 0;
};

class RigDriver final : public Arm {
 public:
  explicit RigDriver(RigHand* hand, bool own_wrench = true) : hand_(hand) {
    facts_.name = "arm of the rig";
    facts_.joints = static_cast<int>(hand->sample().q.size());
    facts_.own_wrench = own_wrench;
  }
  DeviceFacts& mutable_facts() { return facts_; }
  const DeviceFacts& facts() const override { return facts_; }
  Status Read(ArmReading* reading) noexcept override {
    const ArmSample& sample = hand_->sample();
    reading->q = sample.q;
    reading->v = sample.v;
    reading->sequence = hand_->sequence();
    reading->age = hand_->age();
    reading->wrench = {sample.F_S_raw, hand_->sequence(), hand_->age(), sample.sensor_saturated};
    reading->fault = !hand_->trouble.empty();
    reading->inputs = hand_->inputs;
    return hand_->trouble.empty() ? Status::Ok() : Status{StopCause::kDevice};
  }
  Status Write(const JointVector& v, bool motion) noexcept override {
    hand_->Command(v, motion);
    return hand_->trouble.empty() ? Status::Ok() : Status{StopCause::kDevice};
  }
  std::string Trouble() const override { return hand_->trouble; }

 private:
  RigHand* hand_;
  DeviceFacts facts_;
};

// Simulates a person. In each step, the reaction receives the latest message until it answers with
// a key. After its answer, the reaction receives an empty string until the next message.
class ScriptedPerson final : public Person {
 public:
  using Reaction = std::function<char(const std::string& last)>;
  explicit ScriptedPerson(Reaction react) : react_(std::move(react)) {}
  void Show(const std::string& line) override { shown.push_back(line); }
  char Key() override {
    if (++calls_ > kPatience) throw std::runtime_error("It never ends: " + shown.back());
    const char key = react_(answered_ == shown.size() ? "" : shown.back());
    if (key != 0) answered_ = shown.size();
    return key;
  }
  std::string All() const {
    std::string text;
    for (const std::string& line : shown) text += line + "\n";
    return text;
  }
  std::vector<std::string> shown;

 private:
  static constexpr int kPatience = 200'000;  // number of steps
  Reaction react_;
  std::size_t answered_ = 0;
  int calls_ = 0;
};

inline MachineArm MachineArmOf(const Scenario& scenario) {
  MachineArm side;
  side.connection.host = "192.0.2.10";
  side.arm = scenario.arm(0);
  return side;
}

inline Swings SwingAll(Session* session, Station* station, const SwingOptions& options) {
  Swings swings;
  SwingJoints(session, station, options, &swings);
  return swings;
}

}  // namespace predictor::commissioning
