// The results of a failed QP and of a rejected physics step must not contribute to the command.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "commands.h"
#include "emulator/placement.h"
#include "haptics/renderer.h"
#include "models/arm_limits.h"
#include "models/robot.h"
#include "runs.h"
#include "safety/guard.h"
#include "support/constants.h"
#include "support/rapidcheck.h"

namespace predictor {
namespace {

// The commands that an emulator sent in each tick until HELD, and the index of the tick in which
// the stop began. If `asked` has a value, the test requests a stop in that tick.
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

// The controller is too stiff for the simulation. The emulator discards the step that diverges and
// stops the run. From then on, the commands must equal, bit for bit, those of a run in which the
// same tick received a stop request. The equality shows that the rejected step has no effect.
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

// Two arms with a renderer and a guard.
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
  // handles are close to the real ones.
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

  // Returns the command for `target` that follows the last command.
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
    guard.Apply(q_, &v);  // limits the last command
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

// If the QP has no solution, its target must have no effect. The emulator sends the last command,
// scaled by one factor for both arms. After a reset, no trace of the failure may remain.
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
