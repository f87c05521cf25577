#include "haptics/recovery.h"

#include <algorithm>
#include <cmath>

#include "models/arm_limits.h"

namespace predictor {
namespace {

// Scales the velocities of both arms by one factor, so that no handle and no joint is too fast.
void Bound(const std::array<RenderArm, kHands>& arms, std::array<JointVector, kHands>* v) noexcept {
  double scale = 1;
  for (std::size_t i = 0; i < kHands; ++i) {
    if (!arms[i].present) continue;
    Jacobian J;
    arms[i].data->FrameJacobian(*arms[i].model, arms[i].handle, &J);
    const Twist V = J.lazyProduct((*v)[i]);
    scale = std::max({scale, (*v)[i].lpNorm<Eigen::Infinity>() / Recovery::kJointSpeed,
                      V.head<3>().norm() / Recovery::kHandleSpeed,
                      V.tail<3>().norm() * Recovery::kLength / Recovery::kHandleSpeed});
  }
  for (JointVector& x : *v) x /= scale;
}

}  // namespace

Recovery::Recovery(const Scenario& scenario,
                   const std::array<std::shared_ptr<const RobotModel>, kHands>& models)
    : security_distance_(scenario.rendering.security_distance),
      pairs_(LinkPairs(scenario, models)) {
  for (int i = 0; i < kHands; ++i) {
    if (!models[i]) continue;
    const ArmLimits limits = LimitsOf(scenario.arm(i), *models[i]);
    lower_[i] = limits.lower.array() + scenario.rendering.joint_security;
    upper_[i] = limits.upper.array() - scenario.rendering.joint_security;
    // If a joint's whole range is within this distance of its limits, the joint may remain in the
    // middle of its range.
    for (Eigen::Index j = 0; j < lower_[i].size(); ++j)
      if (lower_[i][j] > upper_[i][j])
        lower_[i][j] = upper_[i][j] = (limits.lower[j] + limits.upper[j]) / 2;
  }
}

BeyondPlace Recovery::Where(const std::array<RenderArm, kHands>& arms) const noexcept {
  for (int i = 0; i < kHands; ++i) {
    if (!arms[i].present) continue;
    for (int j = 0; j < arms[i].q->size(); ++j) {
      const double q = (*arms[i].q)[j], low = lower_[i][j], high = upper_[i][j];
      if (!(q >= low - kJointMargin && q <= high + kJointMargin))
        return {Beyond::kJoint, i, j, nullptr, q, low, high};
    }
  }
  for (const LinkPair& pair : pairs_)
    if (const double d = Between(arms, pair).norm(); !(d >= security_distance_))
      return {Beyond::kLinks, -1, -1, &pair, d, security_distance_, HUGE_VAL};
  return {};
}

void Recovery::Step(const std::array<RenderArm, kHands>& arms,
                    const std::array<HandWrench, kHands>& wrench,
                    std::array<JointVector, kHands>* v) const noexcept {
  for (std::size_t i = 0; i < kHands; ++i) (*v)[i].setZero(arms[i].present ? arms[i].q->size() : 0);
  WithTheHands(arms, wrench, JointsBack(arms, v) || LinksApart(arms, v), v);
  Bound(arms, v);
}

// Moves each joint that is beyond its limit. The other joints do not move.
bool Recovery::JointsBack(const std::array<RenderArm, kHands>& arms,
                          std::array<JointVector, kHands>* v) const noexcept {
  constexpr double kGain = 2;  // [1/s]
  bool any = false;
  for (std::size_t i = 0; i < kHands; ++i) {
    if (!arms[i].present) continue;
    for (Eigen::Index j = 0; j < arms[i].q->size(); ++j) {
      const double q = (*arms[i].q)[j];
      const double low = lower_[i][j] + kInside - q, high = upper_[i][j] - kInside - q;
      if (!(low > kInside || high < -kInside)) continue;
      any = true;
      // The target is inside the limit and not on it, and the speed has a minimum.
      const double way = low > 0 ? low : high;
      (*v)[i][j] = std::copysign(std::max(kGain * std::abs(way), 0.02), way);
    }
  }
  return any;
}

// Moves along the gradient of the nearest pair's distance.
bool Recovery::LinksApart(const std::array<RenderArm, kHands>& arms,
                          std::array<JointVector, kHands>* v) const noexcept {
  const LinkPair* nearest = nullptr;
  double distance = security_distance_;
  for (const LinkPair& pair : pairs_) {
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
    (*v)[arm] += sign * J.topRows<3>().transpose().lazyProduct(n);
  };
  add(nearest->arm_a, nearest->a, 1);
  add(nearest->arm_b, nearest->b, -1);
  return true;
}

// The joint velocity is v = Jᵀ F · c. Because Fᵀ J v = c |Jᵀ F|² ≥ 0, the handle yields to the hand
// in any posture.
void Recovery::WithTheHands(const std::array<RenderArm, kHands>& arms,
                            const std::array<HandWrench, kHands>& wrench, bool goes_back,
                            std::array<JointVector, kHands>* v) noexcept {
  constexpr double kSpeedPerForce = 0.005;  // [rad/s] per newton metre of joint torque
  for (std::size_t i = 0; i < kHands; ++i) {
    if (!arms[i].present || !wrench[i].present) continue;
    if (!(wrench[i].F_H_W.head<3>().norm() > kForce)) continue;
    Jacobian J;
    arms[i].data->FrameJacobian(*arms[i].model, arms[i].handle, &J);
    const JointVector torque = J.transpose().lazyProduct(wrench[i].F_H_W);
    if (!goes_back || (*v)[i].dot(torque) < 0) (*v)[i] = kSpeedPerForce * torque;
  }
}

}  // namespace predictor
