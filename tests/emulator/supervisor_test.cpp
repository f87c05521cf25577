// Tests the decisions of a tick without models, physics and rendering. The tests write the samples
// of two artificial arms with two joints each.
#include "emulator/supervisor.h"

#include <gtest/gtest.h>

#include <optional>

#include "core/random.h"

namespace predictor {
namespace {

Scenario OneArm(bool real) {
  Scenario scenario;
  scenario.left_handle.emplace();
  scenario.device.left.emplace();
  if (real) scenario.device.type = "real";
  return scenario;
}

ArmsSpec TwoJoints() {
  ArmsSpec arms;
  arms.bounds[0] = {JointVector::Constant(2, -2), JointVector::Constant(2, 2),
                    JointVector::Constant(2, 1), JointVector::Constant(2, 10)};
  return arms;
}

// Performs ticks as Emulator::Tick does. All data is valid unless a test changes it.
class SupervisorTest : public testing::Test {
 protected:
  explicit SupervisorTest(bool real = false)
      : supervisor_(OneArm(real), TwoJoints()), random_(1, "sensor") {
    data_.after = &world_;
    ArmSample& arm = data_.sample.arms[0];
    arm.present = true;
    arm.q = arm.v = data_.sent.v[0] = data_.command.v[0] = JointVector::Zero(2);
    arm.arm_age = arm.sensor_age = 0.001;
    data_.rendered.v[0] = JointVector::Constant(2, 0.1);
    data_.wrench[0].present = true;
  }

  void Tick(int ticks = 1) {
    for (; ticks > 0; --ticks) OneTick();
  }
  void OneTick() {
    if (holds_key_) Enable(1);
    data_.requests = supervisor_.TakeRequests();
    reset_ = supervisor_.HandleRequests(data_, beyond_);
    ArmSample& arm = data_.sample.arms[0];
    ++arm.arm_sequence;
    ++arm.sensor_sequence;
    arm.F_S_raw[0] = 0.05 * random_.Normal();
    plan_ = supervisor_.Plan(data_.sample);
    supervisor_.Check(plan_, data_);
    order_ = supervisor_.Order(plan_, data_);
    JointVector& v = data_.command.v[0];
    if (order_.motion == Motion::kBrake)
      supervisor_.Brake(order_, {}, &data_.command.v);
    else if (order_.motion == Motion::kFollow && !order_.holds)
      v = data_.rendered.v[0];
    else
      v.setZero();
    data_.sent.v = data_.command.v;
    data_.sent.handle_speed = v.norm();
    supervisor_.ObserveStop(data_);
    supervisor_.EndTick(plan_);
    std::optional<Status> tare;
    if (supervisor_.SelfTestEnds()) tare = tare_;
    tares_ = supervisor_.Advance(data_, beyond_, tare);
    supervisor_.FollowEnablingDevice(foot_);
  }
  void Enable(double held) {
    RunInput key;
    key.kind = InputKind::kEnable;
    key.value = held;
    supervisor_.Submit(key);
  }
  bool Await(RunState state, int patience = 5000) {
    for (; patience > 0 && supervisor_.state() != state; --patience) Tick();
    return supervisor_.state() == state;
  }
  Refusal Ask(RunEvent event) {
    supervisor_.Request(event);
    Tick();
    return supervisor_.refused().why;
  }
  bool ToRun() {
    if (!Await(RunState::kIdle)) return false;
    if (Ask(RunEvent::kAlignRequested) != Refusal::kNone || !Await(RunState::kArmed)) return false;
    return Ask(RunEvent::kStartRequested) == Refusal::kNone && Await(RunState::kRun, 1);
  }
  void Push(double force) { data_.wrench[0].F_H_W[0] = force; }
  // After this fault, the arm may be held with power on.
  void TooMuchForce() { Push(100); }

