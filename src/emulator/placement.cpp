#include "emulator/placement.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/error.h"

namespace predictor {
namespace {

constexpr int kRestarts = 20;  // of the inverse kinematics, from seeded random joints

std::string Unreachable(const Scenario& s, int hand, const Pose& X_WD) {
  char text[512];
  const Vector3 from_base = X_WD.p - s.arm(hand).base.xyz;
  std::snprintf(text, sizeof text,
                "The %s arm (device.arms.%s) cannot bring its handle to where the scenario starts: "
                "(%.3f, %.3f, %.3f) m in the world, %.3f m from its base. Move its base; "
                "`predictor check` proposes one.",
                kHandNames[static_cast<std::size_t>(hand)],
                kHandNames[static_cast<std::size_t>(hand)], X_WD.p.x(), X_WD.p.y(), X_WD.p.z(),
                from_base.norm());
  return text;
}

}  // namespace

JointVector StartingJoints(const ArmSpec& spec, const RobotModel& model) {
  JointVector q(model.dof());
  if (!spec.posture.empty() && static_cast<int>(spec.posture.size()) != model.dof())
    throw InputError("device.arms.*.posture has " + std::to_string(spec.posture.size()) +
                     " values; the arm has " + std::to_string(model.dof()) +
                     " joints. Give one a joint.");
  for (int j = 0; j < model.dof(); ++j) {
    const double lower = std::max(model.position_lower()[j], -3.0);
    const double upper = std::min(model.position_upper()[j], 3.0);
    q[j] = spec.posture.empty() ? (lower + upper) / 2 : spec.posture[static_cast<std::size_t>(j)];
  }
  return q;
}

std::shared_ptr<const RobotModel> LoadArm(const Scenario& s, int hand) {
  const ArmSpec& spec = s.arm(hand);
  auto model =
      RobotModel::Load({spec.model, s.file.parent_path(), spec.remove_links, spec.base.ToPose()});
  if (model->dof() > kMaxArmJoints)
    throw InputError("device.arms." + std::string(kHandNames[static_cast<std::size_t>(hand)]) +
                     " has " + std::to_string(model->dof()) + " joints; at most " +
                     std::to_string(kMaxArmJoints) +
                     " are possible. Remove links or choose another arm.");
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
      throw InputError(Unreachable(s, i, X_WD[i]));
  }
  return start;
}

}  // namespace predictor
