// Tests properties of the command under any sequence of requests and inputs (RapidCheck):
//   - It never changes by more than the acceleration limit allows in a tick, or in the elapsed
//     ticks of a stop. It is zero in states without motion.
//   - Both arms share one stop.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "commands.h"
#include "devices/device.h"
#include "emulator/placement.h"
#include "models/arm_limits.h"
#include "models/robot.h"
#include "runs.h"
#include "safety/stop.h"
#include "support/constants.h"
#include "support/rapidcheck.h"

namespace predictor {
namespace {

// An action between two ticks, and the number of ticks that follow it.
struct Act {
  enum class Kind { kNothing, kRequest, kEnd, kInput, kLate } kind;
  int what;      // event, kind of input, or jitter of the ticks
  double value;  // of the input
  int ticks;
};

rc::Gen<Act> SomeAct() {
  return rc::gen::construct<Act>(rc::gen::weightedElement<Act::Kind>({{2, Act::Kind::kNothing},
                                                                      {6, Act::Kind::kRequest},
                                                                      {1, Act::Kind::kEnd},
                                                                      {4, Act::Kind::kInput},
                                                                      {2, Act::Kind::kLate}}),
                                 rc::gen::inRange(0, kInputKinds + 2),
                                 rc::gen::element(0.0, 0.3, 1.0, 2.0, 17.0, -1.0, kNan),
                                 rc::gen::inRange(1, 60));
}

void Do(const Act& act, Emulator* emulator) {
  RunInput input;
  switch (act.kind) {
    case Act::Kind::kRequest:
      emulator->Request(static_cast<RunEvent>(act.what % kRunEvents));
      break;
    case Act::Kind::kEnd:
      emulator->RequestEnd();
      break;
    case Act::Kind::kInput:
      input.kind = static_cast<InputKind>(act.what);
      input.parameter = static_cast<Parameter>(act.what % (kParameters + 1));
      input.value = act.value;
      emulator->Submit(input);
      break;
    case Act::Kind::kLate:
    case Act::Kind::kNothing:
      break;
  }
}

// Returns the number of ticks that the loop missed before tick k, which is usually zero and at most
// 3.
int Missed(const Act& act, int k) {
  return act.kind == Act::Kind::kLate ? (act.what + k * (1 + act.what)) % 4 : 0;
}

// Presents the simulated rig as real arms, for which time continues while the loop is late.
class LateArms final : public Device {
 public:
  LateArms(const Scenario& scenario, const std::array<JointVector, kHands>& start)
      : rig_(MakeSimulatedDevice(scenario, start)) {}
  Status Read(DeviceSample* sample) noexcept override { return rig_->Read(sample); }
  Status Write(const DeviceCommand& command) noexcept override {
    last_ = command;
    return rig_->Write(command);
  }
  // Lets ticks pass without a new command.
  void Pass(int ticks, const Arms& v) {
    last_.v = v;
    for (; ticks > 0; --ticks) (void)rig_->Write(last_);
  }
  void Archive(StateArchive& a) noexcept override { rig_->Archive(a); }
  std::string Describe() const override { return "arms passed off as real"; }

 private:
  std::unique_ptr<Device> rig_;
  DeviceCommand last_;
};

// Checks the command of the emulator after every tick.
class Watched {
 public:
  explicit Watched(const Scenario& scenario)
      : Watched(scenario, std::make_unique<Emulator>(scenario)) {}
  // The arms continue to move while ticks are late.
  static Watched Real(Scenario scenario) {
    const auto start = Emulator(scenario).setup().start;
    auto device = std::make_unique<LateArms>(scenario, start);
    LateArms* real = device.get();
    scenario.device.type = "real";
    Watched watched(scenario, std::make_unique<Emulator>(scenario, std::move(device)));
    watched.real_ = real;
    return watched;
  }

  // Performs a run and its stop, and keeps a saved state of each phase.
  void Collect() {
    Keep();
    for (int k = 0; emulator_->run_time() < 8 && k < 60'000; ++k) {
      Enable();
      emulator_->Tick();
      if (k % 500 == 0) Keep();
      if (emulator_->state() == RunState::kIdle) emulator_->Request(RunEvent::kAlignRequested);
      if (emulator_->state() == RunState::kArmed) emulator_->Request(RunEvent::kStartRequested);
    }
    ASSERT_EQ(emulator_->state(), RunState::kRun);
    emulator_->Request(RunEvent::kStopRequested);
    for (int k = 0; k < 2000 && emulator_->state() != RunState::kHeld; ++k) {
      Enable();
      emulator_->Tick();
      if (k % 20 == 10) Keep();
    }
    Keep();
  }
  std::size_t kept() const { return kept_.size(); }

