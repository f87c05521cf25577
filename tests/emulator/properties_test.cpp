// Properties of the sent command under any sequence of requests, inputs and failures (RapidCheck):
//   - It never changes by more than a tick's acceleration allows (in a stop: than the acceleration
//     during the elapsed ticks allows), and it is zero in states without motion.
//   - Both arms share one stop.
//   - A failed QP and a rejected physics step do not contribute to it.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "devices/device.h"
#include "emulator/placement.h"
#include "haptics/renderer.h"
#include "models/arm_limits.h"
#include "models/robot.h"
#include "runs.h"
#include "safety/guard.h"
#include "safety/stop.h"
#include "support/constants.h"
#include "support/rapidcheck.h"

namespace predictor {
namespace {

using Arms = std::array<JointVector, kHands>;

Arms CommandOf(const TickRecord& record) {
  Arms v;
  for (std::size_t i = 0; i < kHands; ++i)
    v[i] = Eigen::Map<const JointVector>(record.hands[i].command.data(), record.hands[i].arm_dof);
  return v;
}

// ---- requests and inputs ------------------------------------------------------------------------

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

// Number of ticks that the loop missed before tick k: usually none, at most 3.
int Missed(const Act& act, int k) {
  return act.kind == Act::Kind::kLate ? (act.what + k * (1 + act.what)) % 4 : 0;
}

// Presents the simulated rig as real arms, whose time continues while the loop is late.
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
  // With arms that continue to move while ticks are late.
  static Watched Real(Scenario scenario) {
    const auto start = Emulator(scenario).setup().start;
    auto device = std::make_unique<LateArms>(scenario, start);
    LateArms* real = device.get();
    scenario.device.type = "real";
    Watched watched(scenario, std::make_unique<Emulator>(scenario, std::move(device)));
    watched.real_ = real;
    return watched;
  }

  // Performs a run and its stop, and keeps saved states from each phase.
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

  // Performs the ticks after `act`; every command must be within its bounds.
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

  // The person at real arms continues to hold the key.
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

  // passed: number of ticks since the last command.
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

