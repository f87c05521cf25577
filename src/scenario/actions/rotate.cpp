// Rotates the object about its origin by the rotation vector `rotate_by`.
#include <cmath>
#include <cstdio>

#include "scenario/actions/phrases.h"
#include "scenario/actions/registry.h"
#include "scenario/actions/transport.h"

namespace predictor::actions {
namespace {

constexpr double kMinAngle = 1e-4;  // a smaller rotation is not mentioned [rad]

std::string RotateSentence(const ActionSpec& spec, int) {
  const double angle = spec.rotate_by.norm();
  if (angle < kMinAngle) return "Hold the object as it is.";
  const Vector3 axis = spec.rotate_by / angle;
  if (std::abs(axis.z()) > 0.999)
    return "Turn the object by " + InDegrees(angle) +
           (axis.z() > 0 ? " counter-clockwise" : " clockwise") + ", as seen from above.";
  char text[64];
  std::snprintf(text, sizeof text, " about the axis (%.2g, %.2g, %.2g).", axis.x(), axis.y(),
                axis.z());
  return "Turn the object by " + InDegrees(angle) + text;
}

}  // namespace

const ActionKind kRotate = {
    .name = "rotate",
    .uses = {{{"duration"}, {"rotate_by", true}}},
    .motion = ActionMotion::kTurns,
    .sentence = RotateSentence,
    .make = [](const ActionSpec& s) -> std::unique_ptr<Action> {
      return std::make_unique<Transport>(s, Vector3::Zero(), s.rotate_by);
    },
};

}  // namespace predictor::actions
