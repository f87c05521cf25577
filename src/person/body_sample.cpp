#include "person/body_sample.h"

#include <cmath>

#include "core/error.h"
#include "core/text.h"

namespace predictor::person {

Stance StanceAt(const Vector3& ground, const Vector3& direction, double width) {
  const Vector3 ahead(direction.x(), direction.y(), 0);
  if (!(ahead.norm() > 1e-6 * direction.norm()))
    throw InputError::At(
        "facing",
        "facing points straight up or down or is zero. Give the direction in which "
        "the person looks, for example [1, 0, 0].");
  if (!(width >= 0 && width <= 1))
    throw InputError::At("stance_width", "stance_width is " + FormatNumber(width) +
                                             " m. Give the distance between the ankles, 0 to 1 m.");
  Stance stance;
  stance.width = width;
  stance.X_WS.p = ground;
  stance.X_WS.q = Eigen::AngleAxisd(std::atan2(ahead.y(), ahead.x()), Vector3::UnitZ());
  return stance;
}

Stance StanceOf(const StanceSpec& spec) {
  return StanceAt(spec.ground, {std::cos(spec.facing), std::sin(spec.facing), 0}, spec.feet_apart);
}

Pose GripOn(const Vector3& bar, const Vector3& wrist) {
  const Vector3 x = bar.normalized();
  const Vector3 across = wrist - wrist.dot(x) * x;
  if (!(across.norm() > 1e-6 * wrist.norm()) || !(bar.norm() > 0))
    throw InputError(
        "The direction of the wrist is parallel to the bar of the handle. Give two directions that "
        "are at an angle to each other, neither of them zero.");
  Matrix3 R;
  R.col(0) = x;
  R.col(2) = across.normalized();
  R.col(1) = R.col(2).cross(R.col(0));
  return {Vector3::Zero(), Quaternion(R)};
}

std::array<ExternalWrench, kHands> WrenchesOn(const BodySample& sample, const Stance& stance) {
  std::array<ExternalWrench, kHands> wrenches;
  const Pose X_SW = stance.X_WS.Inverse();
  for (int hand = 0; hand < kHands; ++hand) {
    const auto k = static_cast<std::size_t>(hand);
    wrenches[k].joint = Of(hand, ArmJoint::kWristDeviation);
    const HandSample& measured = sample.hands[k];
    if (!measured.present) continue;
    wrenches[k].p = X_SW * measured.X_WD.p;
    wrenches[k].F.head<3>() = -(X_SW.q * measured.F_D_W.head<3>());
    wrenches[k].F.tail<3>() = -(X_SW.q * measured.F_D_W.tail<3>());
  }
  return wrenches;
}

}  // namespace predictor::person
