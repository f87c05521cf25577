#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "core/random.h"
#include "safety/guard.h"
#include "safety/monitor.h"
#include "safety/state_machine.h"
#include "safety/stop.h"
#include "support/allocation_guard.h"
#include "support/soak.h"

namespace predictor {
namespace {

using test::AllocationGuard;

static_assert(noexcept(std::declval<Monitor&>().Check(std::declval<const MonitorInput&>())));
static_assert(noexcept(std::declval<StateMachine&>().Handle(RunEvent::kReset)));
static_assert(
    noexcept(std::declval<OscillationDetector&>().Update(std::declval<const Vector3&>())));
static_assert(noexcept(std::declval<VibrationDetector&>().Update(std::declval<const Vector3&>())));
static_assert(noexcept(std::declval<VibrationDetector&>().Reset()));

// Calls this module as the emulator does in each tick. The runs oscillate, stop, brake and are
// reset. Some of the input numbers are not finite.
class Loop {
 public:
  Loop() : monitor_(SafetySpec{}, RenderingSpec{}, {true, true}, 0.001) {
    for (std::size_t hand = 0; hand < kHands; ++hand) {
      bounds_[hand] = {JointVector::Constant(7, -2), JointVector::Constant(7, 2),
                       JointVector::Constant(7, 2), JointVector::Constant(7, 10)};
      sample_.arms[hand].present = true;
      sample_.arms[hand].q = sample_.arms[hand].v = JointVector::Zero(7);
      input_.lower[hand] = bounds_[hand].lower;
      input_.upper[hand] = bounds_[hand].upper;
      input_.wrench[hand].present = true;
      render_.v[hand] = JointVector::Zero(7);
    }
    input_.present = {true, true};
    input_.sample = &sample_;
    input_.world = &world_;
    input_.render = &render_;
    render_.link_distance = 1;
    guard_ = Guard(bounds_, 0.001, 0.025);
    stop_ = StopController(SafetySpec{}, bounds_, 0.001);
  }

  void Tick(int k) {
    Follow(k);
    input_.running = machine_.state() == RunState::kRun;
    const Status status = monitor_.Check(input_);
    if (!status.ok() && !stop_.active()) {
      ++stops_;
      machine_.Handle(RunEvent::kStopRequested);
      stop_.Begin(status, 0.001 * k, guard_.last(), 0.2, 1);
    }
    for (std::size_t hand = 0; hand < kHands; ++hand) {
      command_[hand] = JointVector::Constant(7, 0.5 * std::sin(0.004 * k));
    }
    if (k % 997 == 0) command_[1][3] = std::numeric_limits<double>::quiet_NaN();
    if (stop_.active()) Brake();
    guard_.Apply(q_, &command_);
    for (std::size_t hand = 0; hand < kHands; ++hand) q_[hand] += command_[hand] * 0.001;
  }
  int stops() const { return stops_; }
  int resets() const { return resets_; }

 private:
  void Follow(int k) {
    for (std::size_t hand = 0; hand < kHands; ++hand) {
      ArmSample& arm = sample_.arms[hand];
      if (q_[hand].size() == 0) q_[hand] = JointVector::Zero(7);
      arm.q = q_[hand];
      ++arm.sensor_sequence;
      arm.F_S_raw[0] = 0.05 * random_.Normal();
      const double t = 0.001 * (k % 20000);
      input_.wrench[hand].F_H_W[2] =
          0.5 * std::pow(1.2, t) * std::sin(2 * std::numbers::pi * t) + arm.F_S_raw[0];
    }
    if (machine_.state() == RunState::kInit) machine_.Handle(RunEvent::kStarted);
    if (machine_.state() == RunState::kSelfTest) machine_.Handle(RunEvent::kSelfTestPassed);
    if (machine_.state() == RunState::kIdle) machine_.Handle(RunEvent::kAlignRequested);
    if (machine_.state() == RunState::kAlign) machine_.Handle(RunEvent::kAligned);
    if (machine_.state() == RunState::kArmed) machine_.Handle(RunEvent::kStartRequested);
  }
  void Brake() {
    const double way = q_[0][0];
    stop_.Observe({Pose{Vector3(way, 0, 0), Quaternion::Identity()},
                   Pose{Vector3(0, way, 0), Quaternion::Identity()}});
    stop_.Next(&command_);
    if (!stop_.done()) return;
    machine_.Handle(RunEvent::kStandstill);
    if (machine_.state() != RunState::kHeld) return;
    machine_.Handle(RunEvent::kReset);
    ++resets_;
    stop_.Reset();
    monitor_.Reset();
    guard_.Reset();
  }

  std::array<JointBounds, kHands> bounds_;
  Monitor monitor_;
  Guard guard_;
  StopController stop_{SafetySpec{}, {}, 0.001};
  StateMachine machine_;
  DeviceSample sample_;
  WorldState world_;
  RenderResult render_;
  MonitorInput input_;
  std::array<JointVector, kHands> q_, command_;
  RandomStream random_{1, "loop"};
  int stops_ = 0, resets_ = 0;
};

TEST(SafetyAllocation, NoTickTakesFromTheHeapSoak) {
  PREDICTOR_SKIP_WITHOUT_ALLOCATION_GUARD();
  const int ticks = static_cast<int>(Count(200000, 10000000));
  Loop loop;
  AllocationGuard guard;
  for (int k = 0; k < ticks; ++k) loop.Tick(k);
  const std::int64_t count = guard.count();
  EXPECT_EQ(count, 0);
  EXPECT_GE(loop.stops(), ticks / 20000 - 1);  // otherwise the tested events did not occur
  EXPECT_EQ(loop.resets(), loop.stops());
}

}  // namespace
}  // namespace predictor
