// Tests the inputs of people and pages during a run (parameters, hands, buttons) and their limits.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>

#include "core/choice.h"
#include "core/shared_run.h"
#include "runs.h"
#include "support/allocation_guard.h"
#include "support/constants.h"

namespace predictor {
namespace {

RunInput Of(InputKind kind) {
  RunInput input;
  input.kind = kind;
  return input;
}

RunInput Set(Parameter parameter, double value) {
  RunInput input = Of(InputKind::kParameter);
  input.parameter = parameter;
  input.value = value;
  return input;
}

RunInput Hold(int hand, const PoseRecord& X, bool grip = true) {
  RunInput input = Of(InputKind::kHand);
  input.hand = static_cast<std::uint8_t>(hand);
  input.grip = grip;
  input.p = X.p;
  input.q = X.q;
  return input;
}

// Performs ticks until `duration` [s] of run time has passed. Before each tick, it calls `before`,
// which may submit inputs.
template <class F>
void Pass(Emulator* emulator, double duration, F before) {
  const double end = emulator->run_time() + duration;
  for (long k = 0; emulator->run_time() < end - 1e-9; ++k) {
    ASSERT_LT(k, 200'000) << Name(emulator->state()) << ", " << Name(emulator->record().cause);
    if (emulator->state() == RunState::kHeld) return;
    before();
    emulator->Tick();
    AutoStart(emulator);
  }
}

TEST(Parameters, MoveInASecondAndTheObjectDoesNotJump) {
  Emulator emulator(LoadTestScenario("box_9kg"));
  Pass(&emulator, 5, [] {});
  const TickRecord start = emulator.record();
  ASSERT_TRUE(emulator.Submit(Set(Parameter::kStiffnessTranslation, 0.5)));
  double last = 1, speed = 0;
  Pass(&emulator, 1.1, [&] {
    const TickRecord& r = emulator.record();
    // The parameter moves by half its range in one second.
    EXPECT_LE(std::abs(r.parameters[0] - last), 0.5e-3 + 1e-12);
    last = r.parameters[0];
    speed = std::max(speed, std::abs(r.object.twist[2]));
  });
  EXPECT_EQ(emulator.record().parameters[0], 0.5);
  // For comparison, the test also performs the same run without the input.
  Emulator alone(LoadTestScenario("box_9kg"));
  double usual = 0;
  Pass(&alone, 5, [] {});
  Pass(&alone, 1.1, [&] { usual = std::max(usual, std::abs(alone.record().object.twist[2])); });
  EXPECT_LT(speed, usual + 0.01);
  EXPECT_NEAR(emulator.record().object.pose.p[2], alone.record().object.pose.p[2], 0.01);
  EXPECT_EQ(start.parameters[0], 1);
}

TEST(Parameters, ATighterThresholdStops) {
  Emulator emulator(LoadTestScenario("box_9kg"));
  Pass(&emulator, 1, [] {});
  ASSERT_TRUE(emulator.Submit(Set(Parameter::kForceThreshold, 6)));
  Pass(&emulator, 5, [] {});
  EXPECT_EQ(emulator.record().cause, StopCause::kForce);
  EXPECT_LT(emulator.record().cause_limit, 30);
}

TEST(Parameters, OutOfRangeAreRefused) {
  Emulator emulator(LoadTestScenario("box_9kg"));
  Pass(&emulator, 0.1, [] {});
  for (const RunInput& input :
       {Set(Parameter::kForceThreshold, 31), Set(Parameter::kForceThreshold, kNan),
        Set(Parameter::kStiffnessTranslation, 0), Set(Parameter::kStiffnessTranslation, 1e9),
        Set(Parameter::kDampingRatio, -1), Set(static_cast<Parameter>(200), 1),
        Of(static_cast<InputKind>(99)), Of(InputKind::kNone)})
    EXPECT_FALSE(emulator.Submit(input));
  EXPECT_EQ(emulator.record().state, RunState::kRun);
}

TEST(Buttons, EndAsPlannedEndsWithoutACause) {
  Emulator emulator(LoadTestScenario("box_9kg"));
  Pass(&emulator, 1, [] {});
  RunInput end = Of(InputKind::kStop);
  end.value = kEndAsPlanned;
  ASSERT_TRUE(emulator.Submit(end));
  Pass(&emulator, 5, [] {});
  EXPECT_EQ(emulator.state(), RunState::kHeld);
  EXPECT_EQ(emulator.record().cause, StopCause::kNone);
}

TEST(Hands, OfAPageAreUsedOnlyWithABrowserOperator) {
  Emulator scripted(LoadTestScenario("box_9kg"));
  Pass(&scripted, 0.1, [] {});
  EXPECT_FALSE(scripted.Submit(Hold(0, scripted.record().hands[0].virtual_.pose)));
  Emulator emulator(LoadTestScenario("box_9kg", {"operator.type=browser", "operator.script=[]"}));
  Pass(&emulator, 0.1, [] {});
  const PoseRecord X = emulator.record().hands[0].virtual_.pose;
  EXPECT_TRUE(emulator.Submit(Hold(0, X)));
  PoseRecord far = X, nan = X, no_rotation = X;
  far.p[0] = 1e6;
  nan.p[1] = kNan;
  no_rotation.q = {0, 0, 0, 0};
  EXPECT_FALSE(emulator.Submit(Hold(0, far)));
  EXPECT_FALSE(emulator.Submit(Hold(0, nan)));
  EXPECT_FALSE(emulator.Submit(Hold(0, no_rotation)));
  EXPECT_FALSE(emulator.Submit(Hold(7, X)));
}

// Inputs arrive at the rate at which a page sends them, and make both hands lift the box by 8 cm.
// Then the page stops sending.
TEST(Hands, LiftTheBoxWithinTheirLimitAndReleaseOnSilence) {
  Emulator emulator(
      LoadTestScenario("box_9kg", {"operator.type=browser", "operator.script=[]", "duration=100"}));
  Pass(&emulator, 0.2, [] {});
  const auto& record = emulator.record();
  const std::array<PoseRecord, kHands> start = {record.hands[0].virtual_.pose,
                                                record.hands[1].virtual_.pose};
  const double height = record.object.pose.p[2];
  double force = 0;
  long tick = 0;
  test::AllocationGuard guard;
  Pass(&emulator, 6, [&] {
    if (++tick % 16 != 0) return;
    const double lifted = 0.14 * std::min(1.0, emulator.run_time() / 4);
    for (int i = 0; i < kHands; ++i) {
      PoseRecord X = start[static_cast<std::size_t>(i)];
      X.p[2] += lifted;
      ASSERT_TRUE(emulator.Submit(Hold(i, X)));
    }
    for (const HandRecord& hand : record.hands)
      force = std::max(force,
                       std::hypot(hand.true_wrench[0], hand.true_wrench[1], hand.true_wrench[2]));
  });
  EXPECT_EQ(guard.count(), 0);
  EXPECT_EQ(record.state, RunState::kRun);
  EXPECT_GT(record.object.pose.p[2], height + 0.06);
  EXPECT_GT(force, 10);
  EXPECT_LT(force, 26);  // 25 N plus the hand's own inertia
  EXPECT_EQ(record.hands_gripping, 2);
  Pass(&emulator, 0.6, [] {});
  EXPECT_EQ(record.hands_gripping, 0);
  EXPECT_EQ(record.state, RunState::kRun);  // the run continues
  Pass(&emulator, 5, [] {});
  EXPECT_NEAR(record.object.pose.p[2], height, 0.01);
}

TEST(Buttons, StopResetAlignAndStartAgain) {
  Emulator emulator(LoadTestScenario("box_9kg"));
  Pass(&emulator, 1, [] {});
  ASSERT_TRUE(emulator.Submit(Of(InputKind::kStop)));
  for (int k = 0; k < 2000 && emulator.state() != RunState::kHeld; ++k) emulator.Tick();
  ASSERT_EQ(emulator.state(), RunState::kHeld);
  EXPECT_EQ(emulator.record().cause, StopCause::kOperator);
  // Only a reset can end the held state.
  emulator.Submit(Of(InputKind::kStart));
  for (int k = 0; k < 100; ++k) emulator.Tick();
  EXPECT_EQ(emulator.state(), RunState::kHeld);
  emulator.Submit(Of(InputKind::kReset));
  emulator.Tick();
  EXPECT_EQ(emulator.state(), RunState::kIdle);
  emulator.Submit(Of(InputKind::kAlign));
  for (int k = 0; k < 20'000 && emulator.state() != RunState::kArmed; ++k) emulator.Tick();
  ASSERT_EQ(emulator.state(), RunState::kArmed);
  emulator.Submit(Of(InputKind::kStart));
  for (int k = 0; k < 3000; ++k) emulator.Tick();
  EXPECT_EQ(emulator.state(), RunState::kRun);
  EXPECT_GT(emulator.run_time(), 2.9);
}

TEST(Inputs, OfALatencyAreRecordedAndMoveNothing) {
  Emulator emulator(LoadTestScenario("box_9kg"));
  Pass(&emulator, 0.1, [] {});
  ASSERT_TRUE(emulator.Submit(Of(InputKind::kLatency)));
  for (const InputKind kind : {InputKind::kHeadset, InputKind::kWatchdog, InputKind::kSuspended})
    EXPECT_FALSE(emulator.Submit(Of(kind)));  // needs a time
  emulator.Tick();
  EXPECT_EQ(emulator.record().inputs[0].kind, InputKind::kLatency);
  EXPECT_EQ(emulator.state(), RunState::kRun);
}

// In every state, a suspend must stop the run, because all data about the arms and people is
// outdated.
TEST(Inputs, OfASuspendStopTheRun) {
  for (const double seconds : {0.0, 0.1}) {
    Emulator emulator(LoadTestScenario("box_9kg"));
    while (emulator.state() != RunState::kIdle) emulator.Tick();
    if (seconds > 0) Pass(&emulator, seconds, [] {});
    RunInput input = Of(InputKind::kSuspended);
    input.value = 7200;
    ASSERT_TRUE(emulator.Submit(input));
    emulator.Tick();
    EXPECT_EQ(emulator.state(), RunState::kStopping);
    EXPECT_EQ(emulator.record().cause, StopCause::kDeadline);
    EXPECT_EQ(emulator.record().cause_quantity, Quantity::kTime);
    EXPECT_EQ(emulator.record().cause_value, 7200);
  }
}

TEST(Inputs, AreInTheRecordOfTheTickThatTookThem) {
  Emulator emulator(LoadTestScenario("box_9kg"));
  Pass(&emulator, 0.1, [] {});
  emulator.Submit(Set(Parameter::kDampingRatio, 1.5));
  for (int k = 0; k < 10; ++k) emulator.Submit(Set(Parameter::kForceThreshold, 20 - k));
  emulator.Tick();
  ASSERT_EQ(emulator.record().input_count, kInputsPerTick);
  EXPECT_EQ(emulator.record().inputs[0].parameter, Parameter::kDampingRatio);
  EXPECT_EQ(emulator.record().inputs[3].value, 18);
  emulator.Tick();
  EXPECT_EQ(emulator.record().input_count, 0);
}

TEST(Mailbox, IsSharedByItsDescriptorAndSurvivesNonsense) {
  Shared<RunMailbox> mine;
  Shared<RunMailbox> theirs(dup(mine.descriptor()), true);
  ASSERT_TRUE(theirs->inputs.Push(Set(Parameter::kDampingRatio, 1.5)));
  RunInput input;
  ASSERT_TRUE(mine->inputs.Pop(&input));
  EXPECT_EQ(input.value, 1.5);
  EXPECT_FALSE(mine->inputs.Pop(&input));
  for (std::uint32_t k = 0; k < InputQueue::kCapacity; ++k)
    ASSERT_TRUE(theirs->inputs.Push(Of(InputKind::kAlign)));
  EXPECT_FALSE(theirs->inputs.Push(Of(InputKind::kAlign)));
  // A faulty writer fills the shared memory with arbitrary values.
  std::memset(static_cast<void*>(&theirs->inputs), 0xa5, sizeof(InputQueue));
  int taken = 0;
  while (mine->inputs.Pop(&input)) ASSERT_LE(++taken, static_cast<int>(InputQueue::kCapacity));
  EXPECT_THROW(Shared<RunBoard>(dup(mine.descriptor()), false), std::runtime_error);
}

}  // namespace
}  // namespace predictor
