#include "scenario/stance.h"

#include <cmath>
#include <numbers>

namespace predictor {
namespace {

constexpr double kDistance = 0.62;         // horizontal distance of eyes and object, a guess [m]
constexpr double kEyesAboveObject = 0.55;  // a guess [m]

// Returns the direction for which the left handle is on the left.
double FacingOf(const Scenario& scenario, const Vector3& object_start,
                const std::array<Vector3, kHands>& handles) {
  Vector3 forward = scenario.cobot.base.xyz - object_start;
  if (scenario.Has(0) && scenario.Has(1))
    forward = (handles[0] - handles[1]).cross(Vector3::UnitZ());
  forward.z() = 0;
  return forward.norm() < 1e-6 ? std::numbers::pi : std::atan2(forward.y(), forward.x());
}

}  // namespace

Viewpoint ViewpointOf(const Scenario& scenario, const Vector3& object_start,
                      const std::array<Vector3, kHands>& handles) {
  const std::optional<StanceSpec>& stance = scenario.operator_.stance;
  const double facing = stance ? stance->facing : FacingOf(scenario, object_start, handles);
  if (stance && scenario.operator_.body) {
    const double height = kEyeHeight * scenario.operator_.body->height;
    return {stance->ground + Vector3(0, 0, height), facing, false};
  }
  const Vector3 back = -Vector3(std::cos(facing), std::sin(facing), 0);
  return {object_start + kDistance * back + Vector3(0, 0, kEyesAboveObject), facing, true};
}

}  // namespace predictor
