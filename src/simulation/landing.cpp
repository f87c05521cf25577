#include "simulation/landing.h"

#include <algorithm>

namespace predictor {
namespace {

constexpr double kSupportFrequency = 30;  // of the critically damped support [rad/s]

}  // namespace

Wrench LandingWrench(const ObjectModel& object, const FrameMotion& O, double height) noexcept {
  Wrench wrench = Wrench::Zero();
  const Vector3 r_W = O.X_W.q * object.com;
  const double depth = height - (O.X_W.p + r_W).z();
  if (depth <= 0) return wrench;
  const Twist V = ShiftTwist(O.V_W, r_W);
  Vector3 force = -2 * kSupportFrequency * object.mass * V.head<3>();
  force.z() =
      std::max(0.0, force.z() + kSupportFrequency * kSupportFrequency * object.mass * depth);
  const Vector3 spin_O = O.X_W.q.conjugate() * Vector3(V.tail<3>());
  wrench << force, O.X_W.q * Vector3(-2 * kSupportFrequency * object.inertia * spin_O);
  return wrench;
}

}  // namespace predictor
