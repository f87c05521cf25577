// A body of the surroundings that never moves.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/types.h"

namespace predictor {

enum class FixtureShape { kBox, kCylinder, kCapsule, kSphere, kPlane };

inline std::vector<std::string> NamesOf(FixtureShape) {
  return {"box", "cylinder", "capsule", "sphere", "plane"};
}

struct FixtureSpec {
  FixtureShape shape = FixtureShape::kBox;
  // The dimensions [m]. The dimensions are x, y and z for a box, radius and length for a cylinder,
  // radius and length without the caps for a capsule, the radius for a sphere, and the drawn x and
  // y for a plane. A plane is infinite, and everything below it is solid.
  Vector3 size = {0.1, 0.1, 0.1};
  // The pose of the fixture in W [m], [rad]. The axis of a cylinder or capsule and the normal of a
  // plane are along z.
  Vector3 xyz = Vector3::Zero();
  Vector3 rpy = Vector3::Zero();
  std::optional<double> friction;  // sliding friction of its contacts; absent: environment.friction
  // A contact acts like a spring and a damper that are scaled to the mass that they move. Without
  // damping, the bodies would oscillate at the frequency 1/(time_constant · damping_ratio) [rad/s].
  double time_constant = 0.0025;  // [s]
  double damping_ratio = 1;       // 1: no bounce
  // If a stiffness is given, each point of contact instead acts like a spring and a damper with the
  // given stiffness and damping [N/m], [N·s/m]. In this case, they are not scaled to the mass.
  std::optional<double> stiffness;
  double damping = 0;
  std::vector<std::string> touches = {"object"};  // that collide with it: object, cobot
  Vector3 color = {0.55, 0.58, 0.62};             // red, green, blue
  std::string name;                               // by which events refer to it; may be empty
  // A volume that the cobot must not enter, and that nothing else touches. `touches` then has no
  // effect.
  bool keep_out = false;

  Pose X_WG() const { return PoseFromXyzRpy(xyz, rpy); }  // NOLINT(readability-identifier-naming)
  bool Touches(const char* what) const {
    if (keep_out) return std::string_view(what) == "cobot";
    return std::find(touches.begin(), touches.end(), what) != touches.end();
  }
};

// The number of entries of `size` that are dimensions.
inline int Dimensions(FixtureShape shape) {
  switch (shape) {
    case FixtureShape::kBox:
      return 3;
    case FixtureShape::kSphere:
      return 1;
    default:
      return 2;
  }
}

inline std::string NameOf(FixtureShape shape) {
  return NamesOf(shape)[static_cast<std::size_t>(shape)];
}

}  // namespace predictor
