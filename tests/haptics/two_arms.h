// Two arms in random states, including states at or beyond limits, stretched arms, and arms near
// each other.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "core/motion.h"
#include "core/random.h"
#include "haptics/renderer.h"
#include "models/arm_limits.h"
#include "support/constants.h"

namespace predictor {

inline const char* const kPanda =
    "package://example-robot-data/robots/panda_description/urdf/panda.urdf";

inline ArmSpec Panda(double y) {
  ArmSpec arm;
  arm.model = kPanda;
  arm.remove_links = {"panda_hand"};
  arm.base.xyz = {0, y, 0};
  arm.end_effector = "panda_link8";
  arm.elbow = "panda_link4";
  return arm;
}

// The two arms are 0.5 m apart, so that their elbows come near each other.
class TwoArms {
 public:
  TwoArms() {
    scenario_.device.left = Panda(0.25);
    scenario_.device.right = Panda(-0.25);
    scenario_.left_handle = scenario_.right_handle = HandleSpec{};
    for (int i = 0; i < kHands; ++i) {
      const ArmSpec& spec = scenario_.arm(i);
      models_[i] = RobotModel::Load({spec.model, "", spec.remove_links, spec.base.X_RB()});
      handles_[i] = models_[i]->Frame(spec.end_effector, Pose{{0, 0, 0.1}, Quaternion::Identity()});
      limits_[i] = LimitsOf(spec, *models_[i]);
      data_.emplace_back(*models_[i]);
      last_[i].setZero(7);
      v0_.setZero(7);
    }
  }

  // Draws joint positions at random. One in four of the joints is at a limit, beyond a limit, or
  // straight (singular). The command and the target are also random, and the target is sometimes
  // far away.
  void Draw(RandomStream* random) {
    for (int i = 0; i < kHands; ++i) {
      q_[i].resize(7);
      for (int j = 0; j < 7; ++j) {
        const double lower = limits_[i].lower[j];
        const double upper = limits_[i].upper[j];
        q_[i][j] = lower + (upper - lower) * random->Uniform();
        const double kind = random->Uniform();
        if (kind < 0.05)
          q_[i][j] = lower;
        else if (kind < 0.10)
          q_[i][j] = upper + 0.02 * random->Uniform();
        else if (kind < 0.15)
          q_[i][j] = lower - 0.02 * random->Uniform();
        else if (kind < 0.25 && lower < 0 && upper > 0)
          q_[i][j] = 1e-4 * random->Normal();
        last_[i][j] =
            limits_[i].velocity[j] * (2 * random->Uniform() - 1) * (random->Uniform() < 0.5);
      }
      data_[static_cast<std::size_t>(i)].UpdateKinematics(*models_[i], q_[i], v0_);
      arms_[i] = {true,
                  models_[i].get(),
                  &data_[static_cast<std::size_t>(i)],
                  &data_[static_cast<std::size_t>(i)],
                  handles_[i],
                  &q_[i]};
      const double far = random->Uniform() < 0.1 ? 0.3 : 0.002;
      FrameMotion& D = target_.handle[i];
      D.X_W = data_[static_cast<std::size_t>(i)].FramePose(*models_[i], handles_[i]);
      D.X_W.p += far * Vector3(random->Normal(), random->Normal(), random->Normal());
      D.X_W.q =
          RotationFromVector(far * Vector3(random->Normal(), random->Normal(), random->Normal())) *
          D.X_W.q;
      for (int k = 0; k < 6; ++k) D.V_W[k] = 0.1 * random->Normal(), D.A_W[k] = random->Normal();
    }
    target_.speed_cap = 0.25;
    target_.rotation_cap = 1.5;
  }

  // Returns the speed of the faster handle at the last command, as a stop computes it [m/s].
  double Speed() const {
    double speed = 0;
    for (int i = 0; i < kHands; ++i) {
      Jacobian J;
      arms_[i].data->FrameJacobian(*models_[i], handles_[i], &J);
      Twist V = Twist::Zero();
      for (int j = 0; j < 7; ++j) V += last_[i][j] * J.col(j);
      speed = std::max(speed, StopSpeed(V));
    }
    return speed;
  }

  std::unique_ptr<Renderer> MakeRenderer(double manipulability = 0) {
    scenario_.rendering.manipulability = manipulability;
    scenario_.safety.relative_slack = scenario_.safety.relative_slack_rotation = 1e9;
    return std::make_unique<Renderer>(scenario_, models_, 0.02, kDt);
  }

  Scenario scenario_;
  std::array<std::shared_ptr<const RobotModel>, kHands> models_;
  std::array<FrameId, kHands> handles_;
  std::array<ArmLimits, kHands> limits_;
  std::vector<RobotData> data_;
  std::array<JointVector, kHands> q_, last_;
  JointVector v0_;
  std::array<RenderArm, kHands> arms_;
  RenderTarget target_;
};

}  // namespace predictor