  void GoBackTo(std::size_t which) {
    emulator_->LoadState(kept_[which].bytes);
    last_ = kept_[which].last;
    state_ = kept_[which].state;
    start_.reset();
  }

  // Performs the ticks after `act`. Each command must be within its bounds.
  void Go(const Act& act) {
    Do(act, emulator_.get());
    for (int k = 0; k < act.ticks; ++k) {
      const int missed = Missed(act, k);
      if (real_) real_->Pass(missed, last_);
      Enable();
      emulator_->Tick(static_cast<std::uint64_t>(k) * 1'000'000, missed);
      Look(real_ ? 1 + missed : 1);
    }
  }
  int late_in_stops() const { return late_in_stops_; }

 private:
  struct Kept {
    std::vector<std::byte> bytes;
    Arms last;
    RunState state;
  };

  Watched(const Scenario& scenario, std::unique_ptr<Emulator> emulator)
      : emulator_(std::move(emulator)) {
    for (int i = 0; i < kHands; ++i) limits_[i] = LimitsOf(scenario.arm(i), *LoadArm(scenario, i));
  }

  // The person continues to hold the key of the real arms.
  void Enable() {
    RunInput key;
    key.kind = InputKind::kEnable;
    key.value = 1;
    if (real_) emulator_->Submit(key);
  }

  void Keep() {
    Kept kept{std::vector<std::byte>(kStateBytes), CommandOf(emulator_->record()),
              emulator_->record().state};
    kept.bytes.resize(emulator_->SaveState(kept.bytes));
    for (std::size_t i = 0; i < kHands; ++i)
      if (kept.last[i].size() == 0) kept.last[i].setZero(limits_[i].velocity.size());
    kept_.push_back(std::move(kept));
  }

  // `passed` is the number of ticks since the last command.
  void Look(int passed) {
    const TickRecord& record = emulator_->record();
    const Arms now = CommandOf(record);
    const bool may_move = MayMove(record.state);
    const int ticks = record.state == RunState::kStopping ? passed : 1;
    late_in_stops_ += ticks > 1;
    for (std::size_t i = 0; i < kHands; ++i) {
      const ArmLimits& limits = limits_[i];
      RC_ASSERT(now[i].size() == limits.velocity.size());
      for (int j = 0; j < now[i].size(); ++j) {
        RC_ASSERT(std::abs(now[i][j]) <= limits.velocity[j]);
        const double v = now[i][j], last = last_[i][j];
        const double step = limits.acceleration[j] * emulator_->dt() * (1 + 1e-9);
        const bool slower = std::min(last, 0.0) <= v && v <= std::max(last, 0.0);
        RC_ASSERT(std::abs(v - last) <= step || (slower && std::abs(v - last) <= ticks * step));
        RC_ASSERT(may_move || now[i][j] == 0);
      }
    }
    if (record.state == RunState::kStopping && state_ != RunState::kStopping) {
      start_ = last_;
      apart_ = 0;
    }
    if (record.state == RunState::kStopping && start_) LookAtFactors(*start_, now, ticks);
    if (record.state != RunState::kStopping) start_.reset();
    last_ = now;
    state_ = record.state;
  }

  // The arms share one stop. Each of its commands is the last command before the stop, multiplied
  // by a factor in [0, kOvershoot]. The factors differ only because the faster arm waits for the
  // slower one, and only within the documented distance. The change of the arms' geometry has
  // little effect.
  void LookAtFactors(const Arms& start, const Arms& now, int ticks) {
    std::array<double, kHands> factor;
    for (std::size_t i = 0; i < kHands; ++i) {
      if (start[i].norm() < 0.01) return;  // [rad/s]: practically at rest
      factor[i] = start[i].dot(now[i]) / start[i].squaredNorm();
      RC_ASSERT(factor[i] >= -0.005);
      RC_ASSERT(factor[i] <= StopProfile::kOvershoot + 0.005);
    }
    apart_ += (factor[0] - factor[1]) * ticks * emulator_->dt();
    RC_ASSERT(std::abs(apart_) <= StopController::kMaxFollowing + 0.001);
  }

