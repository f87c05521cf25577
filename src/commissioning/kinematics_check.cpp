#include "commissioning/kinematics_check.h"

#include <numbers>

#include "core/format.h"
#include "core/units.h"

namespace predictor::commissioning {
namespace {

std::string FlangeOf(const RobotModel& model, const ArmSpec& arm, const std::string& ending) {
  for (const std::string& link : model.link_names())
    if (link.ends_with(ending)) return link;
  return arm.end_effector;
}

std::string Millimetres(const Vector3& p) {
  return Formatted("(%.0f, %.0f, %.0f) mm", 1e3 * p.x(), 1e3 * p.y(), 1e3 * p.z());
}

bool Fits(const Pose& X_BF, const Pose& told) {
  return (told.p - X_BF.p).norm() <= kFlangeSlack &&
         RotationError(told.q, X_BF.q).norm() <= kFlangeRotation;
}

}  // namespace

std::string KinematicsRefusal(const DeviceFacts& facts, const ArmSpec& arm,
                              const RobotModel& model) {
  if (!facts.flange) return "";
  const ToldFlange& told = *facts.flange;
  if (told.q.size() != model.dof())
    return Formatted(
        "It has %d joints, but arm.model has %d. Give the model of this arm in the machine file.",
        static_cast<int>(told.q.size()), model.dof());
  RobotData data(model);
  data.UpdateKinematics(model, told.q, JointVector::Zero(model.dof()));
  const std::string link = FlangeOf(model, arm, told.link);
  const Pose X_BF = arm.base.ToPose().Inverse() * data.FramePose(model, model.Frame(link));
  const Pose turned = PoseFromXyzRpy(Vector3::Zero(), {0, 0, std::numbers::pi}) * X_BF;
  if (Fits(X_BF, told.X_BF) || Fits(turned, told.X_BF)) return "";
  const bool nearer = (told.X_BF.p - turned.p).norm() < (told.X_BF.p - X_BF.p).norm();
  const Pose& ours = nearer ? turned : X_BF;
  std::string text = Formatted(
      "At its present joint angles, it reports its flange at %s in its base. According to %s of "
      "the machine file's arm.model, the flange is at %s: %.0f mm and %.1f° away. Either the model "
      "describes another arm (UR5 and UR5e differ), or it lacks this arm's calibration. Give a "
      "calibrated model of this arm.",
      Millimetres(told.X_BF.p).c_str(), link.c_str(), Millimetres(ours.p).c_str(),
      1e3 * (told.X_BF.p - ours.p).norm(), kDegrees * RotationError(told.X_BF.q, ours.q).norm());
  if (!told.tool_known)
    text +=
        " (It does not report its tool centre point, so zero is assumed. Set the tool centre point "
        "to zero at the pendant.)";
  return text;
}

}  // namespace predictor::commissioning
