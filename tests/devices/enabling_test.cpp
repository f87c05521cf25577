// An enabling device is connected to a digital input of a robot's controller. With the real
// protocol in virtual time, the arms may move only while a person presses the device.
#include <gtest/gtest.h>

#include <memory>

#include "devices/connect.h"
#include "emulator/emulator.h"
#include "fakes/far_rig.h"
#include "fakes/kinds.h"
#include "fakes/memory_network.h"
#include "fakes/note_loops.h"
#include "scenario/scenario_io.h"

namespace predictor {
namespace {

constexpr int kInput = 8;

// Real arms whose enabling device is silent while `*silent` is true, although the arms still
// respond.
class HalfHeard final : public Device {
 public:
  HalfHeard(std::unique_ptr<RealDevice> arms, const bool* silent)
      : arms_(std::move(arms)), silent_(silent) {}
  Status Read(DeviceSample* sample) noexcept override { return arms_->Read(sample); }
  Status Write(const DeviceCommand& command) noexcept override { return arms_->Write(command); }
  Enabling enabling() const noexcept override {
    return *silent_ ? Enabling::kSilent : arms_->enabling();
  }
  std::string Describe() const override { return arms_->Describe(); }

 private:
  std::unique_ptr<RealDevice> arms_;
  const bool* silent_;
};

class EnablingDevice : public testing::Test {
 protected:
  explicit EnablingDevice(bool taped = false) {
    Scenario scenario = LoadScenario(PREDICTOR_SOURCE_DIR "/scenarios/dual_ur5.yaml");
    rig_ = std::make_unique<FarRig>(scenario);
    auto network = std::make_unique<MemoryNetwork>();
    network_ = network.get();
    network_->SetWorld([this] { rig_->Step(); });
    Machine machine;
    for (int hand = 0; hand < kHands; ++hand) {
      const auto i = static_cast<std::size_t>(hand);
      MachineArm side;
      side.connection.host = "192.0.2.1" + std::to_string(hand);
      side.arm = scenario.arm(hand);
      side.arm.sample_rate = side.arm.sensor.sample_rate = 500;
      arms_[i] = MakeFake("ur", {});
      network_->Add(side.connection.host, arms_[i].get(), rig_->Hang(hand));
      (hand == 0 ? machine.left : machine.right) = side;
    }
    if (taped) Press();
    NoteLoops(&machine);
    machine.enabling = EnablingInput{"right", kInput};
    scenario.operator_.type = "person";
    ApplyMachine(machine, &scenario);
    emulator_ = std::make_unique<Emulator>(
        scenario, std::make_unique<HalfHeard>(
                      ConnectMachine(machine, &scenario, std::move(network)), &silent_));
  }
  void Tick(int ticks = 1) {
    for (; ticks > 0; --ticks) {
      network_->Pass(0.001);
      emulator_->Tick(network_->Now());
      rig_->SetRunning(emulator_->state() == RunState::kRun);
    }
  }
  bool Await(RunState state, int patience = 20'000) {
    for (; patience > 0 && emulator_->state() != state; --patience) Tick();
    return emulator_->state() == state;
  }
  void Press() { arms_[1]->Do("press " + std::to_string(kInput)); }
  void Release() { arms_[1]->Do("release " + std::to_string(kInput)); }
  void PressAgain() {
    Release();
    Tick(50);
    Press();
    Tick(50);
  }
  Refusal Ask(RunEvent event) {
    emulator_->Request(event);
    Tick();
    return static_cast<Refusal>(emulator_->record().why_refused);
  }
  bool ToRun() {
    if (!Await(RunState::kIdle)) return false;
    Press();
    Tick(50);
    Ask(RunEvent::kAlignRequested);
    if (!Await(RunState::kArmed)) return false;
    Ask(RunEvent::kStartRequested);
    return emulator_->state() == RunState::kRun;
  }
  bool HasCause(StopCause cause) const { return emulator_->record().cause == cause; }