  // The arms share one stop: each command is the last one before the stop times a factor in [0,
  // kOvershoot]. The factors may differ only because the faster arm follows the slower one, and
  // only within the promised distance. The change of the arms' geometry has little effect.
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

// Ticks are repeatedly late by up to three, and the arms do not wait. A stop must still keep its
// time.
TEST(EmulatorProperties, NorWhatIsAskedForOfRealArmsWhileTicksComeLateSoak) {
  Watched watched = Watched::Real(LoadTestScenario("box_9kg"));
  ExpectBounded(&watched);
  EXPECT_GT(watched.late_in_stops(), 100);
}

// A run refuses the inputs that only a player of recordings understands.
TEST(EmulatorProperties, WhatPlaysARecordingIsRefusedByARun) {
  Emulator emulator(LoadTestScenario("box_9kg"));
  EXPECT_TRUE(rc::check([&] {
    RunInput input;
    input.kind = *rc::gen::element(InputKind::kPlay, InputKind::kSeek, InputKind::kStep);
    input.value = *rc::gen::arbitrary<double>();
    RC_ASSERT(!emulator.Submit(input));
  }));
}

// Whatever the initial pose, one tick can stop the last command of ALIGN, so no command is sent in
// ARMED.
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

// The tolerance is so wide that the patience ends while the handles still move at full speed.
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

// ---- failures -----------------------------------------------------------------------------------

// The commands of an emulator in each tick until HELD, and the index of the tick in which the stop
// began. If `asked` has a value, a stop is requested in that tick.
struct Stopped {
  std::vector<Arms> sent;
  std::size_t decision = 0;
  StopCause cause = StopCause::kNone;
};

Stopped RunUntilHeld(const std::vector<std::string>& set, std::optional<std::size_t> asked) {
  Emulator emulator(LoadTestScenario("box_9kg", set));
  Stopped run;
  while (emulator.state() != RunState::kHeld && run.sent.size() < 60'000U) {
    if (asked == run.sent.size()) emulator.Request(RunEvent::kStopRequested);
    emulator.Tick();
    AutoStart(&emulator);
    run.sent.push_back(CommandOf(emulator.record()));
    if (run.cause != StopCause::kNone || emulator.record().cause == StopCause::kNone) continue;
    run.cause = emulator.record().cause;
    run.decision = run.sent.size() - 1;
  }
  return run;
}

// The controller is too stiff for the simulation: the emulator discards the step that diverges and
// stops the run. The commands must then equal, bit for bit, those of a run in which the same tick
// received a stop request, so the rejected step has no effect.
TEST(EmulatorProperties, ARejectedPhysicsStepContributesNothing) {
  for (const char* stiffness : {"2e4", "5e4", "1e5"}) {
    const std::vector<std::string> set = {
        "cobot.controller.type=joint_impedance",
        std::string("cobot.controller.joint_stiffness=") + stiffness,
        "cobot.controller.joint_damping_ratio=5",
        "cobot.effort_limit=1e6",
        "rendering.lead=0",
        "safety.tracking=10",
        "safety.tracking_rotation=3.2",
        "safety.force=1000",
        "safety.torque=100",
        "safety.coupling=1e4",
        "safety.coupling_torque=1e4",
        "safety.relative_slack=10",
        "safety.relative_slack_rotation=100",
        "safety.oscillation.enabled=false"};
    const Stopped failed = RunUntilHeld(set, {});
    ASSERT_EQ(failed.cause, StopCause::kPhysics) << stiffness;
    ASSERT_GT(failed.sent[failed.decision - 1][0].norm(), 1e-3) << "the arms do not move";
    const Stopped asked = RunUntilHeld(set, failed.decision);
    ASSERT_EQ(asked.cause, StopCause::kOperator);
    EXPECT_EQ(asked.decision, failed.decision);
    ASSERT_EQ(asked.sent.size(), failed.sent.size());
    for (std::size_t k = 0; k < asked.sent.size(); ++k)
      for (std::size_t i = 0; i < kHands; ++i)
        ASSERT_EQ(asked.sent[k][i], failed.sent[k][i]) << stiffness << ", tick " << k;
  }
}

// Two arms with their renderer and guard.
class RenderedArms {
 public:
  RenderedArms() : scenario_(LoadTestScenario("box_9kg")) {
    std::array<JointBounds, kHands> bounds;
    for (int i = 0; i < kHands; ++i) {
      const ArmSpec& spec = scenario_.arm(i);
      models_[i] = LoadArm(scenario_, i);
      handles_[i] = models_[i]->Frame(spec.end_effector, spec.handle.ToPose());
      limits_[i] = LimitsOf(spec, *models_[i]);
      bounds[i] = {limits_[i].lower, limits_[i].upper, limits_[i].velocity,
                   limits_[i].acceleration};
      data_.emplace_back(*models_[i]);
      q_[i].setZero(models_[i]->dof());
      last_[i].setZero(models_[i]->dof());
    }
    guard_ = Guard(bounds, kDt);
  }

  // Draws random joint angles well inside their limits and a random last command. The virtual
  // handles are near the real ones.
  void Draw() {
    for (int i = 0; i < kHands; ++i) {
      const ArmLimits& limits = limits_[i];
      for (int j = 0; j < q_[i].size(); ++j) {
        const double share = *test::Between(0.2, 0.8);
        q_[i][j] = limits.lower[j] + share * (limits.upper[j] - limits.lower[j]);
        last_[i][j] = 0.4 * limits.velocity[j] * *test::Between(-1, 1);
      }
      RobotData& data = data_[static_cast<std::size_t>(i)];
      data.UpdateKinematics(*models_[i], q_[i], JointVector::Zero(q_[i].size()));
      target_.handle[i].X_W = data.FramePose(*models_[i], handles_[i]);
      target_.handle[i].X_W.p[2] += 0.002;
    }
    target_.speed_cap = 0.25;
    target_.rotation_cap = 1.5;
  }

