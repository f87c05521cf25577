// Implements (13)–(15) of the paper: bounds for joint positions, velocities and accelerations.
// Position and velocity limits always hold. If the acceleration limit conflicts with these limits
// in a tick, the acceleration limit is exceeded.
#include <algorithm>

#include "haptics/approach_speed.h"
#include "haptics/registry.h"

namespace predictor {
namespace {

// The share of a joint's velocity limit that rendering uses. The remaining share is reserved for a
// stop, because a stop slightly accelerates single joints to keep the handles on their path.
constexpr double kShareOfVelocity = 0.98;

class JointLimit final : public Limit {
 public:
  explicit JointLimit(const RenderSetup& setup)
      : security_(setup.scenario.rendering.joint_security),
        limits_acceleration_(setup.repairs.Has(Repair::kAccelerationLimit)),
        arms_(setup.limits) {
    const RenderingSpec& spec = setup.scenario.rendering;
    const double range = spec.joint_influence - security_;
    for (std::size_t i = 0; i < kHands; ++i) {
      if (!setup.models[i]) continue;
      fastest_[i] = kShareOfVelocity * arms_[i].velocity;
      if (!setup.repairs.Has(Repair::kSpeedReserve))
        fastest_[i] = setup.models[i]->velocity_limit();
      for (int j = 0; j < arms_[i].acceleration.size(); ++j)
        dampers_[i].emplace_back(spec.joint_gain / range, range, arms_[i].acceleration[j],
                                 setup.repairs);
    }
  }

  void AddTo(const RenderContext& context, LimitRows* out) noexcept override {
    for (int i = 0; i < kHands; ++i) {
      if (!context.Has(i)) continue;
      const auto h = static_cast<std::size_t>(i);
      const ArmLimits& arm = arms_[h];
      const JointVector& q = *context.arms[i].q;
      for (int j = 0; j < q.size(); ++j) {
        const auto k = static_cast<std::size_t>(j);
        const double a = arm.acceleration[j];
        const double to_upper = arm.upper[j] - q[j] - security_;
        const double to_lower = q[j] - arm.lower[j] - security_;
        const double fastest = fastest_[h][j];
        const double highest = std::min(fastest, dampers_[h][k].Speed(to_upper));
        const double lowest = -std::min(fastest, dampers_[h][k].Speed(to_lower));
        if (!limits_acceleration_) {
          out->Narrow(context.offset[i] + j, lowest, highest);
          continue;
        }
        // The range around the last command that the acceleration limit permits in one tick. It is
        // shifted into the range that the position limits allow.
        const double last = context.last[i][j], step = a * context.dt;
        out->Narrow(context.offset[i] + j, std::clamp(last - step, lowest, highest),
                    std::clamp(last + step, lowest, highest));
      }
    }
  }

 private:
  double security_;  // q_s [rad]
  bool limits_acceleration_;
  std::array<ArmLimits, kHands> arms_;
  std::array<JointVector, kHands> fastest_;                  // largest joint speeds [rad/s]
  std::array<std::vector<VelocityDamper>, kHands> dampers_;  // one per joint
};

}  // namespace

const LimitKind limits::kJoint =
    LimitKindOf<JointLimit>("joint", "positions, velocities and accelerations of the joints");

}  // namespace predictor
