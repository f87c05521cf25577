// (13)–(15): joint positions, velocities and accelerations, as bounds. Position and velocity limits
// always hold. If the acceleration limit conflicts with them in one tick, it is exceeded.
#include <algorithm>

#include "haptics/approach_speed.h"
#include "haptics/registry.h"

namespace predictor {
namespace {

// Share of a joint's velocity limit that rendering uses. The rest is reserved for a stop, which
// speeds up single joints slightly to keep the handles on their path.
constexpr double kShareOfVelocity = 0.98;

class JointLimit final : public Limit {
 public:
  explicit JointLimit(const RenderSetup& setup)
      : security_(setup.scenario.rendering.joint_security),
        gain_(setup.scenario.rendering.joint_gain /
              (setup.scenario.rendering.joint_influence - security_)),
        arms_(setup.limits) {}

  void AddTo(const RenderContext& context, LimitRows* out) noexcept override {
    for (int i = 0; i < kHands; ++i) {
      if (!context.Has(i)) continue;
      const ArmLimits& arm = arms_[static_cast<std::size_t>(i)];
      const JointVector& q = *context.arms[i].q;
      for (int j = 0; j < q.size(); ++j) {
        const double a = arm.acceleration[j];
        const double to_upper = arm.upper[j] - q[j] - security_;
        const double to_lower = q[j] - arm.lower[j] - security_;
        const double fastest = kShareOfVelocity * arm.velocity[j];
        const double highest = std::min(fastest, ApproachSpeed(to_upper, gain_, a));
        const double lowest = -std::min(fastest, ApproachSpeed(to_lower, gain_, a));
        // The range that one tick's acceleration permits around the last command, shifted into the
        // range that the position limits allow.
        const double last = context.last[i][j], step = a * context.dt;
        out->Narrow(context.offset[i] + j, std::clamp(last - step, lowest, highest),
                    std::clamp(last + step, lowest, highest));
      }
    }
  }

 private:
  double security_;  // q_s [rad]
  double gain_;      // slope of the velocity damper [1/s]
  std::array<ArmLimits, kHands> arms_;
};

}  // namespace

std::unique_ptr<Limit> MakeJointLimit(const RenderSetup& setup) {
  return std::make_unique<JointLimit>(setup);
}

}  // namespace predictor
