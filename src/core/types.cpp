#include "core/types.h"

#include <cmath>

namespace predictor {

Pose PoseFromXyzRpy(const Vector3& xyz, const Vector3& rpy) {
  const Quaternion q = Eigen::AngleAxisd(rpy.z(), Vector3::UnitZ()) *
                       Eigen::AngleAxisd(rpy.y(), Vector3::UnitY()) *
                       Eigen::AngleAxisd(rpy.x(), Vector3::UnitX());
  return {xyz, q.normalized()};
}

Vector3 RpyOf(const Quaternion& q) {
  const Matrix3 R = q.toRotationMatrix();
  const double level = std::hypot(R(0, 0), R(1, 0));
  const double pitch = std::atan2(-R(2, 0), level);
  if (level < 1e-9) return {0, pitch, std::atan2(-R(0, 1), R(1, 1))};
  return {std::atan2(R(2, 1), R(2, 2)), pitch, std::atan2(R(1, 0), R(0, 0))};
}

Vector3 RotationError(const Quaternion& to, const Quaternion& from) {
  Quaternion d = to * from.conjugate();
  if (d.w() < 0) d.coeffs() = -d.coeffs();  // same rotation, on the nearer hemisphere
  const double s = d.vec().norm();
  const double angle = 2 * std::atan2(s, d.w());
  // Near zero, the quotient angle/s tends to 2/w.
  return d.vec() * (s > 1e-9 ? angle / s : 2 / d.w());
}

Quaternion RotationFromVector(const Vector3& w) {
  const double angle = w.norm();
  Quaternion q;
  q.w() = std::cos(angle / 2);
  q.vec() = w * (angle > 1e-9 ? std::sin(angle / 2) / angle : 0.5);
  return q.normalized();
}

Vector6 PoseError(const Pose& X_Wset, const Pose& X_W) {
  Vector6 e;
  e << X_Wset.p - X_W.p, RotationError(X_Wset.q, X_W.q);
  return e;
}

Matrix3 Skew(const Vector3& a) {
  Matrix3 S;
  S << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return S;
}

Twist ShiftTwist(const Twist& V_WB, const Vector3& r_BC_W) {
  Twist V_WC = V_WB;
  V_WC.head<3>() += V_WB.tail<3>().cross(r_BC_W);
  return V_WC;
}

Wrench ShiftWrench(const Wrench& F_C_W, const Vector3& r_BC_W) {
  Wrench F_B_W = F_C_W;
  F_B_W.tail<3>() += r_BC_W.cross(F_C_W.head<3>());
  return F_B_W;
}

bool IsFinite(const Pose& X) { return X.p.allFinite() && X.q.coeffs().allFinite(); }

}  // namespace predictor
