#include "emulator/placement.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/error.h"
#include "models/arm_limits.h"
#include "models/arm_model.h"
#include "scenario/located.h"

namespace predictor {
namespace {

constexpr int kRestarts = 20;  // restarts of the inverse kinematics, from seeded random joints

InputError Unreachable(const Scenario& s, int hand, const Pose& X_WD) {
  const std::string key = DeviceArmKey(hand) + ".base";
  char text[512];
  std::snprintf(
      text, sizeof text,
      ": the arm cannot move its handle to the start of the scenario: (%.3f, %.3f, %.3f) m in the "
      "world, %.3f m from its base. %s `predictor check` proposes a position.",
      X_WD.p.x(), X_WD.p.y(), X_WD.p.z(), (X_WD.p - s.X_WB(hand).p).norm(),
      s.HasFixedArms() ? "Change environment.shift." : "Move the base.");
  return InputError::At(key, key + text);
}

}  // namespace

JointVector StartingJoints(const ArmSpec& spec, const RobotModel& model) {
  if (!spec.posture.empty()) return PostureOf(spec.posture, model, "posture");
  JointVector q(model.dof());
  for (int j = 0; j < model.dof(); ++j) {
    const double lower = std::max(model.position_lower()[j], -3.0);
    const double upper = std::min(model.position_upper()[j], 3.0);
    q[j] = (lower + upper) / 2;
  }
  return q;
}

std::shared_ptr<const RobotModel> LoadArm(const Scenario& s, int hand) {
  auto model = LoadArmModel(s.arm(hand), s.X_WB(hand), s.folder(), DeviceArmKey(hand));
  try {
    (void)LimitsOf(s.arm(hand), *model);
  } catch (const InputError& error) {
    throw error.Within(DeviceArmKey(hand));
  }
  return model;
}

bool PlaceArm(const ArmSpec& spec, const RobotModel& model, const FrameId& handle, const Pose& X_WD,
              double offset, JointVector* q) {
  Pose goal = X_WD;
  goal.p += offset / std::sqrt(2.0) * Vector3(-1, 0, 1);
  return SolveInverseKinematics(model, handle, goal, StartingJoints(spec, model), kRestarts, q);
}

std::array<JointVector, kHands> PlaceArms(
    const Scenario& s, const std::array<std::shared_ptr<const RobotModel>, kHands>& models,
    const std::array<FrameId, kHands>& handles, const std::array<Pose, kHands>& X_WD,
    double offset) {
  std::array<JointVector, kHands> start;
  for (int i = 0; i < kHands; ++i) {
    if (!models[i]) continue;
    if (!PlaceArm(s.arm(i), *models[i], handles[i], X_WD[i], offset, &start[i]))
      throw Unreachable(s, i, X_WD[i]);
  }
  return start;
}

}  // namespace predictor
