// Implements (11) and (12) of the paper, which keep the origins of link pairs apart. One row per
// pair.
#include <algorithm>
#include <cmath>

#include "haptics/approach_speed.h"
#include "haptics/link_pairs.h"
#include "haptics/registry.h"

namespace predictor {
namespace {

constexpr double kLinkBraking = 2.0;  // assumed deceleration of a link pair [m/s²]

VelocityDamper Damper(const RenderSetup& setup) {
  const RenderingSpec& spec = setup.scenario.rendering;
  const double range = spec.influence_distance - spec.security_distance;
  return {spec.collision_gain / range, range, kLinkBraking, setup.repairs};
}

class LinkDistance final : public Limit {
 public:
  explicit LinkDistance(const RenderSetup& setup)
      : security_(setup.scenario.rendering.security_distance),
        damper_(Damper(setup)),
        pairs_(LinkPairs(setup.scenario, setup.models)) {}

  int rows() const override { return static_cast<int>(pairs_.size()); }

  void AddTo(const RenderContext& context, LimitRows* out) noexcept override {
    nearest_ = HUGE_VAL;
    int row = 0;
    for (const LinkPair& pair : pairs_) {
      const Vector3 between = Between(context.arms, pair);
      const double distance = between.norm();
      nearest_ = std::min(nearest_, distance);
      const Vector3 n = distance > 1e-9 ? Vector3(between / distance) : Vector3::UnitY();
      const auto add = [&](int arm, const FrameId& frame, double sign) {
        Jacobian J;
        context.arms[arm].data->FrameJacobian(*context.arms[arm].model, frame, &J);
        out->A.row(row).segment(context.offset[arm], J.cols()) +=
            sign * n.transpose().lazyProduct(J.topRows<3>());
      };
      add(pair.arm_a, pair.a, 1);
      add(pair.arm_b, pair.b, -1);
      out->b[row] = -damper_.Speed(distance - security_);
      ++row;
    }
  }

  void Publish(RenderResult* result) const noexcept override { result->link_distance = nearest_; }

 private:
  double security_;  // d_s [m]
  VelocityDamper damper_;
  std::vector<LinkPair> pairs_;
  double nearest_ = HUGE_VAL;  // at the last AddTo [m]
};

}  // namespace

const LimitKind limits::kLinkDistance =
    LimitKindOf<LinkDistance>("link_distance", "keeps link pairs apart");

}  // namespace predictor
