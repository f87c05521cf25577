#include "models/last_link.h"

#include <cmath>

#include "models/robot_impl.h"

namespace predictor {
namespace {

constexpr double kShort = 0.02;  // lengths below this one have no reliable direction [m]

// Returns whether `v` is long enough and has the required angle to the axis: more than 60° if
// `across` is true, and at most 60° otherwise.
bool Points(const Vector3& v, const Vector3& axis, bool across) {
  return v.norm() > kShort && (std::fabs(v.dot(axis)) < 0.5 * v.norm()) == across;
}

// The direction of a link whose frame is at the origin of its joint, in J.
Vector3 DirectionAtJoint(const EngineJoint& joint) {
  const Vector3 before = joint.R_PJ.transpose() * joint.p_PJ;  // from the joint before, at zero
  const Vector3 com =
      joint.body.mass > 0 ? Vector3(joint.body.moment / joint.body.mass) : Vector3::Zero();
  if (Points(before, joint.axis, false))
    return std::copysign(1, before.dot(joint.axis)) * joint.axis;
  if (Points(com, joint.axis, true)) return (com - com.dot(joint.axis) * joint.axis).normalized();
  return std::copysign(1, (before + com).dot(joint.axis)) * joint.axis;
}

}  // namespace

Vector3 LastLinkDirection(const RobotModel& model, const FrameId& frame) {
  if (frame.body == 0) return Vector3::UnitZ();
  const EngineJoint& joint = model.impl().engine.joints[static_cast<std::size_t>(frame.body) - 1];
  const Vector3 outward =
      frame.X_JF.p.norm() > kShort ? Vector3(frame.X_JF.p.normalized()) : DirectionAtJoint(joint);
  return frame.X_JF.q.conjugate() * outward;
}

}  // namespace predictor
