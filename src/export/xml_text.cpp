#include "export/xml_text.h"

#include <cmath>

#include "core/text.h"

namespace predictor::scene_export {
namespace {

constexpr double kNothing = 1e-15;  // smaller values are rounding errors of zero

}  // namespace

std::string Text(double x) { return FormatNumber(std::abs(x) < kNothing ? 0 : x); }

std::string Text(const Vector3& x) { return Text(x.x()) + " " + Text(x.y()) + " " + Text(x.z()); }

std::string Text(const std::array<double, 4>& x) {
  return Text(x[0]) + " " + Text(x[1]) + " " + Text(x[2]) + " " + Text(x[3]);
}

Vector3 RollPitchYaw(const Matrix3& R) {
  const double yaw = std::atan2(R(1, 0), R(0, 0));
  const double pitch = std::atan2(-R(2, 0), std::hypot(R(0, 0), R(1, 0)));
  const double s = std::sin(yaw), c = std::cos(yaw);
  const double roll = std::atan2(s * R(0, 2) - c * R(1, 2), c * R(1, 1) - s * R(0, 1));
  return {roll, pitch, yaw};
}

}  // namespace predictor::scene_export
