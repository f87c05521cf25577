// Tests the final state after a stop of real arms, and the conditions for a reset.
#include "core/motion.h"
#include "real_arms.h"

namespace predictor {
namespace {

TEST_F(RealArms, AResetWaitsUntilBothArmsStand) {
  ASSERT_TRUE(ToRun());
  Ask(RunEvent::kStopAndPowerOff);
  ASSERT_TRUE(Await(RunState::kUnpowered));
  Tick(600);
  for (const int joint : {0, 6}) {  // the handle translates or rotates
    device_->spoil = [joint](DeviceSample* sample) { sample->arms[1].v[joint] += 0.2; };
    Tick(200);  // the force of the push has ended
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

// If a fault makes it doubtful that the arm can hold its position, the stop ends in power-off.
// Power-off must also end the stop if such a fault occurs during a stop with a milder cause.
TEST_F(RealArms, TheMostSevereWins) {
  ASSERT_TRUE(ToRun());
  Tick(500);
  device_->spoil = [](DeviceSample* sample) { sample->arms[0].arm_age = 0.008; };
  Tick(2);
  EXPECT_EQ(emulator_->state(), RunState::kStopping);
  device_->spoil = [](DeviceSample* sample) { sample->arms[0].arm_age = 0.030; };
  ASSERT_TRUE(Await(RunState::kUnpowered));
  EXPECT_EQ(record().cause, StopCause::kStale);
  EXPECT_NEAR(record().cause_value, 0.008, 1e-12);  // the first cause is reported first
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

// The reported reason for the power-off must be the fault that required it (a silent arm), not an
// earlier one (a hand that still pushes).
TEST_F(RealArms, TheReasonForPowerOffIsNotAnEarlierFault) {
  ASSERT_TRUE(ToRun());
  Tick(500);
  device_->spoil = [](DeviceSample* sample) { sample->arms[1].F_S_raw[2] += 60; };
  ASSERT_TRUE(Await(RunState::kHeld));
  EXPECT_EQ(record().cause, StopCause::kForce);
  device_->spoil = [](DeviceSample* sample) {
    sample->arms[1].F_S_raw[2] += 60;
    sample->arms[0].arm_age = 0.030;
  };
  ASSERT_TRUE(Await(RunState::kUnpowered, 5));
  Tick();
  EXPECT_EQ(record().cause, StopCause::kForce);
  EXPECT_EQ(record().harder.cause, StopCause::kStale);
  EXPECT_EQ(record().harder.hand, 0);
  EXPECT_EQ(record().harder.quantity, Quantity::kArmAge);
  EXPECT_EQ(record().harder.value, 0.030);
  // A later fault that would also remove the power must not replace the reason.
  device_->spoil = [](DeviceSample* sample) { sample->arms[1].sensor_saturated = true; };
  Tick(5);
  EXPECT_EQ(record().harder.cause, StopCause::kStale);
  EXPECT_EQ(record().harder.hand, 0);
}

// An arm that still moves after a command to rest must lose its power, and the program must report
// the fault.
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
  EXPECT_EQ(record().harder.power_off, 1);
  EXPECT_NEAR(record().harder.limit, 0.0025, 1e-12);
  const auto& V = record().hands[1].real.twist;
  EXPECT_NEAR(record().harder.value, HandleSpeed(Eigen::Map<const Twist>(V.data())), 1e-3);
}

// If the run had ended normally before the fault, the fault becomes the cause of the stop.
TEST_F(RealArms, AnArmThatMovesOnAfterARunsEndIsACause) {
  for (const std::size_t arm : {0, 1}) {
    ASSERT_TRUE(ToRun());
    Tick(500);
    double turned = 0;
    device_->spoil = [&turned, arm](DeviceSample* sample) {
      sample->arms[arm].q[6] += turned += 0.05 * 0.001;  // about the handle's own axis
    };
    emulator_->RequestEnd();
    ASSERT_TRUE(Await(RunState::kUnpowered));
    Tick();
    EXPECT_EQ(record().cause, StopCause::kDevice);
    EXPECT_EQ(record().cause_hand, static_cast<int>(arm));
    EXPECT_GT(record().cause_value, record().cause_limit);
    EXPECT_EQ(record().harder.cause, StopCause::kNone);
    device_->spoil = nullptr;
    holds_ = false;
    Tick(1000);
    Ask(RunEvent::kReset);
  }
}

// A request for power-off must also change the end of a stop that has another cause.
TEST_F(RealArms, ARequestForPowerOffMakesTheEndOfAStopHarder) {
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

// The virtual world must be paused from the tick of the request on.
TEST_F(RealArms, AWrenchInDoubtNeverEntersThePhysics) {
  ASSERT_TRUE(ToRun());
  for (int k = 0; k < 3000 && std::abs(record().object.twist[2]) < 0.01; ++k) Tick();
  ASSERT_EQ(emulator_->state(), RunState::kRun);
  device_->spoil = [](DeviceSample* sample) { sample->arms[1].F_S_raw[2] = std::nan(""); };
  Tick();
  const MotionRecord object = record().object;
  EXPECT_GT(std::abs(object.twist[2]), 0.009);
  Tick();
  EXPECT_EQ(record().cause, StopCause::kSensor);
  EXPECT_EQ(record().object.pose.p, object.pose.p);
  EXPECT_EQ(record().object.twist, object.twist);
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
      emulator_->Tick(0, 1);  // 25 times per second
    else
      Tick();
  EXPECT_EQ(record().cause, StopCause::kDeadline);
  EXPECT_LT(ticks, 1500);
}

// A run that ended normally holds the arms without a cause. A fault after which the arms must not
// be held then becomes the cause. All other faults only prevent the reset.
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

}  // namespace
}  // namespace predictor
