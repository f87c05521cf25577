#include "emulator/placement.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/error.h"
#include "haptics/limits.h"

namespace predictor {
namespace {

constexpr int kRestarts = 20;  // of the inverse kinematics, from seeded random joints

std::string KeyOf(int hand) {
  return std::string("device.arms.") + kHandNames[static_cast<std::size_t>(hand)];
}

InputError Unreachable(const Scenario& s, int hand, const Pose& X_WD) {
  const std::string key = KeyOf(hand) + ".base";
  char text[512];
  std::snprintf(text, sizeof text,
                ": the arm cannot bring its handle to where the scenario starts: (%.3f, %.3f, "
                "%.3f) m in the world, %.3f m from its base. Move its base; `predictor check` "
                "proposes one.",
                X_WD.p.x(), X_WD.p.y(), X_WD.p.z(), (X_WD.p - s.arm(hand).base.xyz).norm());
  return InputError::At(key, key + text);
}

void CheckLink(const RobotModel& model, const std::string& link, const char* key) {
  try {
    (void)model.Frame(link);
  } catch (const InputError& error) {
    throw error.Within(key);
  }
}

// What of an arm's keys only its model can show to be wrong.
void CheckArm(const ArmSpec& spec, const RobotModel& model) {
  if (model.dof() > kMaxArmJoints)
    throw InputError::At("model", "model has " + std::to_string(model.dof()) + " joints; at most " +
                                      std::to_string(kMaxArmJoints) +
                                      " are possible. Remove links or choose another arm.");
  CheckLink(model, spec.end_effector, "end_effector");
  if (!spec.elbow.empty()) CheckLink(model, spec.elbow, "elbow");
  (void)StartingJoints(spec, model);
  (void)LimitsOf(spec, model);
}

}  // namespace

JointVector StartingJoints(const ArmSpec& spec, const RobotModel& model) {
  JointVector q(model.dof());
  if (!spec.posture.empty() && static_cast<int>(spec.posture.size()) != model.dof())
    throw InputError::At("posture", "posture has " + std::to_string(spec.posture.size()) +
                                        " values; the arm has " + std::to_string(model.dof()) +
                                        " joints. Give one a joint, in rad.");
  for (int j = 0; j < model.dof(); ++j) {
    const double lower = std::max(model.position_lower()[j], -3.0);
    const double upper = std::min(model.position_upper()[j], 3.0);
    q[j] = spec.posture.empty() ? (lower + upper) / 2 : spec.posture[static_cast<std::size_t>(j)];
  }
  return q;
}

std::shared_ptr<const RobotModel> LoadArm(const Scenario& s, int hand) {
  const ArmSpec& spec = s.arm(hand);
  auto model = RobotModel::Load(
      {spec.model, s.folder(), spec.remove_links, spec.base.ToPose(), KeyOf(hand)});
  try {
    CheckArm(spec, *model);
  } catch (const InputError& error) {
    throw error.Within(KeyOf(hand));
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