  std::unique_ptr<Renderer> MakeRenderer() const {
    return std::make_unique<Renderer>(scenario_, models_, 0.02, kDt);
  }

  // The command for `target` after the last command.
  Arms Send(Renderer* renderer, const RenderTarget& target, RenderResult* result) {
    std::array<RenderArm, kHands> arms;
    for (int i = 0; i < kHands; ++i) {
      const RobotData& data = data_[static_cast<std::size_t>(i)];
      arms[i] = {true, models_[i].get(), &data, &data, handles_[i], &q_[i]};
    }
    const Status status = renderer->Render(arms, target, last_, result);
    EXPECT_TRUE(status.ok());  // a single failure does not stop
    Guard guard = guard_;
    Arms v = last_;
    guard.Apply(q_, &v);  // the last command, as far as the guard allows it
    for (int k = 0; k < 1000 && v != last_; ++k) guard.Apply(q_, &(v = last_));
    Arms sent = result->v;
    guard.Apply(q_, &sent);
    return sent;
  }

  const RenderTarget& target() const { return target_; }
  const Arms& last() const { return last_; }

 private:
  Scenario scenario_;
  std::array<std::shared_ptr<const RobotModel>, kHands> models_;
  std::array<FrameId, kHands> handles_;
  std::array<ArmLimits, kHands> limits_;
  std::vector<RobotData> data_;
  Arms q_, last_;
  RenderTarget target_;
  Guard guard_;
};

// Returns `target` with one value of a virtual handle replaced by NaN.
RenderTarget Spoilt(RenderTarget target) {
  const auto nan = std::numeric_limits<double>::quiet_NaN();
  FrameMotion& D = target.handle[*rc::gen::inRange<std::size_t>(0, kHands)];
  const int k = *rc::gen::inRange(0, 3);
  switch (*rc::gen::inRange(0, 4)) {
    case 0:
      D.X_W.p[k] = nan;
      break;
    case 1:
      D.X_W.q.coeffs()[k] = nan;
      break;
    case 2:
      D.V_W[k] = nan;
      break;
    default:
      D.A_W[k] = nan;
  }
  return target;
}

// If the QP has no solution, its target has no effect: the last command is sent, scaled by one
// factor for both arms. After a reset, no trace of the failure remains.
TEST(EmulatorProperties, AFailedQpContributesNothingSoak) {
  RenderedArms two;
  EXPECT_TRUE(rc::check([&] {
    two.Draw();
    RenderResult one, other, fresh, again;
    const auto renderer = two.MakeRenderer();
    const Arms sent = two.Send(renderer.get(), Spoilt(two.target()), &one);
    const Arms same = two.Send(two.MakeRenderer().get(), Spoilt(two.target()), &other);
    RC_ASSERT(one.failed && other.failed);
    RC_ASSERT(sent == same);
    double along = 0, square = 0;
    for (std::size_t i = 0; i < kHands; ++i) {
      along += two.last()[i].dot(sent[i]);
      square += two.last()[i].squaredNorm();
    }
    const double factor = square > 0 ? along / square : 0;
    RC_ASSERT(factor >= 0 && factor < 1);
    for (std::size_t i = 0; i < kHands; ++i)
      RC_ASSERT((sent[i] - factor * two.last()[i]).cwiseAbs().maxCoeff() <= 1e-12);
    renderer->Reset();
    RC_ASSERT(two.Send(renderer.get(), two.target(), &again) ==
              two.Send(two.MakeRenderer().get(), two.target(), &fresh));
    RC_ASSERT(!again.failed);
  }));
}

}  // namespace
}  // namespace predictor
