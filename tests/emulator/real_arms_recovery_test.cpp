// Tests RECOVERY of real arms after a stop and from beyond a limit, including drivers that choose
// the path on which their arm comes to rest.
#include "handle_speeds.h"
#include "real_arms.h"

namespace predictor {
namespace {

// The handle moves slowly to where the hand pushes it and stops when the key is released. A reset
// is still required afterwards.
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
  EXPECT_LT(fastest, 0.055);  // 50 mm/s plus measurement error
  EXPECT_GT(std::hypot(hand.real.pose.p[0] - before.p[0], hand.real.pose.p[1] - before.p[1],
                       hand.real.pose.p[2] - before.p[2]),
            0.01);
  holds_ = false;
  ASSERT_TRUE(Await(RunState::kHeld, 1000));
  EXPECT_EQ(record().cause, StopCause::kOperator);
}

// The hand pulls in changing directions. The handle must follow without exceeding the speed limit,
// and all joints must come to rest together when the key is released.
TEST_F(RealArms, RecoveryIsSlowForAnyHand) {
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
  constexpr double kCap = 0.05, kByPosture = 1.03;
  double fastest = 0;
  for (int i = 0; i < 3000; ++i) {
    Tick();
    ASSERT_EQ(emulator_->state(), RunState::kRecovery) << Name(record().cause);
    const Speeds now = handles.Commanded(record());
    fastest = std::max(fastest, now.translation);
    EXPECT_LE(now.translation, kByPosture * kCap);
    EXPECT_LE(0.2 * now.rotation, kByPosture * kCap);
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
  // After the key is released, one common factor must scale all joints.
  ASSERT_GT(sent.size(), 10U);
  EXPECT_EQ(sent.back().norm(), 0);
  for (std::size_t k = sent.size() - 6; k < sent.size(); ++k) {
    const double factor = sent[k].norm() / sent[k - 1].norm();
    EXPECT_LT(factor, 1);
    EXPECT_LT((sent[k] - factor * sent[k - 1]).norm(), 1e-12);
  }
}

// RECOVERY accepts the load that is present when it begins. An additional load stops RECOVERY.
// After that, a person may request RECOVERY again.
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

// RECOVERY may outlast the duration of the run, because it frees a hand. A request to end the
// program also ends RECOVERY.
TEST_F(RealArms, RecoveryAfterARunsEndContinuesUntilTheProgramMustEnd) {
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
    Ask(RunEvent::kRecoverRequested);  // so that the next stop has an effect
    Tick(100);
    ASSERT_EQ(emulator_->state(), RunState::kRecovery);
  }
}

TEST_F(RealArms, RecoveryDoesNotLeadToRun) {
  ASSERT_TRUE(ToRun());
  Tick(200);
  Ask(RunEvent::kStopRequested);
  ASSERT_TRUE(Await(RunState::kHeld));
  Ask(RunEvent::kStartRequested);
  Ask(RunEvent::kAlignRequested);
  EXPECT_EQ(emulator_->state(), RunState::kHeld);
}

TEST_F(RealArms, AStopInRecoveryStops) {
  ASSERT_TRUE(ToEnabled());
  device_->spoil = [](DeviceSample* sample) { sample->arms[0].F_S_raw[2] += 20; };
  Ask(RunEvent::kRecoverRequested);
  Tick(300);
  ASSERT_EQ(emulator_->state(), RunState::kRecovery);
  device_->spoil = [](DeviceSample* sample) { sample->arms[0].sensor_saturated = true; };
  Tick(2);
  EXPECT_EQ(emulator_->state(), RunState::kStopping);
  EXPECT_TRUE(Await(RunState::kUnpowered));
}

// A driver that chooses the path on which its arm comes to rest. A state without motion must not
// begin before the arm rests.
class LedToRest : public RealArms {
 protected:
  LedToRest() {
    device_->spoil = [this](DeviceSample* sample) { sample->arms[hand_].in_motion = in_motion_; };
  }
  bool CommandedToRest() const {
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
    ASSERT_TRUE(ToEnabled());
    Ask(RunEvent::kAlignRequested);
    Tick(10);
    EXPECT_TRUE(hand_ == 1 || !CommandedToRest());  // already aligned the second time
    for (int k = 0; k < 20'000 && !CommandedToRest(); ++k) Tick();
    for (int k = 0; k < 500; ++k) {
      Tick();
      ASSERT_TRUE(CommandedToRest());
    }
    EXPECT_EQ(emulator_->state(), RunState::kAlign);
    in_motion_ = false;
    Tick();
    EXPECT_EQ(emulator_->state(), RunState::kArmed);
    EXPECT_EQ(record().hands[hand_].arm_in_motion, 0);
    Ask(RunEvent::kStartRequested);
    Tick(100);
    EXPECT_EQ(emulator_->state(), RunState::kRun);
    EXPECT_FALSE(CommandedToRest());
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

// After the handles have reached their goal, they may drift within the tolerance without a new
// motion.
TEST_F(LedToRest, MayDeviateSlightlyMeanwhile) {
  ASSERT_TRUE(ToEnabled());
  Ask(RunEvent::kAlignRequested);
  Tick(10);
  for (int k = 0; k < 20'000 && !CommandedToRest(); ++k) Tick();
  double strayed = 0;
  device_->spoil = [this, &strayed](DeviceSample* sample) {
    sample->arms[0].in_motion = in_motion_;
    sample->arms[0].q[1] += strayed;  // 0.1 to 2 mm at the handle
  };
  for (int k = 0; k < 500; ++k) {
    strayed = std::min(1e-3, strayed + 1e-5);
    Tick();
    ASSERT_TRUE(CommandedToRest()) << k;
  }
  EXPECT_EQ(emulator_->state(), RunState::kAlign);
  in_motion_ = false;
  Tick();
  EXPECT_EQ(emulator_->state(), RunState::kArmed);
}

TEST_F(LedToRest, AnArmThatNeverRestsLosesItsPowerAndIsNamed) {
  hand_ = 1;
  in_motion_ = false;
  ASSERT_TRUE(ToRun());
  Tick(100);
  in_motion_ = true;
  Ask(RunEvent::kStopRequested);
  ASSERT_TRUE(Await(RunState::kUnpowered));
  Tick();
  EXPECT_EQ(record().cause, StopCause::kOperator);
  EXPECT_EQ(record().harder.cause, StopCause::kDevice);
  EXPECT_EQ(record().harder.hand, 1);
  EXPECT_EQ(record().harder.quantity, Quantity::kTime);
  EXPECT_GT(record().harder.value, record().harder.limit);
}

TEST_F(LedToRest, NoRecoveryEndsBefore) {
  ASSERT_TRUE(ToEnabled());
  Ask(RunEvent::kRecoverRequested);
  ASSERT_EQ(emulator_->state(), RunState::kRecovery);
  holds_ = false;
  Tick(300);
  EXPECT_TRUE(CommandedToRest());
  EXPECT_EQ(emulator_->state(), RunState::kRecovery);
  in_motion_ = false;
  Tick();
  EXPECT_EQ(emulator_->state(), RunState::kIdle);
}

class BeyondALimit : public RealArms {
 protected:
  BeyondALimit() {
    // Adds an offset to the measured joint, so that the joint seems to be beyond its limit until it
    // has moved back.
    device_->spoil = [this](DeviceSample* sample) {
      JointVector& q = sample->arms[0].q;
      q[3] -= offset_;
      seen_ = q[3];
    };
  }
  double offset_ = 0, seen_ = 0;
};

TEST_F(BeyondALimit, AStartIsRefusedAndRecoveryReturnsTheJoint) {
  ASSERT_TRUE(Await(RunState::kIdle));
  const double lower = -3.0718;  // panda_joint4
  // The offset grows slowly, because a jump would count as a fault.
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

}  // namespace
}  // namespace predictor