  WorldState world_;
  TickData data_;
  Supervisor supervisor_;
  RandomStream random_;
  TickPlan plan_;
  MotionOrder order_;
  Beyond beyond_ = Beyond::kNothing;
  Status tare_ = Status::Ok();
  Enabling foot_ = Enabling::kNone;
  bool holds_key_ = false, reset_ = false, tares_ = false;
};

class RealSupervisor : public SupervisorTest {
 protected:
  RealSupervisor() : SupervisorTest(true) { holds_key_ = true; }
};

TEST_F(SupervisorTest, TaresFromTheEndOfInitToIdle) {
  Tick();
  EXPECT_TRUE(tares_);
  EXPECT_EQ(supervisor_.state(), RunState::kSelfTest);
  Tick();
  EXPECT_FALSE(tares_);
  EXPECT_FALSE(plan_.wrench_known);
  EXPECT_TRUE(Await(RunState::kIdle, 400));
  Tick();
  EXPECT_TRUE(plan_.wrench_known);
}

TEST_F(SupervisorTest, ASensorThatIsTouchedWhileTaringEndsWithoutPower) {
  tare_ = {StopCause::kSensor, 0, 2, 1};
  EXPECT_TRUE(Await(RunState::kUnpowered));
  EXPECT_EQ(supervisor_.fault().cause, StopCause::kSensor);
}

TEST_F(SupervisorTest, TimePassesInRunOnly) {
  ASSERT_TRUE(Await(RunState::kIdle));
  EXPECT_EQ(supervisor_.run_time(), 0);
  ASSERT_TRUE(ToRun());
  const double begun = supervisor_.run_time();
  Tick(10);
  EXPECT_TRUE(plan_.time_passes);
  EXPECT_NEAR(supervisor_.run_time() - begun, 0.010, 1e-12);
  Ask(RunEvent::kStopRequested);
  const double stopped = supervisor_.run_time();
  Tick(10);
  EXPECT_FALSE(plan_.time_passes);
  EXPECT_EQ(supervisor_.run_time(), stopped);
}

TEST_F(SupervisorTest, AFaultBrakesInItsOwnTick) {
  ASSERT_TRUE(ToRun());
  Tick();
  EXPECT_EQ(order_.motion, Motion::kFollow);
  TooMuchForce();
  Tick();
  EXPECT_EQ(order_.motion, Motion::kBrake);
  EXPECT_EQ(supervisor_.state(), RunState::kStopping);
  EXPECT_EQ(supervisor_.fault().cause, StopCause::kForce);
  EXPECT_TRUE(Await(RunState::kHeld, 600));
  EXPECT_EQ(data_.command.v[0].norm(), 0);
}

TEST_F(SupervisorTest, ALaterFaultMayOnlyRaiseTheLevel) {
  ASSERT_TRUE(ToRun());
  TooMuchForce();
  ASSERT_TRUE(Await(RunState::kHeld, 600));
  EXPECT_TRUE(supervisor_.power_off_cause().ok());
  data_.sample.arms[0].sensor_saturated = true;
  Tick();
  EXPECT_EQ(supervisor_.state(), RunState::kUnpowered);
  EXPECT_EQ(supervisor_.fault().cause, StopCause::kForce);
  EXPECT_EQ(supervisor_.power_off_cause().cause, StopCause::kSensor);
}

TEST_F(SupervisorTest, AStopDropsOtherRequestsInItsTick) {
  ASSERT_TRUE(Await(RunState::kIdle));
  supervisor_.Request(RunEvent::kAlignRequested);
  Ask(RunEvent::kStopRequested);
  EXPECT_EQ(supervisor_.state(), RunState::kStopping);
  EXPECT_EQ(supervisor_.fault().cause, StopCause::kOperator);
}

TEST_F(SupervisorTest, AnEndIsAStopWithoutAFault) {
  ASSERT_TRUE(ToRun());
  supervisor_.RequestEnd();
  EXPECT_TRUE(Await(RunState::kHeld, 600));
  EXPECT_TRUE(supervisor_.fault().ok());
}

TEST_F(SupervisorTest, AResetNeedsFreeHandsStandingArmsAndAnAbsentFault) {
  ASSERT_TRUE(ToRun());
  TooMuchForce();
  ASSERT_TRUE(Await(RunState::kHeld, 600));
  EXPECT_EQ(Ask(RunEvent::kReset), Refusal::kHandLoaded);
  Push(0);
  data_.real[0].V_W[0] = 0.02;
  EXPECT_EQ(Ask(RunEvent::kReset), Refusal::kMoves);
  data_.real[0].V_W[0] = 0;
  EXPECT_EQ(Ask(RunEvent::kReset), Refusal::kCauseRemains);
  EXPECT_FALSE(reset_);
  Tick(500);
  EXPECT_EQ(Ask(RunEvent::kReset), Refusal::kNone);
  EXPECT_TRUE(reset_);
  EXPECT_EQ(supervisor_.state(), RunState::kIdle);
  EXPECT_TRUE(supervisor_.fault().ok());
  EXPECT_EQ(supervisor_.run_time(), 0);
}

TEST_F(SupervisorTest, ArmsBeyondTheirLimitsDoNotStart) {
  ASSERT_TRUE(Await(RunState::kIdle));
  beyond_ = Beyond::kJoint;
  EXPECT_EQ(Ask(RunEvent::kAlignRequested), Refusal::kBeyondJoint);
  beyond_ = Beyond::kLinks;
  EXPECT_EQ(Ask(RunEvent::kAlignRequested), Refusal::kBeyondLinks);
  EXPECT_EQ(supervisor_.state(), RunState::kIdle);
}

TEST_F(SupervisorTest, RecoveryEndsOnceNothingIsBeyond) {
  ASSERT_TRUE(Await(RunState::kIdle));
  beyond_ = Beyond::kJoint;
  Ask(RunEvent::kRecoverRequested);
  Tick(10);
  EXPECT_EQ(supervisor_.state(), RunState::kRecovery);
  EXPECT_EQ(order_.motion, Motion::kRecover);
  EXPECT_FALSE(order_.holds);
  beyond_ = Beyond::kNothing;
  EXPECT_TRUE(Await(RunState::kIdle, 1));
}

TEST_F(SupervisorTest, NothingMovesUntilAllArmsHaveBegunTo) {
  ASSERT_TRUE(ToRun());
  data_.sample.arms[0].waits = true;
  Tick();
  EXPECT_TRUE(order_.holds);
  EXPECT_FALSE(plan_.time_passes);
  data_.sample.arms[0].waits = false;
  Tick();
  EXPECT_FALSE(order_.holds);
  EXPECT_TRUE(plan_.time_passes);
}

TEST_F(SupervisorTest, HandlesArmOnceInPlaceAndAtRest) {
  ASSERT_TRUE(Await(RunState::kIdle));
  world_.handle[0].X_W.p[0] = 0.01;
  Ask(RunEvent::kAlignRequested);
  Tick(10);
  EXPECT_EQ(supervisor_.state(), RunState::kAlign);
  data_.real[0].X_W.p[0] = 0.01;
  data_.sent.may_rest_next = false;
  Tick(10);
  EXPECT_EQ(supervisor_.state(), RunState::kAlign);
  data_.sent.may_rest_next = true;
  data_.sample.arms[0].in_motion = true;
  Tick(10);
  EXPECT_EQ(supervisor_.state(), RunState::kAlign);
  EXPECT_TRUE(order_.holds);
  data_.sample.arms[0].in_motion = false;
  EXPECT_TRUE(Await(RunState::kArmed, 1));
}

TEST_F(SupervisorTest, AMovedParameterReachesControllerAndMonitor) {
  ASSERT_TRUE(ToRun());
  RunInput input;
  input.kind = InputKind::kParameter;
  input.parameter = Parameter::kForceThreshold;
  input.value = 10;
  ASSERT_TRUE(supervisor_.Submit(input));
  Tick();
  EXPECT_TRUE(plan_.tuning.has_value());
  Tick(1100);
  EXPECT_FALSE(plan_.tuning.has_value());
  Push(9);
  Tick();
  EXPECT_EQ(supervisor_.state(), RunState::kRun);
  Push(11);
  Tick();
  EXPECT_EQ(supervisor_.fault().cause, StopCause::kForce);
  EXPECT_EQ(supervisor_.fault().limit, 10);
}

TEST_F(RealSupervisor, RunsOnlyWhileThePersonEnables) {
  ASSERT_TRUE(ToRun());
  Tick(200);
  EXPECT_EQ(supervisor_.state(), RunState::kRun);
  holds_key_ = false;
  Tick(99);
  EXPECT_EQ(supervisor_.state(), RunState::kRun);
  Tick(3);
  EXPECT_EQ(supervisor_.state(), RunState::kStopping);
  EXPECT_EQ(supervisor_.fault().cause, StopCause::kEnabling);
}

TEST_F(RealSupervisor, WithoutEnablingNothingStarts) {
  holds_key_ = false;
  ASSERT_TRUE(Await(RunState::kIdle));
  EXPECT_EQ(Ask(RunEvent::kAlignRequested), Refusal::kNotEnabled);
  EXPECT_EQ(Ask(RunEvent::kRecoverRequested), Refusal::kNotEnabled);
}

TEST_F(RealSupervisor, APageMayStopAndNotStart) {
  ASSERT_TRUE(Await(RunState::kIdle));
  holds_key_ = false;
  for (const InputKind kind : {InputKind::kAlign, InputKind::kStart, InputKind::kReset}) {
    RunInput input;
    input.kind = kind;
    EXPECT_FALSE(supervisor_.Submit(input)) << static_cast<int>(kind);
  }
  RunInput stop;
  stop.kind = InputKind::kStop;
  EXPECT_TRUE(supervisor_.Submit(stop));
  Tick();
  EXPECT_EQ(supervisor_.state(), RunState::kStopping);
}

TEST_F(RealSupervisor, StartsOnlyWithHandsOffAndHandlesInPlace) {
  ASSERT_TRUE(Await(RunState::kIdle));
  Push(6);
  EXPECT_EQ(Ask(RunEvent::kAlignRequested), Refusal::kNotFree);
  Push(0);
  EXPECT_EQ(Ask(RunEvent::kAlignRequested), Refusal::kNone);
  ASSERT_TRUE(Await(RunState::kArmed));
  data_.real[0].X_W.p[0] = 0.01;
  EXPECT_EQ(Ask(RunEvent::kStartRequested), Refusal::kNotAligned);
  EXPECT_EQ(supervisor_.state(), RunState::kArmed);
}

TEST_F(RealSupervisor, CutsThePowerOfAnArmThatMovesOnAfterItsStop) {
  ASSERT_TRUE(ToRun());
  Ask(RunEvent::kStopRequested);
  int ticks = 0;
  for (; supervisor_.state() == RunState::kStopping && ticks < 2000; ++ticks) {
    data_.real[0].X_W.p[0] += 1e-4;  // 0.1 m/s
    data_.real[0].V_W[0] = 0.1;
    Tick();
  }
  EXPECT_LT(ticks, 2000);
  EXPECT_EQ(supervisor_.state(), RunState::kUnpowered);
  EXPECT_EQ(supervisor_.power_off_cause().cause, StopCause::kDevice);
  EXPECT_EQ(supervisor_.power_off_cause().value, 0.1);
}

TEST_F(RealSupervisor, ALateStopMakesUpForTheTicksThatTheArmsMovedOn) {
  ASSERT_TRUE(ToRun());
  Ask(RunEvent::kStopRequested);
  EXPECT_EQ(order_.ticks, 1);
  data_.missed = 2;
  Tick();
  EXPECT_EQ(order_.ticks, 3);
}

TEST_F(SupervisorTest, ASimulatedRigWaitsForALateTick) {
  ASSERT_TRUE(ToRun());
  data_.missed = 5;
  Tick(10);
  EXPECT_EQ(supervisor_.state(), RunState::kRun);
  Ask(RunEvent::kStopRequested);
  EXPECT_EQ(order_.ticks, 1);
}

// A person may have jammed or taped down the device.
TEST_F(RealSupervisor, AnEnablingDeviceCountsOnceItHasBeenReleased) {
  holds_key_ = false;
  foot_ = Enabling::kPressed;
  ASSERT_TRUE(Await(RunState::kIdle));
  EXPECT_EQ(Ask(RunEvent::kAlignRequested), Refusal::kNotEnabled);
  foot_ = Enabling::kReleased;
  Tick(2);
  foot_ = Enabling::kPressed;
  Tick(2);
  EXPECT_EQ(Ask(RunEvent::kAlignRequested), Refusal::kNone);
  EXPECT_EQ(supervisor_.state(), RunState::kArmed);  // the handles are already in place
}

}  // namespace
}  // namespace predictor