  std::unique_ptr<FarRig> rig_;
  std::array<std::unique_ptr<FakeDevice>, kHands> arms_;
  MemoryNetwork* network_ = nullptr;  // owned by the emulator's device
  bool silent_ = false;               // state of the enabling device
  std::unique_ptr<Emulator> emulator_;
};

TEST_F(EnablingDevice, IsNeededToAlignAndToStart) {
  ASSERT_TRUE(Await(RunState::kIdle));
  EXPECT_EQ(Ask(RunEvent::kAlignRequested), Refusal::kNotEnabled);
  arms_[0]->Do("press " + std::to_string(kInput));      // input of the other arm
  arms_[1]->Do("press " + std::to_string(kInput - 1));  // wrong input
  Tick(50);
  EXPECT_EQ(Ask(RunEvent::kAlignRequested), Refusal::kNotEnabled);
  ASSERT_TRUE(ToRun());
  Tick(3000);
  EXPECT_EQ(emulator_->state(), RunState::kRun);  // continues while it is pressed
}

// The controller's cycle takes 2 ms. One tick reads the input of the device, and the next tick
// responds to it.
TEST_F(EnablingDevice, LettingGoStopsAtOnce) {
  ASSERT_TRUE(ToRun());
  Tick(1500);
  Release();
  Tick(4);
  EXPECT_EQ(emulator_->state(), RunState::kStopping);
  EXPECT_TRUE(HasCause(StopCause::kEnabling));
  EXPECT_EQ(emulator_->record().cause_quantity, Quantity::kNone);  // not by a time-out
  EXPECT_TRUE(Await(RunState::kHeld));
}

class TapedDevice : public EnablingDevice {
 protected:
  TapedDevice() : EnablingDevice(true) {}
};

TEST_F(TapedDevice, DoesNotCountBeforeItWasReleased) {
  ASSERT_TRUE(Await(RunState::kIdle));
  Tick(200);
  EXPECT_EQ(Ask(RunEvent::kAlignRequested), Refusal::kNotEnabled);
  PressAgain();
  EXPECT_EQ(Ask(RunEvent::kAlignRequested), Refusal::kNone);
  EXPECT_EQ(emulator_->state(), RunState::kAlign);
}

TEST_F(EnablingDevice, AfterAStopItMustBeReleasedFirst) {
  ASSERT_TRUE(ToRun());
  Tick(500);
  Ask(RunEvent::kStopRequested);
  ASSERT_TRUE(Await(RunState::kHeld));
  Tick(1000);
  EXPECT_EQ(Ask(RunEvent::kRecoverRequested), Refusal::kNotEnabled);
  ASSERT_EQ(Ask(RunEvent::kReset), Refusal::kNone);
  EXPECT_EQ(Ask(RunEvent::kAlignRequested), Refusal::kNotEnabled);
  Release();
  Tick(50);
  EXPECT_EQ(Ask(RunEvent::kAlignRequested), Refusal::kNotEnabled);
  Press();
  Tick(50);
  EXPECT_EQ(Ask(RunEvent::kAlignRequested), Refusal::kNone);
}

// A release during the silence would have remained undetected.
TEST_F(EnablingDevice, AfterSilenceDuringAStopItMustBeReleasedToo) {
  ASSERT_TRUE(ToRun());
  Tick(500);
  silent_ = true;
  Tick(10);
  Ask(RunEvent::kStopRequested);
  ASSERT_TRUE(Await(RunState::kHeld));
  silent_ = false;
  Tick(1000);
  ASSERT_EQ(Ask(RunEvent::kReset), Refusal::kNone);
  EXPECT_EQ(Ask(RunEvent::kAlignRequested), Refusal::kNotEnabled);
  PressAgain();
  EXPECT_EQ(Ask(RunEvent::kAlignRequested), Refusal::kNone);
}

// A replay repeats a run from its records, so they must contain the state of the device.
TEST_F(EnablingDevice, IsRecordedAsAnInput) {
  ASSERT_TRUE(Await(RunState::kIdle));
  Press();
  int pressed = 0, released = 0;
  for (int k = 0; k < 500; ++k) {
    if (k == 300) Release();
    Tick();
    const TickRecord& record = emulator_->record();
    for (std::size_t i = 0; i < record.input_count; ++i) {
      ASSERT_EQ(record.inputs[i].kind, InputKind::kEnable);
      (record.inputs[i].value > 0 ? pressed : released) += 1;
    }
  }
  EXPECT_GE(pressed, 10);  // frequent enough for the time-out of 0.1 s
  EXPECT_LE(pressed, 20);
  EXPECT_EQ(released, 1);
}

}  // namespace
}  // namespace predictor
