// Implements the recursive Newton-Euler algorithm in the axes of S.
#include "person/body_model.h"

namespace predictor::person {
namespace {

struct Motion {
  Vector3 w = Vector3::Zero();      // angular velocity [rad/s]
  Vector3 alpha = Vector3::Zero();  // angular acceleration [rad/s²]
  Vector3 a = Vector3::Zero();      // acceleration of the origin, minus gravity [m/s²]
};

// Computes the motion of a joint's frame from the motion of the frame of its parent joint. `r`
// starts at the parent's origin [m, in S].
Motion Outward(const Motion& parent, const Vector3& axis, const Vector3& r, bool prismatic,
               double v, double acceleration) {
  Motion m = parent;
  m.a += parent.alpha.cross(r) + parent.w.cross(parent.w.cross(r));
  if (prismatic) {
    m.a += axis * acceleration + 2 * parent.w.cross(axis) * v;
  } else {
    m.w += axis * v;
    m.alpha += axis * acceleration + parent.w.cross(axis) * v;
  }
  return m;
}

}  // namespace

JointLoads InverseDynamics(const BodyModel& model, const BodyVector& q, const BodyVector& v,
                           const BodyVector& a, std::span<const ExternalWrench> wrenches,
                           double gravity) {
  const Placement at = Place(model, q);
  JointLoads loads;
  std::array<Motion, kBodyJoints> motion;
  for (int i = 0; i < kBodyJoints; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const BodyJoint& joint = model.joint(i);
    Motion parent;
    parent.a.z() = gravity;
    Vector3 r = at.p[k];
    if (joint.parent >= 0) {
      parent = motion[static_cast<std::size_t>(joint.parent)];
      r -= at.p[static_cast<std::size_t>(joint.parent)];
    }
    motion[k] = Outward(parent, at.axis[k], r, IsPrismatic(i), v[i], a[i]);
    loads.force[k].setZero();
    loads.moment[k].setZero();
    if (joint.mass == 0) continue;
    const Motion& m = motion[k];
    const Vector3 c = at.R[k] * joint.com;
    const Matrix3 inertia = at.R[k] * joint.inertia.asDiagonal() * at.R[k].transpose();
    loads.force[k] = joint.mass * (m.a + m.alpha.cross(c) + m.w.cross(m.w.cross(c)));
    loads.moment[k] = inertia * m.alpha + m.w.cross(inertia * m.w) + c.cross(loads.force[k]);
  }
  for (const ExternalWrench& wrench : wrenches) {
    const auto k = static_cast<std::size_t>(wrench.joint);
    const Vector3 force = wrench.F.head<3>();
    loads.force[k] -= force;
    loads.moment[k] -= wrench.F.tail<3>() + (wrench.p - at.p[k]).cross(force);
  }
  for (int i = kBodyJoints - 1; i >= 0; --i) {
    const auto k = static_cast<std::size_t>(i);
    loads.torque[i] = at.axis[k].dot(IsPrismatic(i) ? loads.force[k] : loads.moment[k]);
    const int parent = model.joint(i).parent;
    if (parent < 0) continue;
    const auto to = static_cast<std::size_t>(parent);
    loads.force[to] += loads.force[k];
    loads.moment[to] += loads.moment[k] + (at.p[k] - at.p[to]).cross(loads.force[k]);
  }
  return loads;
}

}  // namespace predictor::person
