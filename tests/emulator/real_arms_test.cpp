// What changes when the arms are real: nobody is there but a person who enables, and what is
// refused. The device is the simulated rig, passed off as a real one.
#include <gtest/gtest.h>

#include <functional>
#include <thread>

#include "core/motion.h"
#include "devices/simulated/simulated_device.h"
#include "emulator/arm_side.h"
#include "emulator/run_loop.h"
#include "handle_speeds.h"
#include "runs.h"

namespace predictor {
namespace {

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
  Enabling foot = Enabling::kNone;  // on a switch

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
  bool ToRun() {
    if (!Await(RunState::kIdle)) return false;
    holds_ = true;
    Tick(40);
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

// What weighs in a scenario's world is its own affair: the real handle's weight is taken off as it
// is here, and a turn of the wrist makes no hand.
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
            1);  // a sensor that reads nothing says that a hand bears the weight's turn
  EXPECT_LT((force(0) - here).norm(), 1e-9);
}

TEST_F(RealArms, NothingBeginsByItself) {
  ASSERT_TRUE(Await(RunState::kIdle));
  for (int i = 0; i < 2000; ++i) {
    Tick();
    StartByItself(emulator_.get());
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
  EXPECT_EQ(record().refused, 0);  // told once
  holds_ = true;
  Tick(40);
  Ask(RunEvent::kAlignRequested);
  ASSERT_TRUE(Await(RunState::kArmed));
  holds_ = false;
  Tick(200);
  EXPECT_EQ(emulator_->state(), RunState::kArmed);  // nothing moves there
  Ask(RunEvent::kStartRequested);
  EXPECT_EQ(Why(), Refusal::kNotEnabled);
  EXPECT_EQ(emulator_->state(), RunState::kArmed);
}

TEST_F(RealArms, NothingIsAlignedWhileAHandleIsNotFree) {
  ASSERT_TRUE(Await(RunState::kIdle));
  holds_ = true;
  Tick(40);
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

TEST_F(RealArms, LettingGoStopsWithinATenthOfASecond) {
  ASSERT_TRUE(ToRun());
  Tick(1500);
  ASSERT_EQ(emulator_->state(), RunState::kRun);
  holds_ = false;
  Tick(102);  // the key's last sign may be 30 ms old
  EXPECT_EQ(emulator_->state(), RunState::kStopping);
  EXPECT_EQ(record().cause, StopCause::kEnabling);
  EXPECT_EQ(record().cause_quantity, Quantity::kTime);
  EXPECT_NEAR(record().cause_value, 0.1, 0.0021);
  EXPECT_TRUE(Await(RunState::kHeld));
}

TEST_F(RealArms, LettingGoStopsTheAligningToo) {
  ASSERT_TRUE(Await(RunState::kIdle));
  holds_ = true;
  Tick(40);
  Ask(RunEvent::kAlignRequested);
  Tick(50);
  ASSERT_EQ(emulator_->state(), RunState::kAlign);
  holds_ = false;
  Tick(102);
  EXPECT_EQ(record().cause, StopCause::kEnabling);
  EXPECT_TRUE(Await(RunState::kHeld));
}

// What is read first may have stood in line while everything was connected to.
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

TEST_F(RealArms, AResetWaitsUntilBothArmsStand) {
  ASSERT_TRUE(ToRun());
  Ask(RunEvent::kStopAndPowerOff);
  ASSERT_TRUE(Await(RunState::kUnpowered));
  Tick(600);
  for (const int joint : {0, 6}) {  // the handle goes, or turns
    device_->spoil = [joint](DeviceSample* sample) { sample->arms[1].v[joint] += 0.2; };
    Tick(200);  // it is no push any more
    Ask(RunEvent::kReset);
    EXPECT_EQ(Why(), Refusal::kMoves);
    EXPECT_EQ(emulator_->state(), RunState::kUnpowered);
  }
  device_->spoil = nullptr;
  Tick(200);
  Ask(RunEvent::kReset);
  EXPECT_EQ(emulator_->state(), RunState::kSelfTest);
}

TEST_F(RealArms, AResetWaitsUntilTheCauseIsGone) {
  ASSERT_TRUE(ToRun());
  Tick(200);
  device_->spoil = [](DeviceSample* sample) { sample->arms[0].sensor_age = 0.008; };
  ASSERT_TRUE(Await(RunState::kHeld));
  EXPECT_EQ(record().cause, StopCause::kStale);
  Tick(1000);
  Ask(RunEvent::kReset);
  EXPECT_EQ(Why(), Refusal::kCauseRemains);
  EXPECT_EQ(emulator_->state(), RunState::kHeld);
  device_->spoil = nullptr;
  Tick(400);
  Ask(RunEvent::kReset);
  EXPECT_EQ(Why(), Refusal::kCauseRemains);
  Tick(150);
  Ask(RunEvent::kReset);
  EXPECT_EQ(emulator_->state(), RunState::kIdle);
  EXPECT_EQ(record().cause, StopCause::kNone);
}

TEST_F(RealArms, AResetWaitsUntilTheHandsAreFree) {
  ASSERT_TRUE(ToRun());
  Tick(500);
  Ask(RunEvent::kStopRequested);
  ASSERT_TRUE(Await(RunState::kHeld));
  device_->spoil = [](DeviceSample* sample) { sample->arms[1].F_S_raw[0] += 12; };
  Tick(1000);
  Ask(RunEvent::kReset);
  EXPECT_EQ(Why(), Refusal::kHandLoaded);
  EXPECT_EQ(emulator_->state(), RunState::kHeld);
}

// The handle goes where the hand presses, slowly, and stands when the key is let go; then a reset
// is still needed.
TEST_F(RealArms, RecoveryFreesAHandAfterAStop) {
  ASSERT_TRUE(ToRun());
  Tick(500);
  Ask(RunEvent::kStopRequested);
  ASSERT_TRUE(Await(RunState::kHeld));
  device_->spoil = [](DeviceSample* sample) { sample->arms[1].F_S_raw[2] += 20; };
  Tick(300);
  holds_ = true;
  Tick(40);
  Ask(RunEvent::kRecoverRequested);
  ASSERT_EQ(emulator_->state(), RunState::kRecovery);
  const HandRecord& hand = record().hands[1];
  const PoseRecord before = hand.real.pose;
  double power = 0, fastest = 0;
  for (int i = 0; i < 1000; ++i) {
    Tick();
    for (int k = 0; k < 6; ++k) power += 0.001 * hand.wrench[k] * hand.real.twist[k];
    fastest =
        std::max(fastest, std::hypot(hand.real.twist[0], hand.real.twist[1], hand.real.twist[2]));
    EXPECT_LT(Eigen::Map<const Eigen::VectorXd>(record().hands[0].command.data(), 7).norm(), 1e-12);
  }
  EXPECT_EQ(emulator_->state(), RunState::kRecovery);
  EXPECT_GT(power, 0.05);
  EXPECT_LT(fastest, 0.055);  // 50 mm/s, and the sensor's idea of it
  EXPECT_GT(std::hypot(hand.real.pose.p[0] - before.p[0], hand.real.pose.p[1] - before.p[1],
                       hand.real.pose.p[2] - before.p[2]),
            0.01);
  holds_ = false;
  ASSERT_TRUE(Await(RunState::kHeld, 1000));
  EXPECT_EQ(record().cause, StopCause::kOperator);
}

// A hand that pulls this way and that: the command turns round without ever being too fast, and
// comes to rest as one when the key is let go.
TEST_F(RealArms, RecoveryIsSlowWhateverTheHandDoes) {
  ASSERT_TRUE(ToRun());
  Tick(500);
  Ask(RunEvent::kStopRequested);
  ASSERT_TRUE(Await(RunState::kHeld));
  int ticks = 0;
  device_->spoil = [&](DeviceSample* sample) {
    for (int i = 0; i < kHands; ++i) {
      const int part = ++ticks / 2 / 150 + i;
      sample->arms[static_cast<std::size_t>(i)].F_S_raw[part % 3] += part % 2 == 0 ? 25 : -25;
    }
  };
  holds_ = true;
  Tick(40);
  Ask(RunEvent::kRecoverRequested);
  ASSERT_EQ(emulator_->state(), RunState::kRecovery);
  HandleSpeeds handles(emulator_->scenario());
  constexpr double kCap = 0.05, kPosture = 1.03;
  double fastest = 0;
  for (int i = 0; i < 3000; ++i) {
    Tick();
    ASSERT_EQ(emulator_->state(), RunState::kRecovery) << Name(record().cause);
    const Speeds now = handles.Commanded(record());
    fastest = std::max(fastest, now.translation);
    EXPECT_LE(now.translation, kPosture * kCap);
    EXPECT_LE(0.2 * now.rotation, kPosture * kCap);
  }
  EXPECT_GT(fastest, 0.8 * kCap);
  holds_ = false;
  std::vector<Eigen::Matrix<double, 14, 1>> sent;
  while (emulator_->state() == RunState::kRecovery) {
    Tick();
    sent.emplace_back();
    for (int i = 0; i < kHands; ++i)
      sent.back().segment<7>(7 * i) =
          Eigen::Map<const Eigen::VectorXd>(record().hands[i].command.data(), 7);
  }
  // Let go, all joints brake by one factor.
  ASSERT_GT(sent.size(), 10U);
  EXPECT_EQ(sent.back().norm(), 0);
  for (std::size_t k = sent.size() - 6; k < sent.size(); ++k) {
    const double factor = sent[k].norm() / sent[k - 1].norm();
    EXPECT_LT(factor, 1);
    EXPECT_LT((sent[k] - factor * sent[k - 1]).norm(), 1e-12);
  }
}

// What presses when it begins is what it is for; what comes on top of that stops it, and it may be
// asked for again.
TEST_F(RealArms, RecoveryStopsWhenAHandIsLoadedMore) {
  ASSERT_TRUE(ToRun());
  Tick(500);
  Ask(RunEvent::kStopRequested);
  ASSERT_TRUE(Await(RunState::kHeld));
  double force = 45;
  device_->spoil = [&](DeviceSample* sample) { sample->arms[1].F_S_raw[2] += force; };
  holds_ = true;
  Tick(300);
  Ask(RunEvent::kRecoverRequested);
  Tick(500);
  ASSERT_EQ(emulator_->state(), RunState::kRecovery) << Name(record().cause);
  force = 45 + emulator_->scenario().safety.force / 3 + 3;
  Tick(20);
  EXPECT_EQ(emulator_->state(), RunState::kStopping);
  EXPECT_EQ(record().cause, StopCause::kForce);
  EXPECT_EQ(record().cause_hand, 1);
  ASSERT_TRUE(Await(RunState::kHeld, 1000));
  Ask(RunEvent::kRecoverRequested);
  EXPECT_EQ(emulator_->state(), RunState::kRecovery);
}

// A run's time that is over ends the run, not what frees a hand after it; who ends the program ends
// that too.
TEST_F(RealArms, RecoveryAfterARunsEndGoesOnUntilTheProgramIsToEnd) {
  ASSERT_TRUE(ToRun());
  Tick(500);
  EXPECT_TRUE(IsOver(*emulator_, 0.1));
  for (const bool stopped : {false, true}) {
    if (stopped)
      Ask(RunEvent::kStopRequested);
    else
      emulator_->RequestEnd();
    ASSERT_TRUE(Await(RunState::kHeld));
    device_->spoil = [&](DeviceSample* sample) { sample->arms[1].F_S_raw[2] += 20; };
    Ask(RunEvent::kRecoverRequested);
    Tick(200);
    ASSERT_EQ(emulator_->state(), RunState::kRecovery) << Name(record().cause);
    EXPECT_GT(emulator_->run_time(), 0.1);
    EXPECT_FALSE(IsOver(*emulator_, 0.1));
    emulator_->RequestEnd();
    Tick();
    EXPECT_EQ(emulator_->state(), RunState::kStopping);
    ASSERT_TRUE(Await(RunState::kHeld));
    if (stopped) break;
    Ask(RunEvent::kRecoverRequested);  // for the next stop to have something to stop
    Tick(100);
    ASSERT_EQ(emulator_->state(), RunState::kRecovery);
  }
}

TEST_F(RealArms, RecoveryIsNoWayToRun) {
  ASSERT_TRUE(ToRun());
  Tick(200);
  Ask(RunEvent::kStopRequested);
  ASSERT_TRUE(Await(RunState::kHeld));
  Ask(RunEvent::kStartRequested);
  Ask(RunEvent::kAlignRequested);
  EXPECT_EQ(emulator_->state(), RunState::kHeld);
}

TEST_F(RealArms, AStopInRecoveryStops) {
  ASSERT_TRUE(Await(RunState::kIdle));
  holds_ = true;
  Tick(40);
  device_->spoil = [](DeviceSample* sample) { sample->arms[0].F_S_raw[2] += 20; };
  Ask(RunEvent::kRecoverRequested);
  Tick(300);
  ASSERT_EQ(emulator_->state(), RunState::kRecovery);
  device_->spoil = [](DeviceSample* sample) { sample->arms[0].sensor_saturated = true; };
  Tick(2);
  EXPECT_EQ(emulator_->state(), RunState::kStopping);
  EXPECT_TRUE(Await(RunState::kUnpowered));
}

// Severities: what says that an arm cannot be trusted to hold ends without power; what is worse
// than the cause makes the end of a stop harder.
TEST_F(RealArms, TheMostSevereWins) {
  ASSERT_TRUE(ToRun());
  Tick(500);
  device_->spoil = [](DeviceSample* sample) { sample->arms[0].arm_age = 0.008; };
  Tick(2);
  EXPECT_EQ(emulator_->state(), RunState::kStopping);
  device_->spoil = [](DeviceSample* sample) { sample->arms[0].arm_age = 0.030; };
  ASSERT_TRUE(Await(RunState::kUnpowered));
  EXPECT_EQ(record().cause, StopCause::kStale);
  EXPECT_NEAR(record().cause_value, 0.008, 1e-12);  // the first cause is what a person hears first
  EXPECT_EQ(record().harder.cause, StopCause::kStale);
  EXPECT_EQ(record().harder.hand, 0);
  EXPECT_EQ(record().harder.quantity, Quantity::kArmAge);
  EXPECT_NEAR(record().harder.value, 0.030, 1e-12);
  device_->spoil = nullptr;
  holds_ = false;
  Tick(1000);
  Ask(RunEvent::kReset);
  Tick(2);
  ASSERT_EQ(emulator_->state(), RunState::kSelfTest);
  EXPECT_EQ(record().harder.cause, StopCause::kNone);
}

// An arm that was told to rest and moves on must not be held, and is told of.
TEST_F(RealArms, AnArmThatMovesOnLosesItsPower) {
  ASSERT_TRUE(ToRun());
  Tick(500);
  double moved = 0;
  device_->spoil = [&moved](DeviceSample* sample) {
    sample->arms[1].q[0] += moved += 0.05 * 0.001;
    sample->arms[1].v[0] += 0.05;
  };
  Ask(RunEvent::kStopRequested);
  ASSERT_TRUE(Await(RunState::kUnpowered));
  Tick();
  EXPECT_EQ(record().cause, StopCause::kOperator);
  EXPECT_EQ(record().harder.cause, StopCause::kDevice);
  EXPECT_EQ(record().harder.hand, 1);
  EXPECT_EQ(record().harder.quantity, Quantity::kSpeed);
  EXPECT_EQ(record().harder.limit, kStandstillSpeed);
  const auto& V = record().hands[1].real.twist;
  EXPECT_NEAR(record().harder.value, std::hypot(V[0], V[1], V[2]), 1e-3);
}

// A person who asks for it makes the end of a stop harder, too.
TEST_F(RealArms, APersonMayTakeThePowerOffAtTheEndOfAStop) {
  ASSERT_TRUE(ToRun());
  Tick(200);
  device_->spoil = [](DeviceSample* sample) { sample->arms[0].arm_age = 0.008; };
  Tick(2);
  ASSERT_EQ(emulator_->state(), RunState::kStopping);
  EXPECT_EQ(record().harder.cause, StopCause::kNone);
  Ask(RunEvent::kStopAndPowerOff);
  ASSERT_TRUE(Await(RunState::kUnpowered));
  EXPECT_EQ(record().cause, StopCause::kStale);
  EXPECT_EQ(record().harder.cause, StopCause::kOperator);
}

TEST_F(RealArms, AJumpOfAJointEndsWithoutPower) {
  ASSERT_TRUE(ToRun());
  Tick(300);
  device_->spoil = [](DeviceSample* sample) { sample->arms[1].q[3] += 0.1; };
  Tick(2);
  EXPECT_EQ(record().cause, StopCause::kDevice);
  EXPECT_TRUE(Await(RunState::kUnpowered));
}

TEST_F(RealArms, DeadlinesMissedHereAndThereStopToo) {
  ASSERT_TRUE(ToRun());
  int ticks = 0;
  for (; ticks < 5000 && emulator_->state() == RunState::kRun; ++ticks)
    if (holds_ && ticks % 40 == 0)
      emulator_->Tick(0, 1);  // 25 a second
    else
      Tick();
  EXPECT_EQ(record().cause, StopCause::kDeadline);
  EXPECT_LT(ticks, 1500);
}

// A run that ended by itself holds without a cause. What must not be held is a cause then, too;
// what could be held is left to the reset.
TEST_F(RealArms, AfterARunThatEndedWellOnlyWhatMustNotBeHeldCutsThePower) {
  ASSERT_TRUE(ToRun());
  Tick(300);
  emulator_->RequestEnd();
  ASSERT_TRUE(Await(RunState::kHeld));
  ASSERT_EQ(record().cause, StopCause::kNone);
  device_->spoil = [](DeviceSample* sample) { sample->arms[0].sensor_age = 0.008; };
  Tick(100);
  EXPECT_EQ(emulator_->state(), RunState::kHeld);
  EXPECT_EQ(record().cause, StopCause::kNone);
  device_->spoil = [](DeviceSample* sample) { sample->arms[0].arm_age = 0.030; };
  Tick(2);
  EXPECT_EQ(emulator_->state(), RunState::kUnpowered);
  EXPECT_EQ(record().cause, StopCause::kStale);
  EXPECT_EQ(record().cause_value, 0.030);
}

TEST_F(RealArms, AResetAfterPowerOffWaitsForCauseAndHandsToo) {
  ASSERT_TRUE(ToRun());
  Tick(200);
  device_->spoil = [](DeviceSample* sample) { sample->arms[0].arm_age = 0.030; };
  ASSERT_TRUE(Await(RunState::kUnpowered));
  Tick(1000);
  Ask(RunEvent::kReset);
  EXPECT_EQ(Why(), Refusal::kCauseRemains);
  EXPECT_EQ(emulator_->state(), RunState::kUnpowered);
  device_->spoil = [](DeviceSample* sample) { sample->arms[1].F_S_raw[0] += 12; };
  Tick(1000);
  Ask(RunEvent::kReset);
  EXPECT_EQ(Why(), Refusal::kHandLoaded);
  EXPECT_EQ(emulator_->state(), RunState::kUnpowered);
  device_->spoil = nullptr;
  Tick(100);
  Ask(RunEvent::kReset);
  EXPECT_EQ(emulator_->state(), RunState::kSelfTest);
}

// Before the first self-test has passed nobody knows a sensor's bias, so that a large one neither
// stops nor counts as a hand.
TEST_F(RealArms, AfterAFailedSelfTestTheBiasIsNoHand) {
  int tick = 0;
  device_->spoil = [&tick](DeviceSample* sample) {
    sample->arms[0].F_S_raw[1] += 40 + (tick++ < 400 ? tick % 7 : 0);
  };
  ASSERT_TRUE(Await(RunState::kUnpowered));
  EXPECT_EQ(record().cause, StopCause::kSensor);
  Tick(1000);
  Ask(RunEvent::kReset);
  ASSERT_EQ(emulator_->state(), RunState::kSelfTest);
  EXPECT_TRUE(Await(RunState::kIdle));
}

// A foot switch instead of the key; over a robot's wire: tests/devices/enabling_test.cpp.
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

TEST_F(FootSwitch, SilentForATenthOfASecondItIsLetGo) {
  ASSERT_TRUE(Run());
  Tick(500);
  Put(Enabling::kSilent, 75);
  EXPECT_EQ(emulator_->state(), RunState::kRun);
  Tick(30);
  EXPECT_EQ(emulator_->state(), RunState::kStopping);
  EXPECT_EQ(record().cause, StopCause::kEnabling);
}

TEST_F(FootSwitch, ThatWasNeverLetGoCountsForNothing) {
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

TEST_F(FootSwitch, StillPressedAfterAStopCountsForNothing) {
  ASSERT_TRUE(Run());
  Tick(500);
  Ask(RunEvent::kStopRequested);
  ASSERT_TRUE(Await(RunState::kHeld));
  Tick(1000);
  Ask(RunEvent::kRecoverRequested);
  EXPECT_EQ(Why(), Refusal::kNotEnabled);
  EXPECT_EQ(emulator_->state(), RunState::kHeld);
}

// What the self-test takes off is never felt: neither while it averages nor when it is over, nor
// where a sensor has another bias after its power was off.
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
  EXPECT_LT(felt, 0.5);  // the sensor's noise
  Ask(RunEvent::kStopAndPowerOff);
  ASSERT_TRUE(Await(RunState::kUnpowered));
  bias += 3;
  Tick(1000);
  Ask(RunEvent::kReset);
  ASSERT_EQ(emulator_->state(), RunState::kSelfTest);
  ASSERT_TRUE(feel(RunState::kIdle));
  EXPECT_LT(felt, 0.5);
}

// A driver that leads its arm to rest by a way of its own: where nothing may move, it has come
// there.
class LedToRest : public RealArms {
 protected:
  LedToRest() {
    device_->spoil = [this](DeviceSample* sample) { sample->arms[hand_].in_motion = in_motion_; };
  }
  bool ToldToRest() const {
    for (const HandRecord& hand : record().hands)
      for (int i = 0; i < hand.arm_dof; ++i)
        if (hand.command[static_cast<std::size_t>(i)] != 0) return false;
    return true;
  }
  std::size_t hand_ = 0;
  bool in_motion_ = true;
};

TEST_F(LedToRest, NothingIsArmedBefore) {
  for (hand_ = 0; hand_ < kHands; ++hand_) {
    SCOPED_TRACE(hand_);
    in_motion_ = true;
    ASSERT_TRUE(Await(RunState::kIdle));
    holds_ = true;
    Tick(40);
    Ask(RunEvent::kAlignRequested);
    Tick(10);
    EXPECT_TRUE(hand_ == 1 || !ToldToRest());  // the second time they are aligned already
    for (int k = 0; k < 20'000 && !ToldToRest(); ++k) Tick();
    for (int k = 0; k < 500; ++k) {
      Tick();
      ASSERT_TRUE(ToldToRest());
    }
    EXPECT_EQ(emulator_->state(), RunState::kAlign);
    in_motion_ = false;
    Tick();
    EXPECT_EQ(emulator_->state(), RunState::kArmed);
    EXPECT_EQ(record().hands[hand_].arm_in_motion, 0);
    Ask(RunEvent::kStartRequested);
    Tick(100);
    EXPECT_EQ(emulator_->state(), RunState::kRun);
    EXPECT_FALSE(ToldToRest());
    in_motion_ = true;
    Ask(RunEvent::kStopRequested);
    Tick(300);
    EXPECT_EQ(record().hands[hand_].arm_in_motion, 1);
    EXPECT_EQ(emulator_->state(), RunState::kStopping);
    in_motion_ = false;
    EXPECT_TRUE(Await(RunState::kHeld, 25));
    Tick(1000);
    Ask(RunEvent::kReset);
    Tick(2);
  }
}

TEST_F(LedToRest, NoRecoveryEndsBefore) {
  ASSERT_TRUE(Await(RunState::kIdle));
  holds_ = true;
  Tick(40);
  Ask(RunEvent::kRecoverRequested);
  ASSERT_EQ(emulator_->state(), RunState::kRecovery);
  holds_ = false;
  Tick(300);
  EXPECT_TRUE(ToldToRest());
  EXPECT_EQ(emulator_->state(), RunState::kRecovery);
  in_motion_ = false;
  Tick();
  EXPECT_EQ(emulator_->state(), RunState::kIdle);
}

class BeyondALimit : public RealArms {
 protected:
  BeyondALimit() {
    // The arm reads as beyond its limit, by as much as it has not been led back yet.
    device_->spoil = [this](DeviceSample* sample) {
      JointVector& q = sample->arms[0].q;
      q[3] -= offset_;
      seen_ = q[3];
    };
  }
  double offset_ = 0, seen_ = 0;
};

TEST_F(BeyondALimit, AStartIsRefusedAndRecoveryLeadsBack) {
  ASSERT_TRUE(Await(RunState::kIdle));
  const double lower = -3.0718;  // panda_joint4
  // Slowly, or it would be a jump.
  while (seen_ > lower - 0.03) {
    offset_ += 0.001;
    Tick();
  }
  ASSERT_EQ(emulator_->state(), RunState::kIdle);
  holds_ = true;
  Tick(40);
  Ask(RunEvent::kAlignRequested);
  EXPECT_EQ(emulator_->state(), RunState::kIdle);
  EXPECT_EQ(Why(), Refusal::kBeyondJoint);
  Ask(RunEvent::kRecoverRequested);
  ASSERT_EQ(emulator_->state(), RunState::kRecovery);
  for (int i = 0; i < 3000; ++i) {
    Tick();
    EXPECT_GE(record().hands[0].command[3], 0);
    for (const int other : {0, 1, 2, 4, 5, 6}) EXPECT_EQ(record().hands[0].command[other], 0);
  }
  EXPECT_GT(seen_, lower);
  holds_ = false;
  EXPECT_TRUE(Await(RunState::kIdle, 500));
}

TEST(RealTimeArms, NobodyEnablesFromAfar) {
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
  RunInput align;
  align.kind = InputKind::kAlign;
  for (int i = 0; i < 100; ++i) {
    mailbox->inputs.Push(key);
    mailbox->inputs.Push(align);
  }
  std::atomic<bool> quit{false}, over{false}, moved{false};
  // It stays idle, or is stopped if the computer makes it miss its ticks; but it never aligns.
  std::thread ends([&] {
    TickRecord record;
    RingReader<TickRecord, kRecordRing> reader(*ring);
    for (int idle = 0; idle < 200 && !over;) {
      if (!reader.Next(&record)) {
        std::this_thread::yield();
        continue;
      }
      idle += record.state == RunState::kIdle;
      moved = moved || FollowsTask(record.state) || record.refused != 0;
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
}

}  // namespace
}  // namespace predictor
