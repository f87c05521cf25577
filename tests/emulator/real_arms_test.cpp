// Tests how real arms differ from simulated ones: a person must enable every motion, and more
// requests are refused. real_arms_stop_test.cpp covers stops, real_arms_recovery_test.cpp covers
// RECOVERY.
#include "real_arms.h"

#include <thread>

#include "emulator/arm_side.h"
#include "emulator/run_loop.h"

namespace predictor {
namespace {

// The gravity in the scenario's world must not affect a real handle. The program compensates the
// weight of the real handle with the local gravity, and a rotation of the handle must not look like
// a hand's force.
TEST(RealHandles, WeighWhatTheyWeighHere) {
  Scenario scenario = LoadTestScenario("box_9kg", {});
  const JointVector start = Emulator(scenario).setup().start[0];
  scenario.device.type = "real";
  const auto force = [&](double gravity) {
    scenario.environment.gravity = gravity;
    ArmSide arm(scenario, 0, 0.001);
    ArmSample sample;
    sample.present = true;
    sample.q = start;
    sample.v = JointVector::Zero(sample.q.size());
    arm.BeginTare();
    for (int k = 0; k < 300; ++k) EXPECT_TRUE(arm.Tare(sample).ok());
    EXPECT_TRUE(arm.FinishTare().ok());
    sample.q[5] += 1;
    for (int k = 0; k < 300; ++k) EXPECT_TRUE(arm.Update(sample).ok());
    return Vector3(arm.wrench().F_H_W.head<3>());
  };
  const Vector3 here = force(9.81);
  EXPECT_GT(here.norm(),
            1);  // the fake reading stays zero although the weight turns, so a force must appear
  EXPECT_LT((force(0) - here).norm(), 1e-9);
}

TEST_F(RealArms, NothingBeginsByItself) {
  ASSERT_TRUE(Await(RunState::kIdle));
  for (int i = 0; i < 2000; ++i) {
    Tick();
    AutoStart(emulator_.get());
  }
  EXPECT_EQ(emulator_->state(), RunState::kIdle);
}

TEST_F(RealArms, AlignAndStartNeedTheKey) {
  ASSERT_TRUE(Await(RunState::kIdle));
  Ask(RunEvent::kAlignRequested);
  EXPECT_EQ(emulator_->state(), RunState::kIdle);
  EXPECT_EQ(record().refused, 1 + static_cast<int>(RunEvent::kAlignRequested));
  EXPECT_EQ(Why(), Refusal::kNotEnabled);
  Tick();
  EXPECT_EQ(record().refused, 0);  // reported only once
  holds_ = true;
  Tick(40);
  Ask(RunEvent::kAlignRequested);
  ASSERT_TRUE(Await(RunState::kArmed));
  holds_ = false;
  Tick(200);
  EXPECT_EQ(emulator_->state(), RunState::kArmed);  // ARMED allows no motion
  Ask(RunEvent::kStartRequested);
  EXPECT_EQ(Why(), Refusal::kNotEnabled);
  EXPECT_EQ(emulator_->state(), RunState::kArmed);
}

TEST_F(RealArms, NothingIsAlignedWhileAHandleIsNotFree) {
  ASSERT_TRUE(ToEnabled());
  device_->spoil = [](DeviceSample* sample) { sample->arms[1].F_S_raw[0] += 6; };
  Tick(200);
  Ask(RunEvent::kAlignRequested);
  EXPECT_EQ(emulator_->state(), RunState::kIdle);
  EXPECT_EQ(Why(), Refusal::kNotFree);
  device_->spoil = nullptr;
  Tick(200);
  Ask(RunEvent::kAlignRequested);
  EXPECT_EQ(emulator_->state(), RunState::kAlign);
}

// A page may stop real arms. A page must not align, start or reset real arms, even while a person
// holds the key.
TEST_F(RealArms, NothingBeginsFromAfar) {
  const auto from_afar = [this](InputKind kind) {
    RunInput input;
    input.kind = kind;
    EXPECT_FALSE(emulator_->Submit(input));
    Tick(10);
    return emulator_->state();
  };
  ASSERT_TRUE(ToEnabled());
  EXPECT_EQ(from_afar(InputKind::kAlign), RunState::kIdle);
  Ask(RunEvent::kAlignRequested);
  ASSERT_TRUE(Await(RunState::kArmed));
  EXPECT_EQ(from_afar(InputKind::kStart), RunState::kArmed);
  Ask(RunEvent::kStopRequested);
  ASSERT_TRUE(Await(RunState::kHeld));
  Tick(1000);
  EXPECT_EQ(from_afar(InputKind::kReset), RunState::kHeld);
}

// A saved state must include the poses of the aligned handles.
TEST_F(RealArms, ASavedStateThatIsArmedStarts) {
  ASSERT_TRUE(ToEnabled());
  Ask(RunEvent::kAlignRequested);
  ASSERT_TRUE(Await(RunState::kArmed));
  std::vector<std::byte> state(1U << 20U);
  state.resize(emulator_->SaveState(state));
  ASSERT_FALSE(state.empty());
  Ask(RunEvent::kStopRequested);  // moves the handles away from their poses in the saved state
  emulator_->LoadState(state);
  Ask(RunEvent::kStartRequested);
  EXPECT_EQ(emulator_->state(), RunState::kRun);
}

// Someone moved the arm after the alignment, so a start would pull the handle back.
TEST_F(RealArms, NothingStartsUnaligned) {
  ASSERT_TRUE(ToEnabled());
  Ask(RunEvent::kAlignRequested);
  ASSERT_TRUE(Await(RunState::kArmed));
  double led = 0;
  device_->spoil = [&led](DeviceSample* sample) { sample->arms[0].q[1] += led; };
  for (; led < 0.01; led += 1e-4) Tick();
  Ask(RunEvent::kStartRequested);
  EXPECT_EQ(emulator_->state(), RunState::kArmed);
  EXPECT_EQ(Why(), Refusal::kNotAligned);
  for (; led > 1e-3; led -= 1e-4) Tick();
  Ask(RunEvent::kStartRequested);
  EXPECT_EQ(emulator_->state(), RunState::kRun);
}

TEST_F(RealArms, LettingGoStopsWithinATenthOfASecond) {
  ASSERT_TRUE(ToRun());
  Tick(1500);
  ASSERT_EQ(emulator_->state(), RunState::kRun);
  holds_ = false;
  Tick(102);  // the last letter of the key may be 30 ms old
  EXPECT_EQ(emulator_->state(), RunState::kStopping);
  EXPECT_EQ(record().cause, StopCause::kEnabling);
  EXPECT_EQ(record().cause_quantity, Quantity::kTime);
  EXPECT_NEAR(record().cause_value, 0.1, 0.0021);
  EXPECT_TRUE(Await(RunState::kHeld));
}

TEST_F(RealArms, LettingGoStopsTheAligningToo) {
  ASSERT_TRUE(ToEnabled());
  Ask(RunEvent::kAlignRequested);
  Tick(50);
  ASSERT_EQ(emulator_->state(), RunState::kAlign);
  holds_ = false;
  Tick(102);
  EXPECT_EQ(record().cause, StopCause::kEnabling);
  EXPECT_TRUE(Await(RunState::kHeld));
}

// The first samples may have been queued while other devices were connected.
TEST_F(RealArms, BeginWithOldSamplesThatFreshOnesFollow) {
  int reads = 0;
  device_->spoil = [&reads](DeviceSample* sample) {
    if (++reads < 100) sample->arms[0].sensor_age = 0.25;
  };
  Tick(50);
  EXPECT_EQ(emulator_->state(), RunState::kInit);
  EXPECT_TRUE(Await(RunState::kIdle));
}

TEST_F(RealArms, ThatGiveNoFreshSamplesAreNotWaitedForLong) {
  device_->spoil = [](DeviceSample* sample) { sample->arms[0].sensor_age = 0.25; };
  EXPECT_TRUE(Await(RunState::kUnpowered, 300));
  EXPECT_EQ(record().cause, StopCause::kStale);
}

// The bias of a sensor is unknown until the first self-test has passed. A large bias must neither
// stop the run nor count as a hand.
TEST_F(RealArms, AfterAFailedSelfTestTheBiasIsNotTakenForAHand) {
  int tick = 0;
  device_->spoil = [&tick](DeviceSample* sample) {
    sample->arms[0].F_S_raw[1] += 40 + (tick++ < 400 ? tick % 7 : 0);
  };
  ASSERT_TRUE(Await(RunState::kUnpowered));
  EXPECT_EQ(record().cause, StopCause::kSensor);
  EXPECT_EQ(record().cause_hand, 0);
  EXPECT_EQ(record().cause_quantity, Quantity::kForce);
  EXPECT_GT(record().cause_value, record().cause_limit);
  Tick(1000);
  Ask(RunEvent::kReset);
  ASSERT_EQ(emulator_->state(), RunState::kSelfTest);
  EXPECT_TRUE(Await(RunState::kIdle));
}

// In this test, a person uses a foot switch instead of the key. tests/devices/enabling_test.cpp
// covers a device at a robot's input.
class FootSwitch : public RealArms {
 protected:
  FootSwitch() { device_->foot = Enabling::kReleased; }
  void Put(Enabling foot, int ticks) {
    device_->foot = foot;
    Tick(ticks);
  }
  bool Run() {
    if (!Await(RunState::kIdle)) return false;
    Put(Enabling::kPressed, 10);
    Ask(RunEvent::kAlignRequested);
    if (!Await(RunState::kArmed)) return false;
    Ask(RunEvent::kStartRequested);
    return Await(RunState::kRun, 10);
  }
};

TEST_F(FootSwitch, EnablesWhileItIsPressedAndStopsAtOnceWhenItIsNot) {
  ASSERT_TRUE(Run());
  Tick(1000);
  ASSERT_EQ(emulator_->state(), RunState::kRun);
  Put(Enabling::kReleased, 2);
  EXPECT_EQ(emulator_->state(), RunState::kStopping);
  EXPECT_EQ(record().cause, StopCause::kEnabling);
}

TEST_F(FootSwitch, CountsAsReleasedAfterATenthOfASecondOfSilence) {
  ASSERT_TRUE(Run());
  Tick(500);
  Put(Enabling::kSilent, 75);
  EXPECT_EQ(emulator_->state(), RunState::kRun);
  Tick(30);
  EXPECT_EQ(emulator_->state(), RunState::kStopping);
  EXPECT_EQ(record().cause, StopCause::kEnabling);
}

TEST_F(FootSwitch, DoesNotCountUntilItWasReleased) {
  device_->foot = Enabling::kPressed;  // taped down
  ASSERT_TRUE(Await(RunState::kIdle));
  Tick(200);
  Ask(RunEvent::kAlignRequested);
  EXPECT_EQ(Why(), Refusal::kNotEnabled);
  Put(Enabling::kReleased, 2);
  Put(Enabling::kPressed, 2);
  Ask(RunEvent::kAlignRequested);
  EXPECT_EQ(emulator_->state(), RunState::kAlign);
}

TEST_F(FootSwitch, StillPressedAfterAStopDoesNotCount) {
  ASSERT_TRUE(Run());
  Tick(500);
  Ask(RunEvent::kStopRequested);
  ASSERT_TRUE(Await(RunState::kHeld));
  Tick(1000);
  Ask(RunEvent::kRecoverRequested);
  EXPECT_EQ(Why(), Refusal::kNotEnabled);
  EXPECT_EQ(emulator_->state(), RunState::kHeld);
}

// In each state with motion, one arm is not yet ready to move.
class WaitsForAnArm : public RealArms {
 protected:
  WaitsForAnArm() {
    device_->spoil = [this](DeviceSample* sample) {
      sample->arms[hand_].waits = waits_;
      if (presses_) sample->arms[1].F_S_raw[2] += 20;
    };
  }
  double FastestCommand() const {
    double fastest = 0;
    for (const HandRecord& hand : record().hands)
      for (const double v : hand.command) fastest = std::max(fastest, std::abs(v));
    return fastest;
  }
  void ExpectNothingMovesBeforeItCan(RunState state) {
    for (int k = 0; k < 300; ++k) {
      ASSERT_EQ(emulator_->state(), state);
      EXPECT_EQ(FastestCommand(), 0) << k;
      EXPECT_EQ(record().hands[hand_].arm_waits, 1);
      EXPECT_EQ(record().run_time, run_time_);
      Tick();
    }
    waits_ = false;
    Tick(200);
    EXPECT_GT(FastestCommand(), 1e-4);
  }
  std::size_t hand_ = 0;
  bool waits_ = true, presses_ = false;
  double run_time_ = 0;
};

TEST_F(WaitsForAnArm, ToAlign) {
  ASSERT_TRUE(ToEnabled());
  Ask(RunEvent::kAlignRequested);
  ExpectNothingMovesBeforeItCan(RunState::kAlign);
}

TEST_F(WaitsForAnArm, ToRun) {
  for (hand_ = 0; hand_ < kHands; ++hand_) {
    waits_ = false;
    ASSERT_TRUE(ToEnabled());
    Ask(RunEvent::kAlignRequested);
    ASSERT_TRUE(Await(RunState::kArmed));
    waits_ = true;
    Ask(RunEvent::kStartRequested);
    ExpectNothingMovesBeforeItCan(RunState::kRun);
    EXPECT_NEAR(record().run_time, 0.2, 2e-3);
    Ask(RunEvent::kStopRequested);
    ASSERT_TRUE(Await(RunState::kHeld));
    Tick(1000);
    Ask(RunEvent::kReset);
  }
}

TEST_F(WaitsForAnArm, ToRecover) {
  waits_ = false;
  ASSERT_TRUE(ToRun());
  Tick(500);
  Ask(RunEvent::kStopRequested);
  ASSERT_TRUE(Await(RunState::kHeld));
  run_time_ = record().run_time;
  waits_ = presses_ = true;
  Tick(40);
  Ask(RunEvent::kRecoverRequested);
  ExpectNothingMovesBeforeItCan(RunState::kRecovery);
}

// Taring must cause no visible force while it averages or when it ends. Taring must cause no
// visible force even if the bias has changed while the sensor had no power.
TEST_F(RealArms, TaringIsBumpless) {
  double bias = 40, felt = 0;
  device_->spoil = [&bias](DeviceSample* sample) { sample->arms[0].F_S_raw[1] += bias; };
  const auto feel = [&](RunState until) {
    felt = 0;
    for (int k = 0; k < 3000 && emulator_->state() != until; ++k) {
      Tick();
      if (emulator_->state() != RunState::kUnpowered)
        felt = std::max(felt, Eigen::Map<const Vector6>(record().hands[0].wrench.data()).norm());
    }
    for (int k = 0; k < 200; ++k) {
      Tick();
      felt = std::max(felt, Eigen::Map<const Vector6>(record().hands[0].wrench.data()).norm());
    }
    return emulator_->state() == until;
  };
  ASSERT_TRUE(feel(RunState::kIdle));
  EXPECT_LT(felt, 0.5);  // noise of the sensor
  Ask(RunEvent::kStopAndPowerOff);
  ASSERT_TRUE(Await(RunState::kUnpowered));
  bias += 3;
  Tick(1000);
  Ask(RunEvent::kReset);
  ASSERT_EQ(emulator_->state(), RunState::kSelfTest);
  ASSERT_TRUE(feel(RunState::kIdle));
  EXPECT_LT(felt, 0.5);
}

TEST(RealTimeArms, CannotBeEnabledRemotely) {
  Scenario scenario = LoadTestScenario("box_9kg");
  const auto start = Emulator(scenario).setup().start;
  auto device = std::make_unique<PassedOff>(scenario, start);
  scenario.device.type = "real";
  Emulator emulator(scenario, std::move(device));
  const auto ring = std::make_unique<RecordRing>();
  Shared<RunMailbox> mailbox;
  RunInput key;
  key.kind = InputKind::kEnable;
  key.value = 1;
  std::atomic<bool> quit{false}, over{false}, moved{false}, refused{false}, stopped{false};
  // Even if a page repeatedly claims that the key is held, the rig must refuse a request to align,
  // because no person at the rig holds the key. (On a busy computer, missed ticks may stop the run
  // instead.)
  std::thread ends([&] {
    TickRecord record;
    RingReader<TickRecord, kRecordRing> reader(*ring);
    for (int idle = 0; idle < 200 && !over;) {
      if (!reader.Next(&record)) {
        std::this_thread::yield();
        continue;
      }
      mailbox->inputs.Push(key);
      if (record.state == RunState::kIdle && ++idle > 20)
        emulator.Request(RunEvent::kAlignRequested);
      moved = moved || FollowsTask(record.state);
      stopped = stopped || record.cause != StopCause::kNone;
      refused = refused || (record.refused != 0 &&
                            static_cast<Refusal>(record.why_refused) == Refusal::kNotEnabled);
    }
    quit = true;
  });
  RealTimeOptions options;
  options.duration = 10;
  options.mailbox = &*mailbox;
  RealTimeReport report;
  RunRealTime(&emulator, options, quit, ring.get(), &report);
  over = true;
  ends.join();
  EXPECT_GT(report.ticks, 0u);
  EXPECT_FALSE(moved);
  EXPECT_TRUE(refused || stopped);
}

}  // namespace
}  // namespace predictor
