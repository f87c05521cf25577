#include "commissioning/arm_checks.h"

#include <algorithm>
#include <cmath>
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

bool Fits(const Pose& X_BF, const Pose& reported) {
  return (reported.p - X_BF.p).norm() <= kFlangeSlack &&
         RotationError(reported.q, X_BF.q).norm() <= kFlangeRotation;
}

// Tolerances of the payload. Errors above these values noticeably affect the arm's protective stops
// and free-drive.
constexpr double kMass = 0.1;      // [kg]
constexpr double kMassPart = 0.1;  // share of the handle's mass
constexpr double kSensor = 1.0;    // largest mass of a separate sensor [kg]
constexpr double kReach = 0.1;     // distance of its centre of gravity from the flange [m]
constexpr double kMoment = 0.01;   // limit for mass times distance [kg·m]: 0.1 N·m

// Returns the centre of mass of the handle, in E.
Vector3 CentreOf(const ArmSpec& arm) {
  return arm.sensor.pose.ToPose() * arm.payload.center_of_mass;
}

// Returns an error if the handle's weight would be subtracted twice, because the arm's own wrench
// already excludes the weight configured in its controller.
std::string TakenOffTwice(const ReportedPayload& reported, const HandlePayloadSpec& handle) {
  if (!(reported.mass > kMass && handle.mass > kMass)) return "";
  return Formatted(
      "The arm's controller subtracts %.2f kg from the arm's own wrench, and the machine file "
      "gives the handle a mass of %.2f kg, so the weight would be subtracted twice. Enter the "
      "handle either in Desk or as payload.mass in the machine file, and zero in the other place.",
      reported.mass, handle.mass);
}

}  // namespace

std::string KinematicsRefusal(const DeviceFacts& facts, const ArmSpec& arm,
                              const RobotModel& model) {
  if (!facts.flange) return "";
  const ReportedFlange& reported = *facts.flange;
  if (reported.q.size() != model.dof())
    return Formatted(
        "The arm has %d joints, but arm.model has %d. Give the model of this arm in the machine "
        "file.",
        static_cast<int>(reported.q.size()), model.dof());
  RobotData data(model);
  data.UpdateKinematics(model, reported.q, JointVector::Zero(model.dof()));
  const std::string link = FlangeOf(model, arm, reported.link);
  const Pose X_BF = arm.base.X_RB().Inverse() * data.FramePose(model, model.Frame(link));
  const Pose turned = PoseFromXyzRpy(Vector3::Zero(), {0, 0, std::numbers::pi}) * X_BF;
  if (Fits(X_BF, reported.X_BF) || Fits(turned, reported.X_BF)) return "";
  const bool nearer = (reported.X_BF.p - turned.p).norm() < (reported.X_BF.p - X_BF.p).norm();
  const Pose& ours = nearer ? turned : X_BF;
  std::string text = Formatted(
      "At the present joint angles, the arm reports its flange at %s in its base. According to %s "
      "of the machine file's arm.model, the flange is at %s: %.0f mm and %.1f° away. Either the "
      "model describes another arm (UR5 and UR5e differ), or the model lacks this arm's "
      "calibration. Give a calibrated model of this arm.",
      Millimetres(reported.X_BF.p).c_str(), link.c_str(), Millimetres(ours.p).c_str(),
      1e3 * (reported.X_BF.p - ours.p).norm(),
      kDegrees * RotationError(reported.X_BF.q, ours.q).norm());
  if (!reported.tool_known)
    text +=
        " (The arm does not report its tool centre point, so zero is assumed. Set the tool centre "
        "point to zero at the pendant.)";
  return text;
}

std::string PayloadRefusal(const DeviceFacts& facts, const MachineArm& machine) {
  if (!facts.payload) return "";
  const ReportedPayload& reported = *facts.payload;
  const HandlePayloadSpec& handle = machine.arm.payload;
  const bool own = machine.sensor.make == SensorMake::kOwn;
  if (own && facts.payload_taken_off) return TakenOffTwice(reported, handle);
  const double slack = std::max(kMass, kMassPart * handle.mass);
  const double most = handle.mass + slack + (own ? 0 : kSensor);
  const Vector3 c = CentreOf(machine.arm);
  if (!(reported.mass >= handle.mass - slack && reported.mass <= most))
    return Formatted(
        "The arm's controller is set to %.2f kg at the flange, but the handle weighs %.2f kg%s. "
        "Enter %.2f kg%s at the pendant; otherwise the arm's protective stops and free-drive are "
        "wrong.",
        reported.mass, handle.mass, own ? "" : " without the sensor", handle.mass,
        own ? "" : " plus the sensor's mass");
  // The mass of a separate sensor is unknown, but its upper bound is known.
  const double sensor = own ? 0 : kReach * std::max(0.0, reported.mass - handle.mass);
  const double moment = (reported.mass * reported.center_of_mass - handle.mass * c).norm();
  if (moment <= kMoment + sensor) return "";
  return Formatted(
      "The arm's controller is set to a centre of gravity at (%.0f, %.0f, %.0f) mm from the "
      "flange, but the handle's centre of gravity is at (%.0f, %.0f, %.0f) mm. Enter %s at the "
      "pendant.",
      1e3 * reported.center_of_mass.x(), 1e3 * reported.center_of_mass.y(),
      1e3 * reported.center_of_mass.z(), 1e3 * c.x(), 1e3 * c.y(), 1e3 * c.z(),
      own ? "this position" : "the mass and centre of gravity of sensor and handle together");
}

}  // namespace predictor::commissioning
