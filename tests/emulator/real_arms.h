// Presents the simulated rig to the emulator as a real device.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "devices/simulated/simulated_device.h"
#include "emulator/emulator.h"
#include "runs.h"

namespace predictor {

class PassedOff final : public Device {
 public:
  PassedOff(const Scenario& scenario, const std::array<JointVector, kHands>& start)
      : device_(scenario, start, MakeOperator(scenario, HandInertia::kInWrench)) {}

  Status Read(DeviceSample* sample) noexcept override {
    const Status status = device_.Read(sample);
    if (spoil) spoil(sample);
    return status;
  }
  Status Write(const DeviceCommand& command) noexcept override { return device_.Write(command); }
  Enabling enabling() const noexcept override { return foot; }
  std::string Describe() const override { return "arms passed off as real"; }

  std::function<void(DeviceSample*)> spoil;
  Enabling foot = Enabling::kNone;  // state of the foot switch

 private:
  SimulatedDevice device_;
};

class RealArms : public testing::Test {
 protected:
  explicit RealArms(const std::vector<std::string>& set = {}) {
    Scenario scenario = LoadTestScenario("box_9kg", set);
    std::array<JointVector, kHands> start = Emulator(scenario).setup().start;
    for (JointVector& q : start) q[0] += 0.01;
    auto device = std::make_unique<PassedOff>(scenario, start);
    device_ = device.get();
    scenario.device.type = "real";
    emulator_ = std::make_unique<Emulator>(scenario, std::move(device));
  }

  void Tick(int ticks = 1) {
    for (; ticks > 0; --ticks) {
      if (holds_ && ++held_ % 30 == 0) {
        RunInput key;
        key.kind = InputKind::kEnable;
        key.value = 1;
        emulator_->Submit(key);
      }
      emulator_->Tick();
      refused_ |= record().refused != 0;
    }
  }
  bool Await(RunState state, int patience = 20'000) {
    for (; patience > 0 && emulator_->state() != state; --patience) Tick();
    return emulator_->state() == state;
  }
  void Ask(RunEvent event) {
    emulator_->Request(event);
    Tick();
  }
  Refusal Why() const { return static_cast<Refusal>(record().why_refused); }
  // Waits for IDLE and then holds the key.
  bool ToEnabled() {
    if (!Await(RunState::kIdle)) return false;
    holds_ = true;
    Tick(40);
    return true;
  }
  bool ToRun() {
    if (!ToEnabled()) return false;
    Ask(RunEvent::kAlignRequested);
    if (!Await(RunState::kArmed)) return false;
    Ask(RunEvent::kStartRequested);
    return Await(RunState::kRun, 10);
  }
  const TickRecord& record() const { return emulator_->record(); }

  PassedOff* device_;
  std::unique_ptr<Emulator> emulator_;
  bool holds_ = false, refused_ = false;
  int held_ = 0;
};

}  // namespace predictor
