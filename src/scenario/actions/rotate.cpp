// Rotates the object about its origin by the rotation vector `rotate_by`.
#include <cmath>
#include <cstdio>

#include "scenario/actions/phrases.h"
#include "scenario/actions/registry.h"
#include "scenario/actions/transport.h"

namespace predictor::actions {
namespace {

constexpr double kMinAngle = 1e-4;  // a smaller rotation is not mentioned [rad]

struct RotateParameters {
  double duration = 1;                  // [s]
  Vector3 rotate_by = Vector3::Zero();  // rotation vector in W [rad]
};

template <class V>
void Fields(V& v, RotateParameters& p) {
  v("duration", p.duration, DurationRule());
  v("rotate_by", p.rotate_by,
    Required(Number("rad", "intended rotation vector of the object, in W", Within(kFullTurn))));
}

class Rotate final : public Transport {
 public:
  explicit Rotate(const RotateParameters& p)
      : Transport(p.duration, Vector3::Zero(), NotZero("rotate_by", p.rotate_by)) {}
  static std::string Sentence(const RotateParameters& p, double facing);
};

// Returns the side of the object that rises when the object tilts about a horizontal axis, as seen
// by the person, or "" if no single side rises.
std::string RisingSide(const Vector3& axis, double facing) {
  const std::string along = DirectionWords(axis, facing);
  if (along == "forward") return "left";
  if (along == "back") return "right";
  if (along == "to the left") return "near";
  return along == "to the right" ? "far" : "";
}

std::string Rotate::Sentence(const RotateParameters& p, double facing) {
  const double angle = p.rotate_by.norm();
  if (angle < kMinAngle) return "Hold the object as it is.";
  const Vector3 axis = p.rotate_by / angle;
  const std::string along = DirectionWords(axis, facing);
  if (along == "up" || along == "down")
    return "Turn the object by " + InDegrees(angle) +
           (along == "up" ? " counter-clockwise" : " clockwise") + ", as seen from above.";
  const std::string side = RisingSide(axis, facing);
  if (!side.empty())
    return "Tilt the object by " + InDegrees(angle) + " so that its " + side + " side rises.";
  char text[64];
  std::snprintf(text, sizeof text, " about the axis (%.2g, %.2g, %.2g).", axis.x(), axis.y(),
                axis.z());
  return "Turn the object by " + InDegrees(angle) + text;
}

}  // namespace

const ActionKind kRotate =
    ActionKindOf<Rotate, RotateParameters>("rotate", "rotates the object", ActionMotion::kTurns);

}  // namespace predictor::actions
