#include "models/fixture_shapes.h"

namespace predictor {

std::vector<ModelShape> FixtureShapes(const FixtureSpec& fixture) {
  const Vector3& size = fixture.size;
  const auto shape = [&](ShapeKind kind, const Vector3& of, double z = 0) {
    ModelShape made;
    made.kind = kind;
    made.size = of;
    made.X_LG = fixture.X_WG() * Pose{Vector3(0, 0, z), Quaternion::Identity()};
    made.color = {fixture.color[0], fixture.color[1], fixture.color[2],
                  fixture.keep_out ? kKeepOutOpacity : 1};
    return made;
  };
  switch (fixture.shape) {
    case FixtureShape::kBox:
      return {shape(ShapeKind::kBox, size)};
    case FixtureShape::kCylinder:
      return {shape(ShapeKind::kCylinder, size)};
    case FixtureShape::kCapsule:
      return {shape(ShapeKind::kCylinder, size), shape(ShapeKind::kSphere, size, size.y() / 2),
              shape(ShapeKind::kSphere, size, -size.y() / 2)};
    case FixtureShape::kPlane:
      return {shape(ShapeKind::kBox, {size.x(), size.y(), kPlaneDepth}, -kPlaneDepth / 2)};
    default:
      return {shape(ShapeKind::kSphere, size)};
  }
}

}  // namespace predictor
