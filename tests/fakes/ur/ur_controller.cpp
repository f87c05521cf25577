#include "fakes/ur/ur_controller.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace predictor {

Pose FlangeOf(const UrGeometry& arm, const UrVector& q) {
  constexpr double kQuarter = std::numbers::pi / 2;
  const UrVector a = {0, arm.a2, arm.a3, 0, 0, 0}, d = {arm.d1, 0, 0, arm.d4, arm.d5, arm.d6},
                 alpha = {kQuarter, 0, 0, kQuarter, -kQuarter, 0};
  Pose X;
  for (std::size_t i = 0; i < q.size(); ++i)
    X = X * PoseFromXyzRpy({0, 0, d[i]}, {0, 0, q[i]}) *
        PoseFromXyzRpy({a[i], 0, 0}, {alpha[i], 0, 0});
  return X;
}

UrVector UrController::tool() const {
  const UrVector& x = tool_offset;
  const Pose X =
      FlangeOf(geometry, q) * Pose{{x[0], x[1], x[2]}, RotationFromVector({x[3], x[4], x[5]})};
  const Vector3 turn = RotationError(X.q, Quaternion::Identity());
  return {X.p.x(), X.p.y(), X.p.z(), turn.x(), turn.y(), turn.z()};
}

void UrController::Advance() {
  double largest = 0;
  for (std::size_t i = 0; i < target_.size(); ++i)
    largest = std::max(largest, std::abs(target_[i] - set_point_[i]));
  const double step = acceleration_ * cycle;
  if (largest <= step) {
    set_point_ = target_;
    return;
  }
  for (std::size_t i = 0; i < target_.size(); ++i)
    set_point_[i] += step / largest * (target_[i] - set_point_[i]);
}

}  // namespace predictor
