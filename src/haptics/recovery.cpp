#include "haptics/recovery.h"

#include <algorithm>
#include <cmath>

namespace predictor {
namespace {

// Vector from b's origin to a's, in W [m].
Vector3 Between(const std::array<RenderArm, kHands>& arms, const LinkDistance::Pair& pair) {
  const RenderArm &a = arms[pair.arm_a], &b = arms[pair.arm_b];
  return a.data->FramePose(*a.model, pair.a).p - b.data->FramePose(*b.model, pair.b).p;
}

// Scales both arms alike until neither a handle nor a joint is too fast.
void Bound(const std::array<RenderArm, kHands>& arms, std::array<JointVector, kHands>* v) noexcept {
  double most = 1;
  for (std::size_t i = 0; i < kHands; ++i) {
    if (!arms[i].present) continue;
    Jacobian J;
    arms[i].data->FrameJacobian(*arms[i].model, arms[i].handle, &J);
    Twist V = Twist::Zero();
    for (Eigen::Index j = 0; j < J.cols(); ++j) {
      V += J.col(j) * (*v)[i][j];
      most = std::max(most, std::abs((*v)[i][j]) / Recovery::kJointSpeed);
    }
    most = std::max({most, V.head<3>().norm() / Recovery::kHandleSpeed,
                     V.tail<3>().norm() * Recovery::kLength / Recovery::kHandleSpeed});
  }
  for (JointVector& x : *v) x /= most;
}

}  // namespace

Recovery::Recovery(const Scenario& scenario,
                   const std::array<std::shared_ptr<const RobotModel>, kHands>& models)
    : security_distance_(scenario.rendering.security_distance),
      pairs_(LinkPairs(scenario, models)) {
  for (int i = 0; i < kHands; ++i)
    if (models[i]) limits_[i] = LimitsOf(scenario.arm(i), *models[i]);
}

Beyond Recovery::Find(const std::array<RenderArm, kHands>& arms) const noexcept {
  for (std::size_t i = 0; i < kHands; ++i) {
    if (!arms[i].present) continue;
    for (Eigen::Index j = 0; j < arms[i].q->size(); ++j)
      if (!((*arms[i].q)[j] >= limits_[i].lower[j] && (*arms[i].q)[j] <= limits_[i].upper[j]))
        return Beyond::kJoint;
  }
  for (const LinkDistance::Pair& pair : pairs_)
    if (!(Between(arms, pair).norm() >= security_distance_)) return Beyond::kLinks;
  return Beyond::kNothing;
}

void Recovery::Step(const std::array<RenderArm, kHands>& arms,
                    const std::array<HandWrench, kHands>& wrench,
                    std::array<JointVector, kHands>* v) const noexcept {
  for (std::size_t i = 0; i < kHands; ++i) (*v)[i].setZero(arms[i].present ? arms[i].q->size() : 0);
  WithTheHands(arms, wrench, JointsBack(arms, v) || LinksApart(arms, v), v);
  Bound(arms, v);
}

// Each joint that is beyond by itself, the others stand.
bool Recovery::JointsBack(const std::array<RenderArm, kHands>& arms,
                          std::array<JointVector, kHands>* v) const noexcept {
  constexpr double kGain = 2;  // [1/s]
  bool any = false;
  for (std::size_t i = 0; i < kHands; ++i) {
    if (!arms[i].present) continue;
    for (Eigen::Index j = 0; j < arms[i].q->size(); ++j) {
      const double q = (*arms[i].q)[j];
      const double low = limits_[i].lower[j] + kInside - q,
                   high = limits_[i].upper[j] - kInside - q;
      if (!(low > kInside || high < -kInside)) continue;
      any = true;
      // To the inside of the limit, not just onto it; not so slowly that it takes for ever.
      const double way = low > 0 ? low : high;
      (*v)[i][j] = std::copysign(std::max(kGain * std::abs(way), 0.02), way);
    }
  }
  return any;
}

// Along the gradient of the nearest pair's distance.
bool Recovery::LinksApart(const std::array<RenderArm, kHands>& arms,
                          std::array<JointVector, kHands>* v) const noexcept {
  const LinkDistance::Pair* nearest = nullptr;
  double distance = security_distance_;
  for (const LinkDistance::Pair& pair : pairs_) {
    if (const double d = Between(arms, pair).norm(); d < distance) {
      distance = d;
      nearest = &pair;
    }
  }
  if (!nearest) return false;
  const Vector3 between = Between(arms, *nearest);
  const Vector3 n = distance > 1e-9 ? Vector3(between / distance) : Vector3::UnitY();
  const auto add = [&](int arm, const FrameId& frame, double sign) {
    Jacobian J;
    arms[arm].data->FrameJacobian(*arms[arm].model, frame, &J);
    for (Eigen::Index j = 0; j < J.cols(); ++j) (*v)[arm][j] += sign * n.dot(J.col(j).head<3>());
  };
  add(nearest->arm_a, nearest->a, 1);
  add(nearest->arm_b, nearest->b, -1);
  return true;
}

// v = Jᵀ F · c: then Fᵀ J v = c |Jᵀ F|² ≥ 0, the handle yields to the hand whatever the posture.
void Recovery::WithTheHands(const std::array<RenderArm, kHands>& arms,
                            const std::array<HandWrench, kHands>& wrench, bool goes_back,
                            std::array<JointVector, kHands>* v) noexcept {
  constexpr double kSpeedPerForce = 0.005;  // [rad/s] a newton metre of joint torque
  for (std::size_t i = 0; i < kHands; ++i) {
    if (!arms[i].present || !wrench[i].present) continue;
    if (!(wrench[i].F_H_W.head<3>().norm() > kForce)) continue;
    Jacobian J;
    arms[i].data->FrameJacobian(*arms[i].model, arms[i].handle, &J);
    JointVector torque(J.cols());
    for (Eigen::Index j = 0; j < J.cols(); ++j) torque[j] = J.col(j).dot(wrench[i].F_H_W);
    if (!goes_back || (*v)[i].dot(torque) < 0) (*v)[i] = kSpeedPerForce * torque;
  }
}

}  // namespace predictor