  std::unique_ptr<Emulator> emulator_;
  LateArms* real_ = nullptr;
  std::array<ArmLimits, kHands> limits_;
  std::vector<Kept> kept_;
  Arms last_;
  RunState state_ = RunState::kInit;
  std::optional<Arms> start_;  // last command before the current stop
  double apart_ = 0;           // lead of the left arm at the initial speed [s]
  int late_in_stops_ = 0;
};

void ExpectBounded(Watched* watched) {
  ASSERT_NO_FATAL_FAILURE(watched->Collect());
  ASSERT_GT(watched->kept(), 20U);
  EXPECT_TRUE(rc::check([&] {
    watched->GoBackTo(*rc::gen::inRange<std::size_t>(0, watched->kept()));
    const auto acts = *rc::gen::container<std::vector<Act>>(SomeAct());
    for (const Act& act : acts) watched->Go(act);
  }));
}

TEST(EmulatorProperties, NothingThatIsAskedForMakesTheCommandStepSoak) {
  Watched watched(LoadTestScenario("box_9kg"));
  ExpectBounded(&watched);
}

// The loop repeatedly misses up to three ticks, and the arms do not wait for it. A stop must still
// end in time.
TEST(EmulatorProperties, NorWhatIsAskedForOfRealArmsWhileTicksComeLateSoak) {
  Watched watched = Watched::Real(LoadTestScenario("box_9kg"));
  ExpectBounded(&watched);
  EXPECT_GT(watched.late_in_stops(), 100);
}

// A run must refuse the inputs that only a player of recordings understands.
TEST(EmulatorProperties, WhatPlaysARecordingIsRefusedByARun) {
  Emulator emulator(LoadTestScenario("box_9kg"));
  EXPECT_TRUE(rc::check([&] {
    RunInput input;
    input.kind = *rc::gen::element(InputKind::kPlay, InputKind::kSeek, InputKind::kStep);
    input.value = *rc::gen::arbitrary<double>();
    RC_ASSERT(!emulator.Submit(input));
  }));
}

// Whatever the initial pose is, the arms can stop from the last command of ALIGN within one tick,
// so no command is sent in ARMED.
TEST(EmulatorProperties, NothingIsSentInArmedHoweverAlignEnds) {
  for (const char* offset : {"0", "0.0015", "0.01", "0.05"})
    for (const char* kp : {"0.3", "2", "20"}) {
      Emulator emulator(LoadTestScenario("box_9kg", {std::string("rig.start_offset=") + offset,
                                                     std::string("rendering.kp=") + kp}));
      int armed = 0;
      for (int k = 0; k < 60'000 && armed < 100; ++k) {
        if (emulator.state() == RunState::kIdle) emulator.Request(RunEvent::kAlignRequested);
        emulator.Tick();
        const TickRecord& record = emulator.record();
        ASSERT_NE(record.state, RunState::kStopping) << offset << " m, " << kp << " 1/s";
        if (record.state != RunState::kArmed) continue;
        ++armed;
        for (const JointVector& v : CommandOf(record))
          ASSERT_EQ(v.cwiseAbs().maxCoeff(), 0) << offset << " m, " << kp << " 1/s";
      }
      EXPECT_EQ(armed, 100) << offset << " m, " << kp << " 1/s";
    }
}

// The tolerance is so wide that the waiting time ends while the handles still move at full speed.
TEST(EmulatorProperties, AlignWaitsUntilTheArmsMayRestHoweverWideItsTolerance) {
  Emulator emulator(LoadTestScenario(
      "box_9kg", {"rig.start_offset=0.2", "rendering.kp=0.5", "safety.align_tolerance=0.0999",
                  "safety.align_tolerance_rotation=0.5"}));
  double fastest = 0;  // fastest joint within the tolerance [rad/s]
  int armed = 0, within = 0;
  for (int k = 0; k < 60'000 && armed < 100; ++k) {
    if (emulator.state() == RunState::kIdle) emulator.Request(RunEvent::kAlignRequested);
    emulator.Tick();
    const TickRecord& record = emulator.record();
    ASSERT_NE(record.state, RunState::kStopping);
    for (const JointVector& v : CommandOf(record)) {
      if (record.state == RunState::kArmed) {
        ASSERT_EQ(v.cwiseAbs().maxCoeff(), 0);
      }
      if (record.state == RunState::kAlign && ++within > 8000)
        fastest = std::max(fastest, v.cwiseAbs().maxCoeff());
    }
    armed += record.state == RunState::kArmed;
  }
  EXPECT_EQ(armed, 100);
  EXPECT_GT(fastest, 0.02);  // otherwise the test has no effect
}

}  // namespace
}  // namespace predictor
