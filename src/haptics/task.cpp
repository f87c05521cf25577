#include "haptics/task.h"

#include <algorithm>

namespace predictor {

Vector6 TaskTerm::Slack(const double* x) const noexcept {
  if (J.cols() == 0) return Vector6::Zero();
  // The sum is computed column by column, starting with −rate. Existing recordings depend on this
  // order of summation.
  Vector6 slack = -rate;
  for (int c = 0; c < J.cols(); ++c) slack += J.col(c) * x[first + c];
  return slack;
}

Vector3 QuaternionError(const Quaternion& to, const Quaternion& from, bool nearer) noexcept {
  const Quaternion d = to * from.conjugate();
  return nearer && d.w() < 0 ? Vector3(-d.vec()) : Vector3(d.vec());
}

Vector6 TwistWeight(const RenderSetup& setup) {
  const double length = setup.scenario.rendering.characteristic_length;
  const double rotation = setup.repairs.Has(Repair::kRotationWeight) ? length * length : 1;
  Vector6 weight;
  weight << 1, 1, 1, rotation, rotation, rotation;
  return weight;
}

double ScaleToCaps(const Twist& V, const RenderTarget& target) noexcept {
  return std::min({1.0, target.speed_cap / std::max(1e-12, V.head<3>().norm()),
                   target.rotation_cap / std::max(1e-12, V.tail<3>().norm())});
}

}  // namespace predictor
